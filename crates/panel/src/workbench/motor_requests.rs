//! What a page may ask about the motor file on the desk.

use std::sync::Arc;

use axum::Json;
use axum::body::Bytes;
use axum::extract::rejection::JsonRejection;
use axum::extract::{Query, State};
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;

use super::desk::Bench;
use super::known::Checked;
use super::motors::{Motor, SHIPPED};
use super::upload::harmless;
use super::{answer, refused};
use crate::running::shared::Refusal;

/// A shipped motor file by its name; the panel's own without one.
#[derive(Debug, Deserialize)]
pub(super) struct Choice {
    shipped: Option<String>,
}

/// Takes a shipped motor file, or the panel's own.
pub(super) async fn choose(
    State(bench): State<Arc<Bench>>,
    body: Result<Json<Choice>, JsonRejection>,
) -> Response {
    let choice = body.map_err(|error| Refusal::of(error.body_text()));
    let motor = choice.and_then(|Json(choice)| {
        let Some(name) = choice.shipped else {
            return Ok(None);
        };
        let found = SHIPPED.iter().find(|(known, _)| *known == name);
        let (file, text) = found.ok_or_else(|| Refusal::of("there is no such motor file here"))?;
        Motor::parse(file, text).map(Some)
    });
    let done = motor.and_then(|motor| take(&bench, motor, None));
    answer_audited(bench, done).await
}

/// What goes with a motor file.
#[derive(Debug, Deserialize)]
pub(super) struct Named {
    name: String,
}

/// Takes a motor file that the page sends.
pub(super) async fn file(
    State(bench): State<Arc<Bench>>,
    Query(named): Query<Named>,
    body: Bytes,
) -> Response {
    let done = sent(&named, &body).and_then(|(motor, _)| take(&bench, Some(motor), None));
    answer_audited(bench, done).await
}

/// A motor file that the page sends, and its text.
pub(super) fn sent<'b>(named: &Named, body: &'b [u8]) -> Result<(Motor, &'b str), Refusal> {
    let name = harmless(&named.name);
    let text = std::str::from_utf8(body).map_err(|error| {
        Refusal::of(format!("{name}: is no text: {error}; choose a motor file"))
    })?;
    Ok((Motor::parse(&name, text)?, text))
}

/// Puts a motor file on the desk, with what the first check knows of the motor.
pub(super) fn take(
    bench: &Bench,
    motor: Option<Motor>,
    check: Option<Checked>,
) -> Result<(), Refusal> {
    let mut desk = bench.free_desk()?;
    desk.take_motor(motor);
    desk.check = check;
    desk.job.problem = None;
    Ok(())
}

/// The state after another motor file was taken, with the audits that belong to it.
pub(super) async fn answer_audited(bench: Arc<Bench>, done: Result<(), Refusal>) -> Response {
    if done.is_ok() {
        let shared = bench.clone();
        // A panic would leave a recording without findings.
        let _ = tokio::task::spawn_blocking(move || shared.audit_missing()).await;
    }
    answer(&bench, done)
}

/// Goes back to the motor file before the last adoption.
pub(super) async fn undo(State(bench): State<Arc<Bench>>) -> Response {
    let done = bench.free_desk().and_then(|mut desk| {
        let before = desk.before.pop();
        let before = before.ok_or_else(|| Refusal::of("nothing was adopted"))?;
        desk.believe(before);
        desk.results.clear();
        desk.job.problem = None;
        Ok(())
    });
    answer(&bench, done)
}

/// The motor file as `drivemon adopt -o` would write it.
pub(super) async fn save(State(bench): State<Arc<Bench>>) -> Response {
    let Some(motor) = bench.motor() else {
        return refused(&Refusal::of("there is no motor file"));
    };
    let ascii = |c: char| {
        if c.is_ascii_alphanumeric() || "._-".contains(c) {
            c
        } else {
            '_'
        }
    };
    let name: String = motor.file.chars().map(ascii).collect();
    let headers = [
        (CONTENT_TYPE, "application/toml".to_owned()),
        (
            CONTENT_DISPOSITION,
            format!("attachment; filename=\"{name}\""),
        ),
    ];
    (headers, motor.text).into_response()
}
