//! No periodic supply anywhere.

use crate::context::Context;
use crate::finding::{Code, Finding, names};
use crate::measure::blocks::tracked;
use recording::Channel;
use std::f64::consts::TAU;

/// Three periods of a 50 Hz supply, s.
const SHORTEST_S: f64 = 0.06;

pub(crate) fn check(context: &Context<'_>) -> Vec<Finding> {
    // One or two clamps turn no angle: what is missing is told, not that there is no supply.
    let three = context
        .recording
        .voltages()
        .or_else(|| context.recording.currents());
    if !context.blocks.is_empty() || three.is_none() {
        return Vec::new();
    }
    let three: Vec<Channel> = context
        .recording
        .channels()
        .map(|(channel, _)| channel)
        .filter(|c| c.is_electrical())
        .collect();
    let any = other_time_unit(context);
    let hint = match any {
        Some(hz) => format!("A period is found if the clock counts otherwise ({hz:.4} Hz as recorded): check --unit t=ms."),
        None if context.recording.duration() < SHORTEST_S => format!(
            "{:.3} s are too short for it: record several seconds.",
            context.recording.duration()
        ),
        None => "Check that the motor was supplied, that the columns are the right ones, and the sampling rate.".to_owned(),
    };
    let code = if any.is_some() {
        Code::Unit
    } else {
        Code::NotLocked
    };
    let channel = if any.is_some() {
        "t".to_owned()
    } else {
        names(&three)
    };
    let finding = Finding::new(code, channel, any.unwrap_or(0.0), "Hz");
    vec![
        finding
            .detail(format!(
                "No periodic supply between 1.5 and 1000 Hz was found. {hint}"
            ))
            .refusing(),
    ]
}

/// The frequency of a supply that is there, but not at any frequency of a motor.
pub(crate) fn other_time_unit(context: &Context<'_>) -> Option<f64> {
    let three = context
        .recording
        .voltages()
        .or_else(|| context.recording.currents())?;
    tracked(context.recording, &three)
        .any_frequency()
        .map(|omega| omega / TAU)
}
