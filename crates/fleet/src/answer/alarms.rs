//! Alarms.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::words::{fault_name, finite};
use crate::alarm::change::{
    Alarm, AlarmCause, AlarmChange, AlarmState, Change, Phase, Severity, Who,
};

/// Alarms, those first that somebody has to look at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AlarmsAnswer {
    /// When this was asked, Unix ms.
    pub time_unix_ms: i64,
    /// The alarms.
    pub alarms: Vec<AlarmAnswer>,
    /// Whether there are more than were asked for.
    pub more: bool,
}

/// One alarm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AlarmAnswer {
    /// Its number in this plant.
    pub number: u64,
    /// Its motor; null: the plant as a whole.
    pub motor: Option<String>,
    /// What it is about.
    pub cause: AlarmCause,
    /// State (ISA-18.2).
    pub state: AlarmState,
    /// Whether the condition is there now.
    pub present: bool,
    /// Whether somebody took note since it last rose.
    pub acknowledged: bool,
    /// How soon somebody must act.
    pub severity: Severity,
    /// The likely fault, its short name.
    pub likely_fault: Option<String>,
    /// Phase, where one is known.
    pub phase: Option<Phase>,
    /// Of a fault the largest residual, percent of its scale.
    pub size_percent: Option<f32>,
    /// Of a gap how many are missing, of a flood how many alarms.
    pub count: Option<u64>,
    /// What it rests on, in words.
    pub words: String,
    /// Residuals r1 to r4 that showed it, percent of their scales.
    pub residuals_percent: [Option<f32>; 4],
    /// Number of the board's event that tells the same.
    pub event: Option<u32>,
    /// File of the recording around it.
    pub recording: Option<String>,
    /// When it last rose, Unix ms.
    pub raised_unix_ms: i64,
    /// When it last changed, Unix ms.
    pub changed_unix_ms: i64,
    /// How often it rose since it was last normal.
    pub times: u32,
    /// End of its shelf, Unix ms.
    pub shelved_until_unix_ms: Option<i64>,
}

impl AlarmAnswer {
    /// An alarm.
    pub fn new(alarm: &Alarm) -> Self {
        let counts = matches!(alarm.cause, AlarmCause::Gap | AlarmCause::Flood);
        let evidence = &alarm.evidence;
        Self {
            number: alarm.number,
            motor: alarm.motor.as_ref().map(ToString::to_string),
            cause: alarm.cause,
            state: alarm.state,
            present: alarm.present,
            acknowledged: alarm.acknowledged,
            severity: alarm.severity,
            likely_fault: fault_name(alarm.fault),
            phase: alarm.phase,
            size_percent: alarm
                .size
                .filter(|_| !counts)
                .and_then(|size| finite(100.0 * size)),
            count: alarm.size.filter(|_| counts).map(|size| size as u64),
            words: evidence.words.clone(),
            residuals_percent: evidence
                .residuals
                .map(|r| r.and_then(|r| finite(100.0 * r))),
            event: evidence.event,
            recording: evidence.recording.clone(),
            raised_unix_ms: alarm.raised_ms,
            changed_unix_ms: alarm.changed_ms,
            times: alarm.times,
            shelved_until_unix_ms: alarm.shelved_until_ms,
        }
    }
}

/// One alarm with all its changes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AlarmHistoryAnswer {
    /// The alarm as it is now.
    pub alarm: AlarmAnswer,
    /// Its changes, in order.
    pub changes: Vec<ChangeAnswer>,
}

impl AlarmHistoryAnswer {
    /// From all changes of an alarm, in order; `None` without any.
    pub fn new(changes: &[AlarmChange]) -> Option<Self> {
        let alarm = AlarmAnswer::new(&changes.last()?.alarm);
        Some(Self {
            alarm,
            changes: changes.iter().map(ChangeAnswer::new).collect(),
        })
    }
}

/// One change of an alarm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ChangeAnswer {
    /// What happened.
    pub change: Change,
    /// State before.
    pub before: AlarmState,
    /// State after.
    pub after: AlarmState,
    /// `board`, `gateway` or `user`.
    pub by: String,
    /// The user's name.
    pub user: Option<String>,
    /// When, Unix ms.
    pub time_unix_ms: i64,
    /// Why, in words.
    pub why: String,
}

impl ChangeAnswer {
    /// A change.
    pub fn new(change: &AlarmChange) -> Self {
        let (by, user) = match &change.who {
            Who::Board => ("board", None),
            Who::Gateway => ("gateway", None),
            Who::User(name) => ("user", Some(name.clone())),
        };
        Self {
            change: change.change,
            before: change.before,
            after: change.alarm.state,
            by: by.to_owned(),
            user,
            time_unix_ms: change.time_ms,
            why: change.why.clone(),
        }
    }
}
