//! What is kept of an alarm, and of each of its changes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::motor::MotorId;

/// State of an alarm (ISA-18.2, figure "alarm state transition diagram").
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum AlarmState {
    /// Condition gone, and somebody knows of it.
    Normal,
    /// Condition present; nobody has acknowledged.
    Unacknowledged,
    /// Condition present; acknowledged.
    Acknowledged,
    /// Condition gone before anybody acknowledged.
    ReturnedUnacknowledged,
    /// Set aside by a person until a time.
    Shelved,
    /// Set aside by the plant: a flood, or out of service.
    Suppressed,
}

/// How soon somebody must act.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Something is not known that should be: link, gap, doubt.
    Low,
    /// An instrument is faulty: the motor is not watched.
    Medium,
    /// A fault of the motor.
    High,
}

/// What an alarm is about. One alarm per motor and cause.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum AlarmCause {
    /// FAULT: the likely fault stands in [`Alarm::fault`], which may change while the alarm stays the same.
    Fault,
    /// SENSOR: an instrument.
    Sensor,
    /// The board doubts itself.
    Doubt,
    /// The board does not answer.
    LinkLost,
    /// Seconds or events are missing.
    Gap,
    /// Many alarms at once: they are collected here (all motors).
    Flood,
}

/// Who changed an alarm.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Who {
    /// The motor's board.
    Board,
    /// The gateway: delays, ends of shelves, floods.
    Gateway,
    /// A person, by name.
    User(String),
}

/// What an alarm rests on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// The second that showed it: start and number; `None` where an event or the link did.
    pub second: Option<(u32, u32)>,
    /// Number of the board's event that showed it.
    pub event: Option<u32>,
    /// Residuals r1 to r4 of that second, shares of their scales; `None`: that one is not known.
    pub residuals: [Option<f32>; 4],
    /// Name of the recording around it, by which the store gives it out.
    pub recording: Option<String>,
    /// Why there is none, where that is known.
    #[serde(default)]
    pub no_recording: Option<String>,
    /// In words.
    pub words: String,
}

/// An alarm as it is now.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alarm {
    /// Its number in this plant, from 1.
    pub number: u64,
    /// Its motor; `None`: the plant.
    pub motor: Option<MotorId>,
    /// What it is about.
    pub cause: AlarmCause,
    /// State.
    pub state: AlarmState,
    /// Whether the condition is there now, delays applied; also known while the alarm is shelved or suppressed.
    pub present: bool,
    /// Whether it was acknowledged since it last rose.
    pub acknowledged: bool,
    /// Whether the plant sets it aside.
    pub suppressed: bool,
    /// How soon somebody must act.
    pub severity: Severity,
    /// The likely fault, number of `motor::FaultId`; 0: not known.
    pub fault: u8,
    /// Size: the largest residual, share of its scale; of a gap how many are missing; of a flood how many alarms.
    pub size: Option<f32>,
    /// What it rests on.
    pub evidence: Evidence,
    /// When it last rose, Unix ms.
    pub raised_ms: i64,
    /// When it last changed, Unix ms.
    pub changed_ms: i64,
    /// How often it rose since it was last normal.
    pub times: u32,
    /// End of the shelf, Unix ms.
    pub shelved_until_ms: Option<i64>,
}

impl Alarm {
    /// Why there is no recording around it, in words; `None`: there is one.
    pub fn why_no_recording(&self) -> Option<String> {
        if self.evidence.recording.is_some() {
            return None;
        }
        let known = self.evidence.no_recording.clone();
        let why = match self.cause {
            AlarmCause::Fault => {
                "it was not fetched yet: a board hands it over within a minute, where it can"
            }
            _ => "boards record when FAULT lights; this alarm has another cause",
        };
        Some(known.unwrap_or_else(|| why.to_owned()))
    }
}

/// What happened to an alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Change {
    /// The condition came.
    Raised,
    /// The condition went.
    Returned,
    /// Cause, size or severity changed, the alarm is the same.
    Updated,
    /// A person took note.
    Acknowledged,
    /// A person set it aside.
    Shelved,
    /// The shelf ended.
    Unshelved,
    /// The plant set it aside.
    Suppressed,
    /// The plant no longer sets it aside.
    Unsuppressed,
}

/// One change: the alarm after it, with who, when and why.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AlarmChange {
    /// What happened.
    pub change: Change,
    /// State before.
    pub before: AlarmState,
    /// The alarm after it.
    pub alarm: Alarm,
    /// Who.
    pub who: Who,
    /// When, Unix ms.
    pub time_ms: i64,
    /// Why, in words.
    pub why: String,
}

/// Which alarms are asked for; what is empty does not restrict.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AlarmFilter {
    /// Of this motor.
    pub motor: Option<MotorId>,
    /// In one of these states.
    pub states: Vec<AlarmState>,
    /// Changed at or after, Unix ms.
    pub from_ms: Option<i64>,
    /// Raised before, Unix ms.
    pub to_ms: Option<i64>,
    /// At most so many; 0: 1000.
    pub limit: usize,
}
