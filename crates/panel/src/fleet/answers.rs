//! What the API answers. Times are Unix milliseconds of the gateway's clock.

use fleet::people::{Role, User};
use schemars::JsonSchema;
use serde::Serialize;

use super::words::Condition;

/// All motors.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct Wall {
    /// When this was so, Unix ms by this computer's clock.
    pub now_ms: i64,
    /// How many motors are in which condition, and how many alarms are open.
    pub counts: Counts,
    /// Motors, the worst first.
    pub motors: Vec<Tile>,
}

/// How many motors are in which condition; each motor counts once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Counts {
    /// All.
    pub motors: u32,
    /// FAULT is lit.
    pub fault: u32,
    /// An instrument, the supply or the load: SENSOR, LINE or LOAD is lit.
    pub attention: u32,
    /// Nothing known: no data for too long, or none ever.
    pub stale: u32,
    /// Running and not judged now.
    pub not_judged: u32,
    /// Without supply.
    pub off: u32,
    /// Judged and within every threshold.
    pub healthy: u32,
    /// Alarms that nobody has acknowledged, those of the plant as a whole included.
    pub unacknowledged: u32,
    /// Alarms that are shelved or suppressed.
    pub set_aside: u32,
}

/// One motor of the wall.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Tile {
    /// Name within the plant.
    pub id: String,
    /// What people call it.
    pub title: String,
    /// Where it is.
    pub place: String,
    /// Place in the order: the smaller, the more urgent.
    pub rank: u32,
    /// What is known of it now.
    pub condition: Condition,
    /// What that rests on, in a few words.
    pub words: String,
    /// Its most urgent alarm that is not normal.
    pub alarm: Option<TileAlarm>,
    /// Alarms that somebody has to look at.
    pub open_alarms: u32,
    /// Its newest second; `null`: none yet.
    pub last: Option<Latest>,
}

/// The alarm of a tile.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct TileAlarm {
    /// Its number.
    pub number: u64,
    /// `unacknowledged`, `acknowledged`, `returned_unacknowledged`, `shelved` or `suppressed`.
    pub state: &'static str,
    /// `high`, `medium` or `low`.
    pub severity: &'static str,
    /// What it is about, in words.
    pub words: String,
    /// When it last rose, Unix ms.
    pub raised_ms: i64,
}

/// A second of a motor.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Latest {
    /// Its end, Unix ms.
    pub time_ms: i64,
    /// The nine lamps in the order RUN r1 r2 r3 r4 SENSOR LINE LOAD FAULT: 0 off, 1 on, 2 blinking.
    pub lamps: [u8; 9],
    /// Means of r1 to r4, percent of their scales; `null`: not known.
    pub residuals_percent: [Option<f32>; 4],
    /// Voltage, V RMS.
    pub voltage_v: Option<f32>,
    /// Current, A RMS.
    pub current_a: Option<f32>,
    /// Frequency of the supply, Hz.
    pub frequency_hz: Option<f32>,
    /// Speed, 1/min.
    pub speed_rpm: Option<f32>,
}

/// One motor with what is known of it.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Motor {
    /// When this was so, Unix ms.
    pub now_ms: i64,
    /// As on the wall.
    pub tile: Tile,
    /// The nameplate in words.
    pub nameplate: String,
    /// How its board is reached.
    pub link: String,
    /// Whether the board answers; `null`: not known.
    pub answers: Option<bool>,
    /// Why it does not answer.
    pub why: String,
    /// Path of its motor file, where the configuration names one.
    pub motor_file: Option<String>,
    /// Its newest alarms, those that are not normal first.
    pub alarms: Vec<Alarm>,
}

/// An alarm.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Alarm {
    /// Its number in this plant.
    pub number: u64,
    /// Its motor; `null`: the plant as a whole.
    pub motor: Option<String>,
    /// `fault`, `sensor`, `doubt`, `link_lost`, `gap` or `flood`.
    pub cause: &'static str,
    /// What it is about, in words; causes that cannot be told apart are named together.
    pub words: String,
    /// `normal`, `unacknowledged`, `acknowledged`, `returned_unacknowledged`, `shelved` or `suppressed`.
    pub state: &'static str,
    /// `high`, `medium` or `low`.
    pub severity: &'static str,
    /// Whether the condition is there now.
    pub present: bool,
    /// Of a fault the largest residual, percent of its scale.
    pub size_percent: Option<f32>,
    /// What it rests on, in words.
    pub evidence: String,
    /// Residuals that showed it, percent of their scales.
    pub residuals_percent: [Option<f32>; 4],
    /// Name of the recording around it, which `/api/fleet/alarms/{number}/recording` gives out.
    pub recording: Option<String>,
    /// Why there is no recording.
    pub no_recording: Option<String>,
    /// When it last rose, Unix ms.
    pub raised_ms: i64,
    /// When it last changed, Unix ms.
    pub changed_ms: i64,
    /// How often it rose since it was last normal.
    pub times: u32,
    /// End of the shelf, Unix ms.
    pub shelved_until_ms: Option<i64>,
}

/// Alarms, those that somebody has to look at first.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Alarms {
    /// When this was so, Unix ms.
    pub now_ms: i64,
    /// The alarms.
    pub alarms: Vec<Alarm>,
}

/// What happened, the newest first.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Events {
    /// The events; the id of the last one is `before` of the next page.
    pub events: Vec<Event>,
}

/// Something that happened.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Event {
    /// Its place in the store.
    pub id: u64,
    /// Its motor; `null`: the plant as a whole.
    pub motor: Option<String>,
    /// When, Unix ms.
    pub time_ms: i64,
    /// `board`, `alarm`, `gap`, `link`, `recording`, `exchange` or `history`.
    pub kind: &'static str,
    /// In words.
    pub words: String,
    /// Who did it, where a person did.
    pub who: Option<String>,
    /// Why, in the person's words.
    pub why: Option<String>,
}

/// A motor's history in points of equal length; points without a second are left out.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct Trend {
    /// Length of a point, ms.
    pub step_ms: i64,
    /// Begin of each point, Unix ms.
    pub time_ms: Vec<i64>,
    /// Lamps of each point, two bits each from RUN in the lowest: 0 off, 1 on, 2 blinking; of each the most severe.
    pub lamps: Vec<u32>,
    /// Seconds of each point that are stored.
    pub seconds: Vec<u32>,
    /// r1 to r4, percent of their scales.
    pub residuals_percent: [Band; 4],
    /// Voltage, V RMS.
    pub voltage_v: Band,
    /// Current, A RMS.
    pub current_a: Band,
    /// Frequency of the supply, Hz.
    pub frequency_hz: Band,
    /// Speed, 1/min.
    pub speed_rpm: Band,
}

/// Least, mean and largest value of each point; `null`: not known.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct Band {
    /// Least.
    pub min: Vec<Option<f32>>,
    /// Mean.
    pub mean: Vec<Option<f32>>,
    /// Largest.
    pub max: Vec<Option<f32>>,
}

/// Who asks.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Me {
    /// Name; `null`: nobody has signed in.
    pub name: Option<String>,
    /// What may be done: `see`, `acknowledge` or `configure`; `null`: nothing.
    pub role: Option<&'static str>,
}

impl Me {
    pub(super) fn of(user: Option<&User>, open: bool) -> Self {
        let role = user.map(|user| user.role).or(open.then_some(Role::See));
        Self {
            name: user.map(|user| user.name.clone()),
            role: role.map(Role::name),
        }
    }
}

/// How an action ended.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Done {
    /// Number of the action in the audit trail.
    pub action: u64,
    /// Whether the gateway has done it. `false`: it is written down, and the gateway does it as soon as it runs.
    pub done: bool,
    /// In words.
    pub message: String,
}

/// The audit trail, the newest first.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Audit {
    /// What was refused since this server started.
    pub refused: Refused,
    /// Lines; the id of the last one is `before` of the next page.
    pub lines: Vec<AuditLine>,
}

/// Requests that were refused since this server started.
#[derive(Clone, Copy, Debug, Default, Serialize, JsonSchema)]
pub struct Refused {
    /// Without a token, or with one that is not known.
    pub no_token: u64,
    /// By a role that may not.
    pub wrong_role: u64,
    /// By another site through a visitor's browser, or under a foreign name.
    pub foreign: u64,
}

/// A line of the audit trail.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct AuditLine {
    /// Its number.
    pub id: u64,
    /// When, Unix ms.
    pub time_ms: i64,
    /// Who.
    pub who: String,
    /// What.
    pub what: String,
    /// Number of the alarm.
    pub alarm: Option<u64>,
    /// Why, in the person's words.
    pub why: String,
    /// Whether it was done; `null`: not yet.
    pub done: Option<bool>,
    /// Why not, in words.
    pub outcome: String,
}

/// Why a request is refused.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Problem {
    /// In words.
    pub message: String,
}
