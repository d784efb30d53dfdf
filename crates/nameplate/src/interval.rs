//! A positive quantity with its 95 % interval.

use schemars::JsonSchema;
use serde::Serialize;

/// 97.5 % of a normal distribution lie below this many standard deviations.
const TWO_SIDED_95: f64 = 1.959_964;

/// A positive quantity with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Interval {
    /// The most likely value.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// An interval of a standard deviation of the logarithm.
    pub fn around(value: f64, log_spread: f64) -> Interval {
        let factor = (TWO_SIDED_95 * log_spread).exp();
        Interval {
            value,
            low: value / factor,
            high: value * factor,
        }
    }

    /// The part inside a range.
    pub fn inside(&self, [lowest, highest]: [f64; 2]) -> Interval {
        let limited = |x: f64| x.clamp(lowest, highest);
        Interval {
            value: limited(self.value),
            low: limited(self.low),
            high: limited(self.high),
        }
    }

    /// Standard deviation of the logarithm.
    pub fn log_spread(&self) -> f64 {
        (self.high / self.low).ln() / (2.0 * TWO_SIDED_95)
    }

    /// Whether `truth` lies inside.
    pub fn holds(&self, truth: f64) -> bool {
        (self.low..=self.high).contains(&truth)
    }
}
