//! Channels that ran into the end of their range.
//!
//! Three signs: codes at the rails of a declared full scale; [flat tops](flat_top) at one level, of either polarity; and in
//! a stretch that stands out, as an inrush does, [corners](corner) at a common extreme, where a probe saturates.

mod corner;
mod flat_top;

use crate::measure::refresh;
use crate::measure::statistics::noise;
use corner::Corners;
use flat_top::{Cut, Tops};
use recording::{Channel, Quantity, Recording, Supply};
use std::f64::consts::TAU;
use std::ops::Range;

/// Where a channel was clipped.
#[derive(Clone, Debug)]
pub(crate) struct Clipped {
    pub channel: Channel,
    /// Level at which it stops, in the channel's unit.
    pub level: f64,
    /// Half periods, or single samples at a rail.
    pub places: Vec<Range<usize>>,
    pub rails: bool,
}

impl Clipped {
    /// Whether a stretch of samples has clipped ones in it, or lies between two that are a few
    /// periods apart (a saturated probe recovers slowly).
    pub fn touches(&self, range: &Range<usize>) -> bool {
        self.places
            .iter()
            .any(|place| place.start < range.end && range.start < place.end)
    }
}

/// Samples at a rail below which noise alone may have touched it.
const FEWEST_AT_RAIL: usize = 3;

/// Every clipped channel.
pub(crate) fn clipped(recording: &Recording, omega: Option<f64>) -> Vec<Clipped> {
    let found = recording.channels().filter_map(|(channel, x)| {
        at_rails(recording, channel, x).or_else(|| at_tops(recording, channel, x, omega?))
    });
    found.collect()
}

fn at_rails(recording: &Recording, channel: Channel, x: &[f64]) -> Option<Clipped> {
    let sensors = &recording.metadata.sensors;
    let full_scale = sensors.full_scale(channel)?;
    let step = sensors.step(channel).unwrap_or(1e-6 * full_scale);
    // Beyond the rail nothing is clipped: the declared full scale is not this channel's.
    if extreme(x) > full_scale + 1.5 * step {
        return None;
    }
    let limit = full_scale - 1.5 * step;
    let hits = x.iter().enumerate().filter(|(_, x)| x.abs() >= limit);
    let places: Vec<Range<usize>> = hits.map(|(k, _)| k..k + 1).collect();
    (places.len() >= FEWEST_AT_RAIL).then_some(Clipped {
        channel,
        level: full_scale,
        places,
        rails: true,
    })
}

fn at_tops(recording: &Recording, channel: Channel, x: &[f64], omega: f64) -> Option<Clipped> {
    // The voltage of an inverter has flat tops by nature.
    let pulsed =
        recording.metadata.supply == Supply::Inverter && channel.quantity() == Quantity::Voltage;
    let shapeless = pulsed || recording.is_derived(channel) || refresh::rows(x).is_some();
    if !channel.is_electrical() || shapeless {
        return None;
    }
    let sensors = &recording.metadata.sensors;
    let declared = sensors.sigma(channel).unwrap_or(f64::INFINITY);
    let tops = Tops {
        t: recording.t(),
        x,
        t_sample: recording.t_sample(),
        period: TAU / (omega * recording.t_sample()),
        step: sensors.step(channel).unwrap_or_else(|| smallest_step(x)),
        // Harmonics at few samples per period look like noise, and a declared noise may not be there.
        sigma: declared.min(noise(x)),
    };
    let corners = || Corners::new(&tops).cut();
    let cuts = tops.cuts();
    let cuts = if cuts.is_empty() {
        corners().into_iter().collect()
    } else {
        cuts
    };
    clipped_by(channel, cuts)
}

/// Both polarities as one finding: the lower level is the one from which on nothing is trusted.
fn clipped_by(channel: Channel, cuts: Vec<Cut>) -> Option<Clipped> {
    let level = cuts.iter().map(|cut| cut.level).min_by(f64::total_cmp)?;
    let mut places: Vec<Range<usize>> = cuts.into_iter().flat_map(|cut| cut.places).collect();
    places.sort_unstable_by_key(|place| place.start);
    Some(Clipped {
        channel,
        level,
        places,
        rails: false,
    })
}

fn extreme(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |extreme: f64, x| extreme.max(x.abs()))
}

/// The smallest change between two samples that is not zero: the step of an undeclared converter.
fn smallest_step(x: &[f64]) -> f64 {
    let changes = x.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let smallest = changes
        .filter(|change| *change > 0.0)
        .fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest } else { 0.0 }
}
