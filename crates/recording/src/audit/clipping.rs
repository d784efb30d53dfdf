//! Channels that ran into the end of their range.
//!
//! Three signs: codes at the rails of a declared full scale; tops that are flatter than a peak of the
//! same width can be; and corners at a common extreme, where a probe saturates (steep on one side,
//! almost level on the other), which does not give flat tops.

use super::context::Context;
use super::finding::{Code, Finding};
use super::statistics::noise;
use crate::channel::{Channel, Quantity, Signal};
use crate::metadata::Supply;
use crate::recording::Recording;
use std::f64::consts::TAU;
use std::ops::Range;

/// Where a channel was clipped.
#[derive(Clone, Debug)]
pub(super) struct Clipped {
    pub channel: Channel,
    /// Level at which it stops, in the channel's unit.
    pub level: f64,
    /// Half periods, or single samples at a rail.
    pub places: Vec<Range<usize>>,
    rails: bool,
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
/// Half periods that must show the same sign: two may be chance.
const FEWEST_HALF_PERIODS: usize = 3;
/// Samples per period below which a peak has no shape.
const FEWEST_PER_PERIOD: f64 = 16.0;
/// Extremes this close to the greatest one count as common.
const COMMON: f64 = 0.9;
/// Noise band of a flat top, in standard deviations.
const FLAT_SIGMAS: f64 = 7.0;
/// A parabola that stays within d of its top falls by 4 d over twice the width; noise adds to that.
const FLAT_DROP: f64 = 10.0;
/// Fewest samples of a flat top.
const FLAT_SAMPLES: usize = 4;
/// Corner: over a sixteenth of a period a sinusoid that has reached 97 % of its peak has risen by
/// 17 % of it; a probe clipped below 86 % of the true peak by 31 % and more.
const STEEP: f64 = 0.30;
/// Corner: on the other side it falls by at most this share.
const LEVEL: f64 = 0.12;
/// How near to its own extreme the corner is looked for.
const NEAR: f64 = 0.96;

/// Every clipped channel.
pub(super) fn clipped(recording: &Recording, omega: Option<f64>) -> Vec<Clipped> {
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
    if !channel.is_electrical() || pulsed || recording.is_derived(channel) {
        return None;
    }
    let level = x.iter().fold(0.0, |level: f64, x| level.max(x.abs()));
    let shape = Shape::new(recording, channel, x, omega);
    if shape.period < FEWEST_PER_PERIOD {
        return None;
    }
    let halves = half_periods(x, level);
    let common = halves
        .into_iter()
        .filter(|half| extreme(&x[half.clone()]) >= COMMON * level);
    let places: Vec<Range<usize>> = common.filter(|half| shape.is_cut(x, half, level)).collect();
    (places.len() >= FEWEST_HALF_PERIODS).then(|| Clipped {
        channel,
        level,
        places: joined(places, shape.period),
        rails: false,
    })
}

fn extreme(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |extreme: f64, x| extreme.max(x.abs()))
}

/// Stretches of one sign, told with a hysteresis of a fifth of the level.
fn half_periods(x: &[f64], level: f64) -> Vec<Range<usize>> {
    let (mut halves, mut sign, mut from) = (Vec::new(), 0.0, 0);
    for (k, x) in x.iter().enumerate() {
        if x.abs() > 0.2 * level && x.signum() != sign {
            if sign != 0.0 {
                halves.push(from..k);
            }
            (sign, from) = (x.signum(), k);
        }
    }
    halves.push(from..x.len());
    halves
}

/// Between two clipped half periods at most three periods apart the probe is not trusted either.
fn joined(places: Vec<Range<usize>>, period: f64) -> Vec<Range<usize>> {
    let mut joined: Vec<Range<usize>> = Vec::new();
    for place in places {
        match joined.last_mut() {
            Some(last) if (place.start - last.end) as f64 <= 3.0 * period => last.end = place.end,
            _ => joined.push(place),
        }
    }
    joined
}

/// What a peak of an unclipped channel looks like.
struct Shape {
    /// Samples per period.
    period: f64,
    /// Width of the noise band, in the channel's unit.
    band: f64,
}

impl Shape {
    fn new(recording: &Recording, channel: Channel, x: &[f64], omega: f64) -> Shape {
        let sensors = &recording.metadata.sensors;
        let sigma = sensors.sigma(channel).unwrap_or_else(|| noise(x));
        let step = sensors.step(channel).unwrap_or_else(|| smallest_step(x));
        Shape {
            period: TAU / (omega * recording.t_sample()),
            band: (FLAT_SIGMAS * sigma).max(1.5 * step),
        }
    }

    fn is_cut(&self, x: &[f64], half: &Range<usize>, level: f64) -> bool {
        self.is_flat(x, half) || self.has_corner(x, half, level)
    }

    /// A top that stays in the noise band for longer than the peak's own roundness allows.
    fn is_flat(&self, x: &[f64], half: &Range<usize>) -> bool {
        let top = extreme(&x[half.clone()]);
        let inside = |k: &usize| x[*k].abs() >= top - self.band;
        let Some(first) = half.clone().find(inside) else {
            return false;
        };
        let end = (first..half.end).find(|k| !inside(k)).unwrap_or(half.end);
        let n = end - first;
        let (Some(before), Some(after)) =
            (first.checked_sub(n.div_ceil(2)), x.get(end + n.div_ceil(2)))
        else {
            return false;
        };
        let drop = |y: f64| top - y * x[first].signum();
        n >= FLAT_SAMPLES && drop(x[before]).min(drop(*after)) > FLAT_DROP * self.band
    }

    /// Steep on one side of a point near the extreme, almost level on the other.
    fn has_corner(&self, x: &[f64], half: &Range<usize>, level: f64) -> bool {
        let stride = ((self.period / 16.0).round() as usize).max(1);
        let top = extreme(&x[half.clone()]);
        half.clone().filter(|k| x[*k].abs() >= NEAR * top).any(|k| {
            let (Some(before), Some(after)) = (k.checked_sub(stride), x.get(k + stride)) else {
                return false;
            };
            let drop = |y: f64| (x[k] - y) * x[k].signum();
            let (back, forth) = (drop(x[before]), drop(*after));
            let steep = back.max(forth) > STEEP * level + self.band;
            steep && back.min(forth) < LEVEL * level - self.band && back.min(forth) > -self.band
        })
    }
}

/// The smallest change between two samples that is not zero: the step of an undeclared converter.
fn smallest_step(x: &[f64]) -> f64 {
    let changes = x.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let smallest = changes
        .filter(|change| *change > 0.0)
        .fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest } else { 0.0 }
}

/// One finding per clipped channel.
pub(super) fn check(context: &Context<'_>) -> Vec<Finding> {
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
    let to = clipped
        .places
        .last()
        .map_or(0.0, |place| t[(place.end - 1).min(t.len() - 1)]);
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
