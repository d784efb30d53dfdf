//! Channels that show a mean that they should not have.

use crate::context::Context;
use crate::finding::{Code, Finding};
use crate::measure::statistics::{median, median_with_error};
use recording::{Channel, Quantity};

/// Smallest offset worth a word, as a share of the rated amplitude (or of the measured one).
const NOTABLE: f64 = 0.005;
/// Standard errors beyond which an offset is one.
const SIGNIFICANT: f64 = 6.0;

pub(crate) fn check(context: &Context<'_>) -> Vec<Finding> {
    let sets = [Channel::VOLTAGES, Channel::CURRENTS];
    let each = sets
        .into_iter()
        .flat_map(|three| (0..3).filter_map(move |k| offset(context, three, k)));
    each.collect()
}

fn offset(context: &Context<'_>, three: [Channel; 3], k: usize) -> Option<Finding> {
    let channel = three[k];
    if context.unsound.contains(&channel) || context.recording.is_derived(channel) {
        return None;
    }
    let settled = context.settled(three);
    let means: Vec<f64> = settled
        .iter()
        .map(|(_, three)| three.fits[k].mean)
        .collect();
    let (mean, error) = median_with_error(&means)?;
    let amplitude = median(settled.iter().map(|(_, three)| three.amplitude()))?;
    let rated = match channel.quantity() {
        Quantity::Voltage => context.expectation.voltage_amplitude(),
        _ => context.expectation.current_amplitude(),
    };
    // A weak supply (a locked rotor test) makes an offset matter more, not less.
    let scale = rated.map_or(amplitude, |rated| rated.min(amplitude));
    let found = mean.abs() > NOTABLE * scale && mean.abs() > SIGNIFICANT * error;
    found.then(|| {
        let unit = channel.quantity().si();
        Finding::new(Code::Offset, channel, mean, unit).detail(format!(
            "{channel} has a mean of {mean:.4} {unit} in steady operation ({:.2} % of its amplitude). \
             Subtract it with --offset {channel}={mean:.4}, or zero the sensor.",
            100.0 * mean / amplitude
        ))
    })
}
