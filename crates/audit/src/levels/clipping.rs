//! What is said of a channel that ran into the end of its range.

use crate::context::Context;
use crate::finding::{Code, Finding};
use crate::levels::clipped::Clipped;
use recording::{Channel, Signal};

/// One finding per clipped channel.
pub(crate) fn check(context: &Context<'_>) -> Vec<Finding> {
    context
        .clipped
        .iter()
        .map(|clipped| finding(context, clipped))
        .collect()
}

fn finding(context: &Context<'_>, clipped: &Clipped) -> Finding {
    let t = context.recording.t();
    let channel = clipped.channel;
    let unit = channel.quantity().si();
    let from = clipped.places.first().map_or(0.0, |place| t[place.start]);
    let ends = clipped.places.iter().map(|place| place.end);
    let to = ends.max().map_or(0.0, |end| t[end - 1]);
    let how = if clipped.rails {
        format!(
            "{} samples lie at the declared full scale",
            clipped.places.len()
        )
    } else {
        "its tops are cut off at a common extreme".to_owned()
    };
    let detail = format!(
        "{channel} clips at {:.4} {unit} between {from:.3} s and {to:.3} s: {how}. {}",
        clipped.level,
        remedy(context, channel)
    );
    Finding::new(Code::Clipping, channel, clipped.level, unit)
        .detail(detail)
        .within(from, to)
}

fn remedy(context: &Context<'_>, channel: Channel) -> String {
    let second = Channel {
        second: true,
        ..channel
    };
    let spare = context.recording.channel(second).is_some()
        && !context
            .clipped
            .iter()
            .any(|clipped| clipped.channel == second);
    if !channel.second && spare {
        return format!(
            "The second probe {second} does not clip: compare, explain and adopt take it; for the lamps read it with --column {channel}={second}."
        );
    }
    let what = match channel.signal {
        Signal::Ia | Signal::Ib | Signal::Ic => "a current probe",
        Signal::Va | Signal::Vb | Signal::Vc => "a voltage divider",
        _ => "a sensor",
    };
    format!("This stretch is not judged; measure it with {what} of a larger range.")
}
