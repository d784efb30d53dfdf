//! What a person does to an alarm, and why that may be refused.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::change::{Alarm, AlarmChange, Change, Who};

/// What a person does to an alarm.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Action {
    /// Takes note.
    Acknowledge,
    /// Sets it aside until a time.
    Shelve {
        /// End, Unix ms.
        until_ms: i64,
    },
    /// Ends the shelf.
    Unshelve,
    /// Sets it aside while the motor is out of service.
    Suppress,
    /// Ends that.
    Unsuppress,
}

/// Why an action is refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ActionError {
    /// There never was such an alarm.
    #[error("there is no alarm {0}")]
    Unknown(u64),
    /// It is over.
    #[error("alarm {0} is back to normal: there is nothing to set aside")]
    Over(u64),
    /// Who sets an alarm aside says why.
    #[error("give a reason: who finds the alarm set aside must know why")]
    NoReason,
    /// The end is past or too far away.
    #[error("a shelf ends between now and {longest_h} hours from now")]
    Shelf {
        /// Longest shelf, hours.
        longest_h: i64,
    },
}

/// Does what a person asks; `None` where it is so already.
pub(super) fn apply(
    alarm: &mut Alarm,
    action: &Action,
    who: Who,
    why: &str,
    now_ms: i64,
) -> Option<AlarmChange> {
    type Work = fn(&mut Alarm, Option<i64>);
    let (change, until, work): (Change, Option<i64>, Work) = match action {
        Action::Acknowledge if !alarm.acknowledged => (Change::Acknowledged, None, |alarm, _| {
            alarm.acknowledged = true
        }),
        Action::Shelve { until_ms } if alarm.shelved_until_ms != Some(*until_ms) => {
            (Change::Shelved, Some(*until_ms), |alarm, until| {
                alarm.shelved_until_ms = until
            })
        }
        Action::Unshelve if alarm.shelved_until_ms.is_some() => {
            (Change::Unshelved, None, |alarm, until| {
                alarm.shelved_until_ms = until
            })
        }
        Action::Suppress if !alarm.suppressed => {
            (Change::Suppressed, None, |alarm, _| alarm.suppressed = true)
        }
        Action::Unsuppress if alarm.suppressed => (Change::Unsuppressed, None, |alarm, _| {
            alarm.suppressed = false
        }),
        _ => return None,
    };
    Some(alarm.step(change, who, why, now_ms, |alarm| work(alarm, until)))
}
