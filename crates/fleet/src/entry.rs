//! What is stored of a motor, one entry after the other.

use serde::{Deserialize, Serialize};

use crate::alarm::change::AlarmChange;
use crate::motor::MotorId;

/// What a board reports of one second.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Second {
    /// Run of the board's program: the number of the first event of this start.
    pub start: u32,
    /// Second since the start, from 1.
    pub number: u32,
    /// Unix time by the gateway's clock, ms.
    pub time_ms: i64,
    /// Lamps, two bits each from the lowest in the order RUN r1 r2 r3 r4 SENSOR LINE LOAD FAULT: 0 off, 1 on, 2 blinking; of
    /// each lamp the most severe within the second.
    pub lamps: u32,
    /// Windows that ended in this second.
    pub windows: u8,
    /// Those that were judged.
    pub judged: u8,
    /// Reason of the last window that was not judged; 0: all were.
    pub not_judged: u8,
    /// The likely fault of the last window, by its number (`motor::FaultId`).
    pub fault: u8,
    /// Means of r1 to r4, shares of their scales; NaN: that one is not known. Stored to 1e-4, within +-3.2767.
    #[serde(with = "with_gaps")]
    pub residuals: Option<[f32; 4]>,
    /// Voltage, V RMS.
    pub voltage_v: Option<f32>,
    /// Current, A RMS.
    pub current_a: Option<f32>,
    /// Frequency of the supply, Hz.
    pub frequency_hz: Option<f32>,
    /// Speed, 1/min.
    pub speed_rpm: Option<f32>,
}

/// Text has no NaN: a residual that is not known is null there.
mod with_gaps {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(all: &Option<[f32; 4]>, to: S) -> Result<S::Ok, S::Error> {
        all.map(|all| all.map(|r| Some(r).filter(|r| r.is_finite())))
            .serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<[f32; 4]>, D::Error> {
        let all = Option::<[Option<f32>; 4]>::deserialize(from)?;
        Ok(all.map(|all| all.map(|r| r.unwrap_or(f32::NAN))))
    }
}

impl Second {
    /// State of a lamp by its place ([`crate::lamp`]): 0 off, 1 on, 2 blinking.
    pub fn lamp(&self, index: u32) -> u8 {
        self.lamps
            .checked_shr(2 * index)
            .map_or(0, |bits| (bits & 3) as u8)
    }

    /// Whether a lamp is on. One that blinks waits for somebody: that is no finding about the motor.
    pub fn is_on(&self, place: u32) -> bool {
        self.lamp(place) == 1
    }
}

/// An event of the board's log (`board::EventCause` names causes and values).
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BoardEvent {
    /// Its number over the board's life, from 1.
    pub number: u32,
    /// Unix time by the gateway's clock, ms.
    pub time_ms: i64,
    /// Number of the cause.
    pub cause: u16,
    /// How often it happened before it was written.
    pub times: u16,
    /// What its two values say depends on the cause.
    pub values: [u32; 2],
}

/// What was not received, and cannot be asked for again.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Gap {
    /// What is missing.
    pub what: GapOf,
    /// First missing number.
    pub first: u32,
    /// Last missing number.
    pub last: u32,
    /// When the gap was noticed, Unix ms.
    pub time_ms: i64,
}

/// Numbers of which a gap tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GapOf {
    /// Seconds of one run of the program.
    Seconds {
        /// The run.
        start: u32,
    },
    /// Events.
    Events,
    /// Frames, by their sequence number.
    Frames,
}

/// A link to a board came up or went down.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Link {
    /// Whether the board answers.
    pub up: bool,
    /// Since when, Unix ms.
    pub time_ms: i64,
    /// Why it is down; empty where it is up.
    pub why: String,
}

/// The samples around an alarm, fetched from a board; or why there are none.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Recording {
    /// When it was fetched, Unix ms.
    pub time_ms: i64,
    /// Begin of its samples, Unix ms; known to the second.
    pub from_ms: i64,
    /// End of its samples, Unix ms.
    pub to_ms: i64,
    /// Which of its board: the run and what counts in it. The same one is stored once.
    #[serde(default)]
    pub key: RecordingKey,
    /// Its name in this store, by which it is read; given when it is stored.
    pub file: String,
    /// Size of the samples, bytes.
    pub bytes: u64,
    /// The alarm it belongs to; `None`: the one that rose at its time.
    pub alarm: Option<u64>,
    /// Why there are no samples, in words.
    #[serde(default)]
    pub missing: Option<String>,
    /// What the board calls its motor constants (`board::MotorImage::identification`).
    #[serde(default)]
    pub motor: u32,
    /// The samples as the board has them (`board::captured_samples`); only on the way into the store, which gives them out
    /// by name.
    #[serde(skip)]
    pub samples: Vec<u8>,
}

/// Which recording of a board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RecordingKey {
    /// Nothing counts it.
    #[default]
    None,
    /// The run of the program and the second in which FAULT lit.
    Second {
        /// The run.
        start: u32,
        /// The second of it.
        second: u32,
    },
    /// The run and the number of the capture: what a board tells with frames.
    Capture {
        /// The run.
        start: u32,
        /// The number.
        number: u8,
    },
}

impl RecordingKey {
    /// The name of a motor's recording; `board` counts the boards that the motor had before.
    pub(crate) fn name(self, motor: &MotorId, board: u32) -> String {
        match self {
            RecordingKey::None => format!("{motor}.{board}"),
            RecordingKey::Second { start, second } => format!("{motor}.{board}.{start}.{second}"),
            RecordingKey::Capture { start, number } => format!("{motor}.{board}.{start}.c{number}"),
        }
    }
}

/// History that was thinned because of its age or because the store was full. It concerns all motors.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Thinned {
    /// What was done.
    pub to: ThinnedTo,
    /// Everything before this is thinned, Unix ms; of [`ThinnedTo::QueueCut`] 0.
    pub before_ms: i64,
    /// How much: blocks of history, hours, entries.
    pub count: u64,
    /// When, Unix ms.
    pub time_ms: i64,
    /// Which limit asked for it.
    pub why: String,
}

/// Kind of thinning, in the order in which a full store takes to them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ThinnedTo {
    /// Seconds became minima, means and maxima of minutes.
    Minutes,
    /// Minutes were dropped; hours are left.
    Hours,
    /// Hours were dropped.
    HoursDropped,
    /// Samples around alarms were dropped; that they were there stays known.
    RecordingsDropped,
    /// Seconds that an output had not taken left its queue; they are in the history.
    QueueCut,
    /// Events, links, gaps and closed alarms were dropped.
    EntriesDropped,
}

/// What is stored of a motor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Entry {
    /// A second.
    Second(Second),
    /// An event of the board.
    Event(BoardEvent),
    /// Something is missing.
    Gap(Gap),
    /// The link changed.
    Link(Link),
    /// An alarm changed.
    Alarm(AlarmChange),
    /// A recording was fetched.
    Recording(Recording),
    /// Another board watches this motor from now on: its numbers begin anew.
    Board {
        /// Serial number of the new board.
        serial: String,
        /// When it was noticed, Unix ms.
        time_ms: i64,
    },
    /// History was thinned (all motors).
    Thinned(Thinned),
}

impl Entry {
    /// When it happened, Unix ms.
    pub fn time_ms(&self) -> i64 {
        match self {
            Entry::Second(x) => x.time_ms,
            Entry::Event(x) => x.time_ms,
            Entry::Gap(x) => x.time_ms,
            Entry::Link(x) => x.time_ms,
            Entry::Alarm(x) => x.time_ms,
            Entry::Recording(x) => x.time_ms,
            Entry::Board { time_ms, .. } => *time_ms,
            Entry::Thinned(x) => x.time_ms,
        }
    }
}

/// An entry with its place in the store: ids rise in the order of storing, over all motors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Numbered {
    /// Place in the store, from 1. Some ids may never be used.
    pub id: u64,
    /// Its motor; `None`: the plant as a whole.
    pub motor: Option<MotorId>,
    /// What was stored.
    pub entry: Entry,
}
