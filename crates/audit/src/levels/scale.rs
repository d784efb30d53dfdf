//! Channels whose scale the user does not know.

use crate::context::Context;
use crate::finding::{Code, Finding};
use recording::Channel;

/// Says what the unknown scale of the speed means, and keeps the speed out of everything that needs it.
pub(crate) fn check(context: &mut Context<'_>) -> Option<Finding> {
    context.recording.unknown_speed_scale.as_ref()?;
    context.recording.speed()?;
    context.unsound.insert(Channel::SPEED);
    let detail = "The scale of speed was declared unknown: compare, explain and adopt fit it and say what can then not \
                  be concluded; monitor does not use the channel.";
    Some(Finding::new(Code::ScaleUnknown, Channel::SPEED, 1.0, "channel").detail(detail))
}
