//! Channels that are absent, and what cannot be judged without them.

use crate::context::Context;
use crate::finding::{Code, Finding, names};
use recording::{Channel, LoadTorque};

pub(crate) fn check(context: &Context<'_>) -> Vec<Finding> {
    let torque_needed = context.recording.metadata.load_torque == LoadTorque::Measured;
    let sets: [(&[Channel], &str, bool); 4] = [
        (
            &Channel::VOLTAGES,
            "residuals, supply and power are not judged",
            true,
        ),
        (
            &Channel::CURRENTS,
            "the motor is not judged, only the supply",
            true,
        ),
        (
            &[Channel::SPEED],
            "slip, residuals and rotor are not judged",
            true,
        ),
        (
            &[Channel::TORQUE],
            "the load that the sidecar calls measured is unknown",
            torque_needed,
        ),
    ];
    let missing = sets.into_iter().filter(|(_, _, needed)| *needed).filter_map(|(three, loss, _)| {
        let recorded = |channel: &&Channel| context.recording.channel(**channel).is_none();
        let absent: Vec<Channel> = three.iter().filter(recorded).copied().collect();
        let first = absent.first()?;
        let detail = format!(
            "{} not recorded: {loss}. If another column holds it, map it with --column {first}=NAME.",
            names(&absent)
        );
        Some(Finding::new(Code::ChannelMissing, names(&absent), absent.len() as f64, "channels").detail(detail))
    });
    missing.collect()
}
