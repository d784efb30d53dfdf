//! `GET /metrics`: the plant for Prometheus, on the page's own listener and behind its roles.

use std::sync::Arc;

use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use fleet::now_ms;
use uplink::metrics::{MetricsConfig, Plant as Shown, render};

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
        now_ms: now_ms(),
        ..Shown::default()
    });
    let kind = "text/plain; version=0.0.4; charset=utf-8";
    ([(header::CONTENT_TYPE, kind)], text).into_response()
}
