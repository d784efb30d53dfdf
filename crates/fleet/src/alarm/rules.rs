//! Delays, latch and flood limit: what a plant may set of its alarms.

use serde::{Deserialize, Serialize};

use super::change::AlarmCause;

/// What a plant may set of its alarms.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rules {
    /// How long FAULT, SENSOR or a doubt lasts before its alarm is raised, ms. The board's own persistence comes before.
    pub on_delay_ms: i64,
    /// How long it must be gone before its alarm returns, ms.
    pub off_delay_ms: i64,
    /// How long a link is down before its alarm is raised, ms.
    pub link_delay_ms: i64,
    /// Whether an alarm that returned waits until somebody acknowledges it.
    pub latch: bool,
    /// So many new alarms of one severity within `flood_window_ms` stand for themselves; the others are collected in one.
    pub flood_alarms: usize,
    /// See `flood_alarms`, ms. ISA-18.2 calls more than ten in ten minutes a flood.
    pub flood_window_ms: i64,
    /// Longest shelf, ms.
    pub longest_shelf_ms: i64,
    /// An alarm whose cause or size changes is told again after this time at the earliest, ms.
    pub update_ms: i64,
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            on_delay_ms: 0,
            off_delay_ms: 60_000,
            link_delay_ms: 10_000,
            latch: true,
            flood_alarms: 10,
            flood_window_ms: 600_000,
            longest_shelf_ms: 7 * 86_400_000,
            update_ms: 60_000,
        }
    }
}

impl Rules {
    /// How long a condition must hold before it counts, ms.
    pub(super) fn delay_ms(&self, cause: AlarmCause, on: bool) -> i64 {
        match (cause, on) {
            (AlarmCause::LinkLost, true) => self.link_delay_ms,
            // A gap is over at once; a flood keeps its own time; a link that is back is back.
            (AlarmCause::Gap | AlarmCause::Flood, _) | (AlarmCause::LinkLost, false) => 0,
            (_, true) => self.on_delay_ms,
            (_, false) => self.off_delay_ms,
        }
    }
}
