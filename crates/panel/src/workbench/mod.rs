//! The workbench: load recordings, check, compare, explain, adopt, save. It brings its own routes and state.
//!
//! One desk for all pages of a panel: two recordings, one motor file, one question at a time. What the questions
//! answer is what the commands answer; what is shown of it is what their reports show.

mod check;
mod desk;
mod jobs;
mod known;
mod mapping;
mod motor_requests;
mod motors;
mod recordings;
mod regions;
mod slot;
mod upload;

use std::sync::Arc;

use axum::extract::{DefaultBodyLimit, Path, State};
use axum::http::StatusCode;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};

use crate::running::session::Session;
use crate::running::shared::Refusal;
use desk::Kind;

pub use desk::Bench;

/// Requests apart from files: a mapping, a choice.
const MOST_REQUEST_BYTES: usize = 64 * 1024;

/// The desk; it must be cleared when the panel ends.
pub fn bench(session: Arc<Session>) -> Arc<Bench> {
    Bench::new(session)
}

/// Its routes, all under `/api/workbench/`; the server merges them behind its guard.
pub fn router(bench: Arc<Bench>) -> Router {
    let files = Router::new()
        .route(
            "/api/workbench/recordings/{slot}/file",
            post(recordings::file),
        )
        // The handler counts for itself and says its bound.
        .layer(DefaultBodyLimit::disable());
    Router::new()
        .route("/api/workbench/state", get(state))
        .route(
            "/api/workbench/recordings/{slot}/sidecar",
            post(recordings::sidecar),
        )
        .route(
            "/api/workbench/recordings/{slot}/mapping",
            post(recordings::mapping),
        )
        .route(
            "/api/workbench/recordings/{slot}/remove",
            post(recordings::remove),
        )
        .route("/api/workbench/motor", post(motor_requests::choose))
        .route("/api/workbench/motor/file", post(motor_requests::file))
        .route("/api/workbench/motor/undo", post(motor_requests::undo))
        .route("/api/workbench/motor.toml", get(motor_requests::save))
        .route("/api/workbench/check/form", get(check::form))
        .route("/api/workbench/check/attempt", post(check::attempt))
        .route("/api/workbench/check/plate", post(check::plate))
        .route("/api/workbench/check/motor", post(check::motor))
        .route("/api/workbench/check/next", post(check::next))
        .route("/api/workbench/check/report.html", get(check::report))
        .route("/api/workbench/jobs", post(jobs::begin))
        .route("/api/workbench/jobs/stop", post(jobs::stop))
        .route("/api/workbench/results/{kind}", get(result))
        .route("/api/workbench/region", get(regions::region))
        .layer(DefaultBodyLimit::max(MOST_REQUEST_BYTES))
        .merge(files)
        .with_state(bench)
}

async fn state(State(bench): State<Arc<Bench>>) -> Response {
    Json(bench.state()).into_response()
}

async fn result(State(bench): State<Arc<Bench>>, Path(kind): Path<Kind>) -> Response {
    match bench.desk().results.get(&kind) {
        Some(json) => ([(CONTENT_TYPE, "application/json")], json.to_string()).into_response(),
        None => refused(&Refusal {
            status: 404,
            ..Refusal::of("there is no such result")
        }),
    }
}

/// The answer to a request that was refused.
fn refused(refusal: &Refusal) -> Response {
    let status = StatusCode::from_u16(refusal.status);
    let status = status.unwrap_or(StatusCode::UNPROCESSABLE_ENTITY);
    (status, Json(refusal)).into_response()
}

/// The state after a request, or why it was refused.
fn answer(bench: &Bench, done: Result<(), Refusal>) -> Response {
    match done {
        Ok(()) => Json(bench.state()).into_response(),
        Err(refusal) => refused(&refusal),
    }
}
