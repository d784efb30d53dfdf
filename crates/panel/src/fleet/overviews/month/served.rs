//! A month over HTTP: as JSON, and as a page to keep.

use std::sync::Arc;

use axum::extract::rejection::QueryRejection;
use axum::extract::{Query, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use fleet::now_ms;
use report::{Subject, page as whole};
use schemars::JsonSchema;
use serde::Deserialize;

use super::{CalendarMonth, Month, count};
use crate::fleet::access::{Refusal, refuse};
use crate::fleet::plant::Plant;
use crate::fleet::questions::{answer, failed};

/// Which month.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::fleet) struct WhichMonth {
    /// The month in UTC, as 2026-10.
    month: String,
}

type Asked = Result<Query<WhichMonth>, QueryRejection>;

fn counted(plant: &Plant, asked: Asked) -> Result<Month, Refusal> {
    let bad = |why: String| Refusal(StatusCode::BAD_REQUEST, why);
    let Query(which) = asked.map_err(|error| bad(error.body_text()))?;
    let month: CalendarMonth = which
        .month
        .parse()
        .map_err(|error| bad(format!("{error}")))?;
    count(&plant.reader, &plant.settings.due, month, now_ms()).map_err(failed)
}

pub(in crate::fleet) async fn month(State(plant): State<Arc<Plant>>, asked: Asked) -> Response {
    answer(move || counted(&plant, asked)).await
}

/// A file for the browser to keep: it carries its script and style, which this server's pages may not.
pub(in crate::fleet) async fn page(State(plant): State<Arc<Plant>>, asked: Asked) -> Response {
    let made = tokio::task::spawn_blocking(move || {
        let month = counted(&plant, asked)?;
        let page = whole(Subject::FleetMonth, &month);
        let failed = |error: serde_json::Error| {
            Refusal(StatusCode::INTERNAL_SERVER_ERROR, error.to_string())
        };
        Ok((month.month.clone(), page.map_err(failed)?))
    });
    match made.await {
        Ok(Ok((month, page))) => {
            let name = format!("attachment; filename=\"plant-{month}.html\"");
            let headers = [
                (header::CONTENT_TYPE, "text/html; charset=utf-8".to_owned()),
                (header::CONTENT_DISPOSITION, name),
            ];
            (headers, page).into_response()
        }
        Ok(Err(Refusal(status, message))) => refuse(status, message),
        // The work panicked: the next question is answered all the same.
        Err(error) => refuse(StatusCode::INTERNAL_SERVER_ERROR, error.to_string()),
    }
}
