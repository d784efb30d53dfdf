//! Floods: when many alarms rise at once, the first ones stand for themselves and one alarm collects the others.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::change::Severity;
use super::rules::Rules;

/// New alarms of late.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Flood {
    /// When alarms rose that were not there before, within the window.
    recent: Vec<(Severity, i64)>,
    /// Numbers of those that are collected.
    pub collected: BTreeSet<u64>,
}

impl Flood {
    /// Takes a new alarm; whether it is one too many of its severity, so that lost links never hide a fault.
    pub fn new_alarm(&mut self, severity: Severity, time_ms: i64, rules: &Rules) -> bool {
        self.forget(time_ms, rules);
        let before = self.count(severity);
        self.recent.push((severity, time_ms));
        before >= rules.flood_alarms
    }

    /// Whether it is over: of each severity half the limit or less is left within the window.
    pub fn is_over(&mut self, now_ms: i64, rules: &Rules) -> bool {
        self.forget(now_ms, rules);
        let all = [Severity::Low, Severity::Medium, Severity::High];
        all.into_iter()
            .all(|severity| 2 * self.count(severity) <= rules.flood_alarms)
    }

    fn count(&self, severity: Severity) -> usize {
        self.recent.iter().filter(|(s, _)| *s == severity).count()
    }

    fn forget(&mut self, now_ms: i64, rules: &Rules) {
        self.recent
            .retain(|(_, time_ms)| now_ms - time_ms < rules.flood_window_ms);
    }
}
