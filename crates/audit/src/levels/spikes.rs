//! Samples that were far off their neighbours and were bridged when the file was read.

use crate::context::Context;
use crate::finding::{Code, Finding, count};

pub(crate) fn check(context: &Context<'_>) -> Vec<Finding> {
    let recording = context.recording;
    let found = recording.bridged().map(|(channel, bridged)| {
        let (samples, unit) = (bridged.samples, channel.quantity().si());
        let percent = 100.0 * samples as f64 / recording.len() as f64;
        Finding::new(Code::Spikes, channel, samples as f64, "samples").detail(format!(
            "{channel} has {} ({percent:.2} %) far off their neighbours, the farthest {:.4e} {unit} at {:.4} s. \
             They were bridged by straight lines. Look for interference: shield, cable, encoder supply.",
            count(samples, "sample"), bridged.farthest, bridged.at_s
        ))
    });
    found.collect()
}
