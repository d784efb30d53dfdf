//! A standstill at the first sample that the speed denies.

use crate::context::Context;
use crate::finding::{Code, Finding};
use recording::{Channel, Recording, StartsFrom};

/// Share of the rated synchronous speed from which on a speed is no offset of its channel.
const TURNS: f64 = 0.2;

/// Speed at the first sample, rad/s, of a recording that is said to begin at standstill while its motor turns; `synchronous` is the
/// speed of the rated frequency, rad/s. A speed of unknown scale says nothing.
pub fn turns_from_the_start(recording: &Recording, synchronous: f64) -> Option<f64> {
    let declared = recording.metadata.starts_from == StartsFrom::Standstill;
    let is_known = recording.unknown_speed_scale.is_none();
    let speed = recording.speed_at_first()?;
    (declared && is_known && speed.abs() > TURNS * synchronous).then_some(speed)
}

pub(crate) fn check(context: &Context<'_>) -> Option<Finding> {
    if context.unsound.contains(&Channel::SPEED) {
        return None;
    }
    let expected = context.expectation;
    let synchronous = expected.omega()? / f64::from(expected.pole_pairs?);
    let speed = turns_from_the_start(context.recording, synchronous)?;
    Some(Finding::new(Code::StartsFrom, Channel::SPEED, speed, "rad/s").detail(format!(
        "the sidecar says that the recording begins at standstill, and the motor turns at {speed:.1} rad/s there: taken as running. \
         Remove `starts_from = \"standstill\"`, or record from before the motor is switched on."
    )))
}
