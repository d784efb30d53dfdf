//! One motor.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::alarms::AlarmAnswer;
use super::wall::WallMotor;
use super::words::{finite, lit_lamps};
use crate::alarm::change::Alarm;
use crate::entry::{Entry, Gap, GapOf, Numbered, Second};
use crate::state::MotorState;

/// One motor, all that is known of it now.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MotorAnswer {
    /// As on the wall.
    pub wall: WallMotor,
    /// The nameplate in words.
    pub nameplate: String,
    /// How it is reached.
    pub link: String,
    /// Since when the link is as it is, Unix ms; null: never told.
    pub link_since_unix_ms: Option<i64>,
    /// Why the link is down; empty where it is up.
    pub link_why: String,
    /// Path of its motor file.
    pub motor_file: Option<String>,
    /// Its newest second.
    pub last: Option<SecondAnswer>,
    /// Number of its newest event; 0: none yet.
    pub last_event: u32,
    /// Its alarms, those first that somebody has to look at.
    pub alarms: Vec<AlarmAnswer>,
}

impl MotorAnswer {
    /// A motor at a moment, with its alarms.
    pub fn new(state: &MotorState, alarms: &[Alarm], now_ms: i64, stale_after_ms: i64) -> Self {
        let link = state.link.as_ref();
        Self {
            wall: WallMotor::new(state, now_ms, stale_after_ms),
            nameplate: state.info.nameplate.clone(),
            link: state.info.link.clone(),
            link_since_unix_ms: link.map(|link| link.time_ms),
            link_why: link.map(|link| link.why.clone()).unwrap_or_default(),
            motor_file: state.info.motor_file.clone(),
            last: state.last.as_ref().map(SecondAnswer::new),
            last_event: state.last_event,
            alarms: alarms.iter().map(AlarmAnswer::new).collect(),
        }
    }
}

/// One second of a motor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SecondAnswer {
    /// When, Unix ms.
    pub time_unix_ms: i64,
    /// Run of the board's program: number of its first event.
    pub start: u32,
    /// Second since the start.
    pub number: u32,
    /// Lamps that were on, by name.
    pub lamps: Vec<String>,
    /// Windows that ended in it.
    pub windows: u8,
    /// Those that were judged.
    pub judged: u8,
    /// Reason of the last window that was not judged, its number (docs/modbus.md); 0: all were.
    pub not_judged: u8,
    /// r1 to r4, percent of their scales.
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

impl SecondAnswer {
    /// A stored second.
    pub fn new(second: &Second) -> Self {
        let percent = |residuals: [f32; 4]| residuals.map(|r| finite(100.0 * r));
        Self {
            time_unix_ms: second.time_ms,
            start: second.start,
            number: second.number,
            lamps: lit_lamps(second.lamps),
            windows: second.windows,
            judged: second.judged,
            not_judged: second.not_judged,
            residuals_percent: second.residuals.map(percent).unwrap_or_default(),
            voltage_v: second.voltage_v.and_then(finite),
            current_a: second.current_a.and_then(finite),
            frequency_hz: second.frequency_hz.and_then(finite),
            speed_rpm: second.speed_rpm.and_then(finite),
        }
    }
}

/// One thing that happened to a motor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TimelineAnswer {
    /// Its place in the store.
    pub id: u64,
    /// When, Unix ms.
    pub time_unix_ms: i64,
    /// `event`, `gap`, `link`, `alarm`, `recording`, `board` or `thinned`.
    pub kind: String,
    /// Number of the event or of the alarm.
    pub number: Option<u64>,
    /// Cause of an event, its number (docs/firmware.md).
    pub event_cause: Option<u16>,
    /// The two values of an event.
    pub event_values: Option<[u32; 2]>,
    /// File of a recording.
    pub recording: Option<String>,
    /// In words.
    pub words: String,
}

impl TimelineAnswer {
    /// A stored entry.
    pub fn new(stored: &Numbered) -> Self {
        let (kind, words) = words_of(&stored.entry);
        let mut answer = Self {
            id: stored.id,
            time_unix_ms: stored.entry.time_ms(),
            kind: kind.to_owned(),
            number: None,
            event_cause: None,
            event_values: None,
            recording: None,
            words,
        };
        match &stored.entry {
            Entry::Event(event) => {
                answer.number = Some(event.number.into());
                answer.event_cause = Some(event.cause);
                answer.event_values = Some(event.values);
            }
            Entry::Alarm(change) => answer.number = Some(change.alarm.number),
            Entry::Recording(recording) => answer.recording = Some(recording.file.clone()),
            _ => {}
        }
        answer
    }
}

fn words_of(entry: &Entry) -> (&'static str, String) {
    match entry {
        Entry::Second(second) => ("second", format!("second {}", second.number)),
        Entry::Event(event) => ("event", format!("event of cause {}", event.cause)),
        Entry::Gap(gap) => ("gap", words_of_gap(gap)),
        Entry::Link(link) if link.up => ("link", "the link is up".to_owned()),
        Entry::Link(link) => ("link", format!("the link is down: {}", link.why)),
        Entry::Alarm(change) => ("alarm", change.why.clone()),
        Entry::Recording(recording) => ("recording", format!("recording {}", recording.file)),
        Entry::Board { serial, .. } => ("board", format!("board {serial}")),
        Entry::Thinned(thinned) => (
            "thinned",
            format!(
                "history was thinned, {} blocks: {}",
                thinned.count, thinned.why
            ),
        ),
    }
}

fn words_of_gap(gap: &Gap) -> String {
    let what = match gap.what {
        GapOf::Seconds { .. } => "seconds",
        GapOf::Events => "events",
        GapOf::Frames => "frames",
    };
    format!("{what} {} to {} are missing", gap.first, gap.last)
}
