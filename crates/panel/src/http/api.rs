//! Requests of the page.

use std::sync::Arc;

use axum::extract::State;
use axum::extract::rejection::JsonRejection;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use serde::Deserialize;

use crate::http::export;
use crate::http::stream::stream;
use crate::running::events::Acknowledgement;
use crate::running::fields::{Typed, with_typed};
use crate::running::session::Session;
use crate::running::shared::{Refusal, Request, unix_s};
use crate::source::SwitchedFault;

/// Source seconds per second on the wall.
const SPEEDS: std::ops::RangeInclusive<f64> = 0.01..=100.0;
/// Faults in force at once.
const MOST_FAULTS: usize = 32;

/// A request's body, or why it cannot be read.
type Body<T> = Result<Json<T>, JsonRejection>;

/// Everything under `/api/` apart from the workbench.
pub fn router(session: Arc<Session>) -> Router {
    Router::new()
        .route("/api/stream", get(stream))
        .route("/api/status", get(status))
        .route("/api/history", get(history))
        .route("/api/events", get(events))
        .route("/api/faults", post(faults))
        .route("/api/speed", post(speed))
        .route("/api/pause", post(pause))
        .route("/api/seek", post(seek))
        .route("/api/parameters", post(parameters))
        .route("/api/acknowledge", post(acknowledge))
        .route("/api/export/windows.{format}", get(export::windows))
        .route("/api/events/{id}/recording.{format}", get(export::around))
        .with_state(session)
}

async fn status(State(session): State<Arc<Session>>) -> Response {
    Json(session.status()).into_response()
}

async fn history(State(session): State<Arc<Session>>) -> Response {
    Json(session.history()).into_response()
}

async fn events(State(session): State<Arc<Session>>) -> Response {
    Json(session.events()).into_response()
}

#[derive(Debug, Deserialize)]
struct Faults {
    faults: Vec<SwitchedFault>,
}

async fn faults(State(session): State<Arc<Session>>, body: Body<Faults>) -> Response {
    let request = body_of(body).and_then(|Faults { faults }| match faults.len() <= MOST_FAULTS {
        true => Ok(Request::Faults(faults)),
        false => Err(Refusal::of(format!("at most {MOST_FAULTS} faults at once"))),
    });
    ask(&session, request).await
}

#[derive(Debug, Deserialize)]
struct Speed {
    speed: f64,
}

async fn speed(State(session): State<Arc<Session>>, body: Body<Speed>) -> Response {
    let request = body_of(body).and_then(|Speed { speed }| {
        if !session.status().source.can.pace {
            return Err(Refusal::of("a board runs at its own speed"));
        }
        let (least, most) = (SPEEDS.start(), SPEEDS.end());
        match SPEEDS.contains(&speed) {
            true => Ok(Request::Speed(speed)),
            false => Err(Refusal::of(format!(
                "{speed} is no speed: choose one from {least} to {most}"
            ))),
        }
    });
    ask(&session, request).await
}

#[derive(Debug, Deserialize)]
struct Pause {
    paused: bool,
}

async fn pause(State(session): State<Arc<Session>>, body: Body<Pause>) -> Response {
    let request =
        body_of(body).and_then(|Pause { paused }| match session.status().source.can.pace {
            true => Ok(Request::Pause(paused)),
            false => Err(Refusal::of("a board cannot be stopped from here")),
        });
    ask(&session, request).await
}

#[derive(Debug, Deserialize)]
struct Seek {
    t_s: f64,
}

async fn seek(State(session): State<Arc<Session>>, body: Body<Seek>) -> Response {
    let request = body_of(body).and_then(|Seek { t_s }| match t_s.is_finite() {
        true => Ok(Request::Seek(t_s)),
        false => Err(Refusal::of("that is no time")),
    });
    ask(&session, request).await
}

async fn parameters(State(session): State<Arc<Session>>, body: Body<Typed>) -> Response {
    let motor = session.motor();
    let request = body_of(body).and_then(|typed| {
        let motor = motor
            .ok_or_else(|| Refusal::of("there is no motor file: start the panel with --motor M"))?;
        let motor = with_typed(&motor, &typed).map_err(|problems| Refusal {
            problems,
            ..Refusal::of("the motor file's reader refuses this")
        })?;
        Ok(Request::Motor(Box::new(motor)))
    });
    ask(&session, request).await
}

/// Characters of a name and of a comment.
const MOST_CHARACTERS: [usize; 2] = [60, 300];

/// Who has seen the alarms, and what they say about them.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Seen {
    by: String,
    comment: String,
}

async fn acknowledge(State(session): State<Arc<Session>>, body: Body<Seen>) -> Response {
    let request = body_of(body).and_then(|Seen { by, comment }| {
        let long = |text: &str, most| text.chars().count() > most;
        let [name, words] = MOST_CHARACTERS;
        match long(&by, name) || long(&comment, words) {
            true => Err(Refusal::of(format!(
                "at most {name} characters for the name and {words} for the comment"
            ))),
            false => Ok(Request::Acknowledge(Acknowledgement {
                by: by.trim().to_owned(),
                unix_s: unix_s() as u64,
                comment: comment.trim().to_owned(),
            })),
        }
    });
    ask(&session, request).await
}

fn body_of<T>(body: Body<T>) -> Result<T, Refusal> {
    body.map(|Json(body)| body).map_err(|error| Refusal {
        status: error.status().as_u16(),
        ..Refusal::of(error.body_text())
    })
}

async fn ask(session: &Session, request: Result<Request, Refusal>) -> Response {
    let done = match request {
        Ok(request) => session.request(request).await,
        Err(refusal) => Err(refusal),
    };
    match done {
        Ok(()) => StatusCode::NO_CONTENT.into_response(),
        Err(refusal) => {
            let status = StatusCode::from_u16(refusal.status);
            let status = status.unwrap_or(StatusCode::UNPROCESSABLE_ENTITY);
            (status, Json(refusal)).into_response()
        }
    }
}
