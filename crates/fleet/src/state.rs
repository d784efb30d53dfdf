//! The present state of a motor.

use serde::{Deserialize, Serialize};

use crate::alarm::change::Severity;
use crate::entry::{Link, Second};
use crate::motor::MotorInfo;

/// What is known of a motor now.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotorState {
    /// What the configuration says.
    pub info: MotorInfo,
    /// Its newest second; none yet: `None`.
    pub last: Option<Second>,
    /// Number of its newest event; 0: none yet.
    pub last_event: u32,
    /// Its link as last told; never told: `None`.
    pub link: Option<Link>,
    /// Alarms that somebody has to look at: neither back to normal, nor shelved, nor suppressed.
    pub open_alarms: u32,
    /// Those of them that nobody has acknowledged.
    pub unacknowledged: u32,
    /// The worst of them.
    pub worst: Option<Severity>,
}
