//! What the page and other programs ask.

use std::sync::Arc;

use axum::Json;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Path, Query, State};
use axum::http::StatusCode;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use fleet::alarm::{AlarmFilter, AlarmState};
use fleet::{EntryFilter, MotorId, NoRecording, StoreError, now_ms};
use live::Fetched;
use motor::MotorFile;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::access::{Refusal, refuse};
use super::answers::{Alarms, Audit, Events, Motor};
use super::convert;
use super::plant::Plant;

/// Points of a trend where nobody asks for another number: the columns of a usual screen.
const POINTS: usize = 800;
/// Most points of one answer.
const MOST_POINTS: usize = 5_000;
/// Lines of one answer.
const LINES: usize = 200;
const MOST_LINES: usize = 2_000;
/// Alarms on a motor's page.
const OF_MOTOR: usize = 20;
/// A day, ms.
const DAY_MS: i64 = 86_400_000;

type Asked<T> = Result<Query<T>, QueryRejection>;

/// Does work that reads files on a thread that may wait.
pub(super) async fn answer<T: Serialize + Send + 'static>(
    work: impl FnOnce() -> Result<T, Refusal> + Send + 'static,
) -> Response {
    match tokio::task::spawn_blocking(work).await {
        Ok(Ok(answer)) => Json(answer).into_response(),
        Ok(Err(Refusal(status, message))) => refuse(status, message),
        // The work panicked: the next question is answered all the same.
        Err(error) => refuse(StatusCode::INTERNAL_SERVER_ERROR, error.to_string()),
    }
}

pub(super) fn failed(error: StoreError) -> Refusal {
    let status = match error {
        StoreError::UnknownMotor(_) => StatusCode::NOT_FOUND,
        _ => StatusCode::SERVICE_UNAVAILABLE,
    };
    Refusal(status, error.to_string())
}

fn query<T>(asked: Asked<T>) -> Result<T, Refusal> {
    asked
        .map(|Query(query)| query)
        .map_err(|error| Refusal(StatusCode::BAD_REQUEST, error.body_text()))
}

fn motor_id(text: &str) -> Result<MotorId, Refusal> {
    text.parse()
        .map_err(|error| Refusal(StatusCode::BAD_REQUEST, format!("{error}")))
}

fn lines(limit: Option<usize>) -> usize {
    limit.unwrap_or(LINES).clamp(1, MOST_LINES)
}

pub(super) async fn wall(State(plant): State<Arc<Plant>>) -> Response {
    match plant.trouble() {
        trouble if trouble.is_empty() => Json(&*plant.wall()).into_response(),
        trouble => refuse(StatusCode::SERVICE_UNAVAILABLE, trouble),
    }
}

pub(super) async fn motor(State(plant): State<Arc<Plant>>, Path(id): Path<String>) -> Response {
    answer(move || {
        let id = motor_id(&id)?;
        let states = plant.reader.motors().map_err(failed)?;
        let state = states.into_iter().find(|state| state.info.id == id);
        let state = state.ok_or_else(|| failed(StoreError::UnknownMotor(id.clone())))?;
        let filter = AlarmFilter {
            motor: Some(id.clone()),
            limit: OF_MOTOR,
            ..AlarmFilter::default()
        };
        let alarms = plant.reader.alarms(&filter).map_err(failed)?;
        let stale_ms = plant.settings.stale_ms;
        let open = alarms
            .iter()
            .filter(|alarm| alarm.state != AlarmState::Normal);
        let open: Vec<_> = open.cloned().collect();
        let mut wall = super::wall::wall(std::slice::from_ref(&state), &open, now_ms(), stale_ms);
        let link = state.link;
        Ok(Motor {
            now_ms: wall.now_ms,
            tile: wall.motors.remove(0),
            nameplate: state.info.nameplate,
            link: state.info.link,
            answers: link.as_ref().map(|link| link.up),
            why: link.map_or(String::new(), |link| link.why),
            motor_file: state.info.motor_file,
            alarms: alarms.iter().map(convert::alarm).collect(),
        })
    })
    .await
}

/// The time of a trend.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Span {
    /// Begin, Unix ms; a day before the end where it is left out.
    from_ms: Option<i64>,
    /// End, Unix ms; now where it is left out.
    to_ms: Option<i64>,
    /// At most so many points, 1 to 5000; 800 where it is left out.
    points: Option<usize>,
}

pub(super) async fn trend(
    State(plant): State<Arc<Plant>>,
    Path(id): Path<String>,
    asked: Asked<Span>,
) -> Response {
    answer(move || {
        let (id, span) = (motor_id(&id)?, query(asked)?);
        let to_ms = span.to_ms.unwrap_or_else(now_ms);
        let from_ms = span.from_ms.unwrap_or(to_ms.saturating_sub(DAY_MS));
        let points = span.points.unwrap_or(POINTS);
        if from_ms >= to_ms || !(1..=MOST_POINTS).contains(&points) {
            let why = format!("from_ms must be before to_ms, and points from 1 to {MOST_POINTS}");
            return Err(Refusal(StatusCode::BAD_REQUEST, why));
        }
        let trend = plant.reader.trend(&id, from_ms, to_ms, points);
        Ok(convert::trend(&trend.map_err(failed)?))
    })
    .await
}

/// Which alarms.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct WhichAlarms {
    /// Of this motor; of all where it is left out.
    motor: Option<String>,
    /// `open` (that somebody has to look at, the usual), `set_aside` (shelved or suppressed) or `all`.
    show: Option<Show>,
    /// Changed at or after, Unix ms.
    from_ms: Option<i64>,
    /// Raised before, Unix ms.
    to_ms: Option<i64>,
    /// At most so many, up to 2000; 200 where it is left out.
    limit: Option<usize>,
}

/// Which states of alarms.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Show {
    #[default]
    Open,
    SetAside,
    All,
}

pub(super) async fn alarms(State(plant): State<Arc<Plant>>, asked: Asked<WhichAlarms>) -> Response {
    answer(move || {
        use AlarmState::{
            Acknowledged, ReturnedUnacknowledged, Shelved, Suppressed, Unacknowledged,
        };
        let which = query(asked)?;
        let filter = AlarmFilter {
            motor: which.motor.as_deref().map(motor_id).transpose()?,
            states: match which.show.unwrap_or_default() {
                Show::Open => vec![Unacknowledged, Acknowledged, ReturnedUnacknowledged],
                Show::SetAside => vec![Shelved, Suppressed],
                Show::All => vec![],
            },
            from_ms: which.from_ms,
            to_ms: which.to_ms,
            limit: lines(which.limit),
        };
        let alarms = plant.reader.alarms(&filter).map_err(failed)?;
        Ok(Alarms {
            now_ms: now_ms(),
            alarms: alarms.iter().map(convert::alarm).collect(),
        })
    })
    .await
}

/// The recording of an alarm as CSV.
pub(super) async fn recording(
    State(plant): State<Arc<Plant>>,
    Path(number): Path<u64>,
) -> Response {
    let work = move || {
        let kept = plant.reader.recording_of_alarm(number)?;
        let motor = MotorFile::read(&kept.motor_file).map_err(unusable)?;
        let fetched = Fetched::of_file(kept.constants, &kept.instants).map_err(unusable)?;
        let recording = live::recording(&fetched, &motor).map_err(unusable)?;
        let mut text = Vec::new();
        formats::write_csv(&recording, &mut text).map_err(unusable)?;
        Ok::<_, Refusal>(text)
    };
    match tokio::task::spawn_blocking(work).await {
        Ok(Ok(text)) => {
            let kept_as = format!("attachment; filename=\"alarm-{number}.csv\"");
            let headers = [(CONTENT_TYPE, "text/csv"), (CONTENT_DISPOSITION, &kept_as)];
            (headers, text).into_response()
        }
        Ok(Err(Refusal(status, message))) => refuse(status, message),
        Err(error) => refuse(StatusCode::INTERNAL_SERVER_ERROR, error.to_string()),
    }
}

/// What was kept does not become a recording as the plant is configured.
fn unusable(error: impl std::fmt::Display) -> Refusal {
    Refusal(StatusCode::CONFLICT, error.to_string())
}

impl From<NoRecording> for Refusal {
    fn from(error: NoRecording) -> Self {
        match error {
            NoRecording::Store(error) => failed(error),
            error => unusable(error),
        }
    }
}

/// Which events.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct WhichEvents {
    /// Of this motor; of all where it is left out.
    motor: Option<String>,
    /// Before this id: the next page.
    before: Option<u64>,
    /// At most so many, up to 2000; 200 where it is left out.
    limit: Option<usize>,
}

pub(super) async fn events(State(plant): State<Arc<Plant>>, asked: Asked<WhichEvents>) -> Response {
    answer(move || {
        let which = query(asked)?;
        let filter = EntryFilter {
            motor: which.motor.as_deref().map(motor_id).transpose()?,
            before: which.before,
            alarms: true,
        };
        let stored = plant.reader.entries(&filter, lines(which.limit));
        let events = stored.map_err(failed)?;
        let events = events.iter().filter_map(convert::event).collect();
        Ok(Events { events })
    })
    .await
}

/// Which lines of the audit trail.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct WhichLines {
    /// Before this number: the next page.
    before: Option<u64>,
    /// At most so many, up to 2000; 200 where it is left out.
    limit: Option<usize>,
}

pub(super) async fn audit(State(plant): State<Arc<Plant>>, asked: Asked<WhichLines>) -> Response {
    answer(move || {
        let which = query(asked)?;
        let trail = plant.people.trail(which.before, lines(which.limit));
        let trail =
            trail.map_err(|error| Refusal(StatusCode::SERVICE_UNAVAILABLE, error.to_string()))?;
        Ok(Audit {
            refused: plant.refused.now(),
            lines: trail.into_iter().map(convert::audit_line).collect(),
        })
    })
    .await
}
