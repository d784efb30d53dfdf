//! `GET /metrics`: the plant for Prometheus, on the page's own listener and behind its roles.

use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use fleet::now_ms;
use uplink::metrics::{MetricsConfig, PageState, Plant as Shown, render};

use crate::fleet::access::refuse;
use crate::fleet::plant::Plant;

/// Where it is.
pub(in crate::fleet) const PATH: &str = "/metrics";

/// Motors and sums as the gateway's own listener shows them; the outputs are the gateway's to tell.
pub(in crate::fleet) async fn metrics(State(plant): State<Arc<Plant>>) -> Response {
    let motors = match plant.reader.motors() {
        Ok(motors) => motors,
        Err(error) => return refuse(StatusCode::SERVICE_UNAVAILABLE, error.to_string()),
    };
    let text = render(&Shown {
        motors: &motors,
        shown: MetricsConfig::default().motors as usize,
        page: Some(&state(&plant)),
        now_ms: now_ms(),
        ..Shown::default()
    });
    let kind = "text/plain; version=0.0.4; charset=utf-8";
    ([(header::CONTENT_TYPE, kind)], text).into_response()
}

/// Who was refused, and who does not read.
fn state(plant: &Plant) -> PageState {
    let (refused, slow) = (plant.refused.now(), &plant.slow);
    PageState {
        no_token: refused.no_token,
        wrong_role: refused.wrong_role,
        foreign: refused.foreign,
        behind: slow.behind.load(Relaxed),
        skipped: slow.skipped.load(Relaxed),
        cut: slow.cut.load(Relaxed),
    }
}
