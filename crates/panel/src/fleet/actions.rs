//! What people do to alarms. It is written down first; the gateway does it.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::extract::rejection::JsonRejection;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use fleet::alarm::Action;
use fleet::now_ms;
use fleet::people::{Outcome, PeopleError};
use schemars::JsonSchema;
use serde::Deserialize;

use super::access::{Visitor, refuse};
use super::answers::Done;
use super::plant::Plant;

/// So long the page waits for the gateway; it does what is asked all the same, later.
const PATIENCE: Duration = Duration::from_secs(3);
/// Between two looks.
const PAUSE: Duration = Duration::from_millis(40);
/// Characters of a reason.
const MOST_CHARACTERS: usize = 300;
const MINUTE_MS: i64 = 60_000;

/// Why.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Why {
    /// In the person's words, at most 300 characters. May be empty where nothing is set aside.
    #[serde(default)]
    why: String,
}

/// A shelf.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Shelf {
    /// Why, in the person's words, 1 to 300 characters.
    why: String,
    /// For how long, minutes, 1 to 10080 (a week).
    minutes: u32,
}

type Body<T> = Result<Json<T>, JsonRejection>;
type ThePlant = State<Arc<Plant>>;
type Who = Extension<Visitor>;
type Number = Path<u64>;

pub(super) async fn acknowledge(p: ThePlant, w: Who, n: Number, body: Body<Why>) -> Response {
    plain(p, w, n, body, Action::Acknowledge).await
}

pub(super) async fn unshelve(p: ThePlant, w: Who, n: Number, body: Body<Why>) -> Response {
    plain(p, w, n, body, Action::Unshelve).await
}

pub(super) async fn suppress(p: ThePlant, w: Who, n: Number, body: Body<Why>) -> Response {
    plain(p, w, n, body, Action::Suppress).await
}

pub(super) async fn unsuppress(p: ThePlant, w: Who, n: Number, body: Body<Why>) -> Response {
    plain(p, w, n, body, Action::Unsuppress).await
}

pub(super) async fn shelve(p: ThePlant, w: Who, n: Number, body: Body<Shelf>) -> Response {
    match body {
        Ok(Json(Shelf { why, minutes })) => {
            let until_ms = now_ms().saturating_add(i64::from(minutes) * MINUTE_MS);
            act(p, w, n, why, Action::Shelve { until_ms }).await
        }
        Err(error) => refuse(error.status(), error.body_text()),
    }
}

async fn plain(p: ThePlant, w: Who, n: Number, body: Body<Why>, action: Action) -> Response {
    match body {
        Ok(Json(Why { why })) => act(p, w, n, why, action).await,
        Err(error) => refuse(error.status(), error.body_text()),
    }
}

async fn act(
    State(plant): ThePlant,
    Extension(Visitor(user)): Who,
    Path(number): Number,
    why: String,
    action: Action,
) -> Response {
    let why = why.trim();
    if why.chars().count() > MOST_CHARACTERS {
        let words = format!("at most {MOST_CHARACTERS} characters for the reason");
        return refuse(StatusCode::UNPROCESSABLE_ENTITY, words);
    }
    // Routes of actions ask for a role that nobody has without a name.
    let Some(user) = user else {
        return refuse(StatusCode::UNAUTHORIZED, "sign in first");
    };
    let asked = plant.people.ask(&user, number, &action, why, now_ms());
    let waited = match asked {
        Ok(id) => outcome(&plant, id).await.map(|outcome| (id, outcome)),
        Err(error) => Err(error),
    };
    match waited {
        Ok((action, Some(Outcome { done: true, words }))) => Json(Done {
            action,
            done: true,
            message: words,
        })
        .into_response(),
        Ok((_, Some(Outcome { words, .. }))) => refuse(StatusCode::CONFLICT, words),
        Ok((action, None)) => {
            let message = LATER.to_owned();
            let done = Done {
                action,
                done: false,
                message,
            };
            (StatusCode::ACCEPTED, Json(done)).into_response()
        }
        Err(error) => refuse(StatusCode::SERVICE_UNAVAILABLE, error.to_string()),
    }
}

const LATER: &str =
    "written down; the gateway does not run, or is busy, and does it as soon as it can";

async fn outcome(plant: &Plant, id: u64) -> Result<Option<Outcome>, PeopleError> {
    let begin = Instant::now();
    loop {
        let outcome = plant.people.outcome(id)?;
        if outcome.is_some() || begin.elapsed() > PATIENCE {
            return Ok(outcome);
        }
        tokio::time::sleep(PAUSE).await;
    }
}
