//! Corners at a common extreme: a probe that saturates droops instead of giving a flat top, steep on one side and almost
//! level on the other.
//!
//! Harmonics can look like this, but they do so all the time: corners count only where the signal stands out of its usual
//! size, as an inrush does.

use super::flat_top::{Cut, Tops};
use std::ops::Range;

/// Half periods that must show it: two may be chance.
const FEWEST_HALF_PERIODS: usize = 3;
/// Samples per period below which a peak has no shape.
const FEWEST_PER_PERIOD: f64 = 16.0;
/// Extremes this close to the greatest one count as common.
const COMMON: f64 = 0.9;
/// The greatest extreme over the usual one of the recording.
const STANDS_OUT: f64 = 2.0;
/// Over a sixteenth of a period a sinusoid that has reached 97 % of its peak has risen by 17 % of it; a probe clipped below
/// 86 % of the true peak by 31 % and more.
const STEEP: f64 = 0.30;
/// On the other side it falls by at most this share.
const LEVEL: f64 = 0.12;
/// How near to its own extreme the corner is looked for.
const NEAR: f64 = 0.96;
/// Half width of the noise, in standard deviations.
const SIGMAS: f64 = 7.0;
/// Share of the greatest extreme that tells the sign of a half period.
const HYSTERESIS: f64 = 0.2;

/// The half periods of one channel.
pub(super) struct Corners<'t> {
    tops: &'t Tops<'t>,
    level: f64,
    band: f64,
    /// Samples in a sixteenth of a period.
    stride: usize,
}

impl<'t> Corners<'t> {
    /// Looks at the same signal as `tops`.
    pub fn new(tops: &'t Tops<'t>) -> Corners<'t> {
        Corners {
            tops,
            level: extreme(tops.x),
            band: (SIGMAS * tops.sigma).max(1.5 * tops.step),
            stride: ((tops.period / 16.0).round() as usize).max(1),
        }
    }

    /// The level and the stretches in which it is met, if it is met often enough.
    pub fn cut(&self) -> Option<Cut> {
        if self.tops.period < FEWEST_PER_PERIOD {
            return None;
        }
        let halves = self.half_periods();
        let extremes = || {
            halves
                .iter()
                .map(|half| extreme(&self.tops.x[half.clone()]))
        };
        let mut sizes: Vec<f64> = extremes().collect();
        sizes.sort_unstable_by(f64::total_cmp);
        if self.level < STANDS_OUT * sizes[sizes.len() / 2] {
            return None;
        }
        let common = halves
            .iter()
            .zip(extremes())
            .filter(|(half, size)| *size >= COMMON * self.level && self.has_corner(half));
        let places: Vec<Range<usize>> = common.map(|(half, _)| half.clone()).collect();
        (places.len() >= FEWEST_HALF_PERIODS).then(|| Cut {
            level: self.level,
            places: self.joined(places),
        })
    }

    /// Stretches of one sign; at least one.
    fn half_periods(&self) -> Vec<Range<usize>> {
        let (mut halves, mut sign, mut from) = (Vec::new(), 0.0, 0);
        for (k, x) in self.tops.x.iter().enumerate() {
            if x.abs() > HYSTERESIS * self.level && x.signum() != sign {
                if sign != 0.0 {
                    halves.push(from..k);
                }
                (sign, from) = (x.signum(), k);
            }
        }
        halves.push(from..self.tops.x.len());
        halves
    }

    /// Steep on one side of a point near the extreme, almost level on the other.
    fn has_corner(&self, half: &Range<usize>) -> bool {
        let x = self.tops.x;
        let top = extreme(&x[half.clone()]);
        half.clone().filter(|k| x[*k].abs() >= NEAR * top).any(|k| {
            let (Some(before), Some(after)) =
                (k.checked_sub(self.stride), k.checked_add(self.stride))
            else {
                return false;
            };
            if after >= x.len() || self.holds_gap(before..after) {
                return false;
            }
            let drop = |at: usize| (x[k] - x[at]) * x[k].signum();
            let (back, forth) = (drop(before), drop(after));
            let steep = back.max(forth) > STEEP * self.level + self.band;
            let level = back.min(forth) < LEVEL * self.level - self.band;
            steep && level && back.min(forth) > -self.band
        })
    }

    /// Whether samples are missing between the first and the last of a range.
    fn holds_gap(&self, range: Range<usize>) -> bool {
        let t = self.tops.t;
        t[range.end] - t[range.start] > (range.len() as f64 + 0.5) * self.tops.t_sample
    }

    /// Between two half periods at most three periods apart the probe is not trusted either.
    fn joined(&self, places: Vec<Range<usize>>) -> Vec<Range<usize>> {
        let mut joined: Vec<Range<usize>> = Vec::new();
        for place in places {
            match joined.last_mut() {
                Some(last) if (place.start - last.end) as f64 <= 3.0 * self.tops.period => {
                    last.end = place.end;
                }
                _ => joined.push(place),
            }
        }
        joined
    }
}

fn extreme(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |extreme: f64, x| extreme.max(x.abs()))
}
