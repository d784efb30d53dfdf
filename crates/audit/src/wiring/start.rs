//! A standstill at the first sample that the speed denies.

use crate::context::Context;
use crate::finding::{Code, Finding};
use recording::{Channel, Recording, StartsFrom};

/// A motor that is switched on with the first sample still stands for so long.
const STILL_S: f64 = 0.002;
/// Share of the rated synchronous speed from which on a speed is no offset of its channel.
const TURNS: f64 = 0.2;

/// Speed at the first sample, rad/s, of a recording that is said to begin at standstill while its motor turns; `synchronous` is the
/// speed of the rated frequency, rad/s. A speed of unknown scale says nothing.
pub fn turns_from_the_start(recording: &Recording, synchronous: f64) -> Option<f64> {
    let declared = recording.metadata.starts_from == StartsFrom::Standstill;
    let speed = recording
        .speed()
        .filter(|_| declared && recording.unknown_speed_scale.is_none())?;
    let first = ((STILL_S / recording.t_sample()) as usize).clamp(1, speed.len());
    let mean = speed[..first].iter().sum::<f64>() / first as f64;
    (mean.abs() > TURNS * synchronous).then_some(mean)
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
