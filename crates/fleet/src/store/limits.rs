//! How long history is kept, and how much of it.

use serde::{Deserialize, Serialize};

use super::StoreError;

/// How long and how much is kept. What is older is thinned; a full store thins the oldest first, whatever its age.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Size of the database, bytes; from 16 MB on.
    pub bytes: u64,
    /// Days of seconds.
    pub seconds_days: u32,
    /// Days of minutes, from `seconds_days` on.
    pub minutes_days: u32,
    /// Days of hours, from `minutes_days` on.
    pub hours_days: u32,
    /// Days of the samples around alarms, 9 kB each.
    pub recordings_days: u32,
    /// Seconds of all motors that wait for an output, at most. What is cut stays in the history.
    pub queue_seconds: u64,
}

impl Default for Limits {
    /// 20 GB; 14 days of seconds, 400 days of minutes, ten years of hours; 400 days of recordings; a queue of a day of 1000 motors.
    fn default() -> Self {
        Self {
            bytes: 20_000_000_000,
            seconds_days: 14,
            minutes_days: 400,
            hours_days: 3653,
            recordings_days: 400,
            queue_seconds: 86_400_000,
        }
    }
}

impl Limits {
    /// Checks ranges.
    ///
    /// # Errors
    /// Names the first limit that is out of its range.
    pub fn check(&self) -> Result<(), StoreError> {
        let refuse = |key, value, range| Err(StoreError::Limit { key, value, range });
        if self.bytes < 16_000_000 {
            return refuse(
                "bytes",
                self.bytes,
                "16 000 000 is the least that holds a plant",
            );
        }
        if self.seconds_days == 0 {
            return refuse("seconds_days", 0, "one day at least");
        }
        if self.minutes_days < self.seconds_days {
            let value = u64::from(self.minutes_days);
            return refuse("minutes_days", value, "at least seconds_days");
        }
        if self.hours_days < self.minutes_days {
            let value = u64::from(self.hours_days);
            return refuse("hours_days", value, "at least minutes_days");
        }
        if self.recordings_days == 0 {
            return refuse("recordings_days", 0, "one day at least");
        }
        if self.queue_seconds < 10_000 {
            return refuse("queue_seconds", self.queue_seconds, "10 000 at least");
        }
        Ok(())
    }
}
