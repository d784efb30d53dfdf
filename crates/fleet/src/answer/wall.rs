//! All motors, the worst first.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::words::{fault_name, lit_lamps};
use crate::alarm::change::Severity;
use crate::state::MotorState;

/// The worst that is known of a motor now. The order is that of the wall.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// A fault of the motor, open as an alarm.
    Fault,
    /// An instrument: the motor is not watched.
    Sensor,
    /// A lost link, a gap or a doubt, open as an alarm.
    Attention,
    /// Nothing was heard of late, or ever.
    NoData,
    /// It is heard, and not judged: it stands still, or something changes.
    NotJudged,
    /// Judged, and nothing is open.
    Healthy,
}

/// All motors of a plant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WallAnswer {
    /// When this was asked, Unix ms.
    pub time_unix_ms: i64,
    /// How many motors are in each condition.
    pub counts: Counts,
    /// The motors, the worst first, of the same condition those first that nobody has acknowledged, then by name.
    pub motors: Vec<WallMotor>,
}

/// Motors in each condition.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Counts {
    /// See [`Condition::Fault`].
    pub fault: u32,
    /// See [`Condition::Sensor`].
    pub sensor: u32,
    /// See [`Condition::Attention`].
    pub attention: u32,
    /// See [`Condition::NoData`].
    pub no_data: u32,
    /// See [`Condition::NotJudged`].
    pub not_judged: u32,
    /// See [`Condition::Healthy`].
    pub healthy: u32,
}

/// One motor on the wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WallMotor {
    /// Name within the plant.
    pub id: String,
    /// What people call it.
    pub title: String,
    /// Where it is.
    pub place: String,
    /// The worst that is known.
    pub condition: Condition,
    /// Nothing was heard of late: what stands here is old, and is drawn grey.
    pub stale: bool,
    /// Age of its newest second, ms; null: none yet.
    pub age_ms: Option<i64>,
    /// Whether the link is up; null: never told.
    pub link_up: Option<bool>,
    /// Alarms that somebody has to look at.
    pub open_alarms: u32,
    /// Those that nobody has acknowledged.
    pub unacknowledged_alarms: u32,
    /// Lamps that are on, by name.
    pub lamps: Vec<String>,
    /// The likely fault while FAULT is on, its short name.
    pub likely_fault: Option<String>,
}

impl WallAnswer {
    /// The wall at a moment. A motor of which nothing was heard for `stale_after_ms` is stale.
    pub fn new(states: &[MotorState], now_ms: i64, stale_after_ms: i64) -> Self {
        let mut motors: Vec<_> = states
            .iter()
            .map(|state| WallMotor::new(state, now_ms, stale_after_ms))
            .collect();
        motors.sort_by(|a, b| a.order().cmp(&b.order()));
        let mut counts = Counts::default();
        motors
            .iter()
            .for_each(|motor| *counts.of(motor.condition) += 1);
        Self {
            time_unix_ms: now_ms,
            counts,
            motors,
        }
    }
}

impl Counts {
    fn of(&mut self, condition: Condition) -> &mut u32 {
        match condition {
            Condition::Fault => &mut self.fault,
            Condition::Sensor => &mut self.sensor,
            Condition::Attention => &mut self.attention,
            Condition::NoData => &mut self.no_data,
            Condition::NotJudged => &mut self.not_judged,
            Condition::Healthy => &mut self.healthy,
        }
    }
}

impl WallMotor {
    /// A motor at a moment.
    pub fn new(state: &MotorState, now_ms: i64, stale_after_ms: i64) -> Self {
        let age_ms = state.last.as_ref().map(|second| now_ms - second.time_ms);
        let stale = age_ms.is_none_or(|age| age > stale_after_ms);
        let lamps = state
            .last
            .as_ref()
            .map(|second| lit_lamps(second.lamps))
            .unwrap_or_default();
        let fault_on = lamps.iter().any(|lamp| lamp == "FAULT");
        let fault = state.last.as_ref().filter(|_| fault_on);
        Self {
            id: state.info.id.to_string(),
            title: state.info.title.clone(),
            place: state.info.place.clone(),
            condition: condition(state, stale),
            stale,
            age_ms,
            link_up: state.link.as_ref().map(|link| link.up),
            open_alarms: state.open_alarms,
            unacknowledged_alarms: state.unacknowledged,
            likely_fault: fault.and_then(|second| fault_name(second.fault)),
            lamps,
        }
    }

    fn order(&self) -> (Condition, bool, &str) {
        (self.condition, self.unacknowledged_alarms == 0, &self.id)
    }
}

/// Open alarms come first: a fault stays a fault when the link goes. What a person shelved or the plant suppressed is not open.
fn condition(state: &MotorState, stale: bool) -> Condition {
    let judged = state.last.as_ref().is_some_and(|second| second.judged > 0);
    match state.worst {
        Some(Severity::High) => Condition::Fault,
        Some(Severity::Medium) => Condition::Sensor,
        Some(Severity::Low) => Condition::Attention,
        None if stale => Condition::NoData,
        None if !judged => Condition::NotJudged,
        None => Condition::Healthy,
    }
}
