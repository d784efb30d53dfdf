//! Least, mean and largest, taken together from seconds or from what was thinned before.

use super::point::{TrendPoint, Values};
use crate::entry::Second;

/// Quantities of a second: r1 to r4, voltage, current, frequency, speed.
pub(super) const QUANTITIES: usize = 8;

/// One quantity over some time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Spread {
    /// Seconds in which it was known.
    pub count: u32,
    /// Least.
    pub min: f32,
    /// Sum. Double: a year of seconds has seven digits of its own.
    pub sum: f64,
    /// Largest.
    pub max: f32,
}

impl Spread {
    /// Takes a value; NaN is none.
    pub fn value(&mut self, value: f32) {
        if !value.is_nan() {
            self.merge(&Self {
                count: 1,
                min: value,
                sum: value.into(),
                max: value,
            });
        }
    }

    /// Takes another time's.
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        if self.count == 0 {
            *self = *other;
            return;
        }
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
        self.sum += other.sum;
        self.count = self.count.saturating_add(other.count);
    }

    fn values(&self) -> Option<Values> {
        let mean = (self.sum / f64::from(self.count)) as f32;
        (self.count > 0).then_some(Values {
            min: self.min,
            mean,
            max: self.max,
        })
    }
}

/// What some time holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Tally {
    /// Seconds.
    pub seconds: u32,
    /// Windows.
    pub windows: u32,
    /// Windows that were judged.
    pub judged: u32,
    /// Of each lamp the most severe state.
    pub lamps: u32,
    /// Each quantity.
    pub quantities: [Spread; QUANTITIES],
}

/// The quantities of a second; not known: NaN.
pub(super) fn quantities(second: &Second) -> [f32; QUANTITIES] {
    let [r1, r2, r3, r4] = second.residuals.unwrap_or([f32::NAN; 4]);
    let known = |x: Option<f32>| x.unwrap_or(f32::NAN);
    let Second {
        voltage_v,
        current_a,
        frequency_hz,
        speed_rpm,
        ..
    } = second;
    [
        r1,
        r2,
        r3,
        r4,
        known(*voltage_v),
        known(*current_a),
        known(*frequency_hz),
        known(*speed_rpm),
    ]
}

/// How severe a lamp's state is: a lamp that is on says more than one that blinks.
fn rank(state: u32) -> u32 {
    match state {
        1 => 3,
        2 => 2,
        other => u32::from(other != 0),
    }
}

/// Of each lamp the more severe state of two.
pub(super) fn worse_lamps(one: u32, other: u32) -> u32 {
    // Most seconds show the same lamps as those before.
    if one == other {
        return one;
    }
    (0..16).map(|k| 2 * k).fold(0, |all, shift| {
        let (a, b) = ((one >> shift) & 3, (other >> shift) & 3);
        all | (if rank(a) >= rank(b) { a } else { b }) << shift
    })
}

impl Tally {
    /// Takes a second.
    pub fn second(&mut self, second: &Second) {
        self.seconds = self.seconds.saturating_add(1);
        self.windows = self.windows.saturating_add(second.windows.into());
        self.judged = self.judged.saturating_add(second.judged.into());
        self.lamps = worse_lamps(self.lamps, second.lamps);
        for (spread, value) in self.quantities.iter_mut().zip(quantities(second)) {
            spread.value(value);
        }
    }

    /// Takes another time's.
    pub fn merge(&mut self, other: &Self) {
        self.seconds = self.seconds.saturating_add(other.seconds);
        self.windows = self.windows.saturating_add(other.windows);
        self.judged = self.judged.saturating_add(other.judged);
        self.lamps = worse_lamps(self.lamps, other.lamps);
        for (spread, other) in self.quantities.iter_mut().zip(&other.quantities) {
            spread.merge(other);
        }
    }

    /// As a point of a trend.
    pub fn point(&self, from_ms: i64, to_ms: i64) -> TrendPoint {
        let [
            r1,
            r2,
            r3,
            r4,
            voltage_v,
            current_a,
            frequency_hz,
            speed_rpm,
        ] = self.quantities.each_ref().map(Spread::values);
        TrendPoint {
            from_ms,
            to_ms,
            seconds: self.seconds,
            judged: self.judged,
            windows: self.windows,
            lamps: self.lamps,
            residuals: [r1, r2, r3, r4],
            voltage_v,
            current_a,
            frequency_hz,
            speed_rpm,
        }
    }
}
