//! Shares with their confidence, and quantiles.

use schemars::JsonSchema;
use serde::Serialize;
use statrs::distribution::{Beta, ContinuousCDF, Gamma};

/// One minus this is the confidence of every one-sided bound.
pub const RISK: f64 = 0.05;

/// The mean behind a count is at most this, with 95 % confidence (exact Poisson bound: Garwood 1936).
pub fn poisson_at_most(count: u64) -> f64 {
    Gamma::new(count as f64 + 1.0, 1.0).map_or(f64::NAN, |gamma| gamma.inverse_cdf(1.0 - RISK))
}

/// So many out of so many.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
#[serde(into = "Written")]
pub struct Share {
    /// How many.
    pub count: u64,
    /// Out of how many.
    pub of: u64,
}

/// A share as JSON holds it.
#[derive(Serialize, JsonSchema)]
struct Written {
    /// How many.
    count: u64,
    /// Out of how many.
    of: u64,
    /// Percent; `null` of nothing.
    percent: Option<f64>,
}

impl From<Share> for Written {
    fn from(share: Share) -> Written {
        Written {
            count: share.count,
            of: share.of,
            percent: (share.of > 0).then(|| 100.0 * share.value()),
        }
    }
}

impl Share {
    /// Counts what holds.
    pub fn count(holds: impl Iterator<Item = bool>) -> Share {
        holds.fold(Share::default(), |share, holds| Share {
            count: share.count + u64::from(holds),
            of: share.of + 1,
        })
    }

    /// The observed share, 0..=1; not a number of nothing.
    pub fn value(self) -> f64 {
        self.count as f64 / self.of as f64
    }

    /// The probability behind it is at least this, with 95 % confidence (exact binomial bound: Clopper and Pearson 1934).
    pub fn at_least(self) -> f64 {
        if self.count == 0 {
            return 0.0;
        }
        quantile_of_beta(self.count as f64, (self.of - self.count) as f64 + 1.0, RISK)
    }

    /// The probability behind it is at most this, with 95 % confidence.
    pub fn at_most(self) -> f64 {
        if self.count == self.of {
            return 1.0;
        }
        let other = (self.of - self.count) as f64;
        quantile_of_beta(self.count as f64 + 1.0, other, 1.0 - RISK)
    }
}

fn quantile_of_beta(a: f64, b: f64, p: f64) -> f64 {
    Beta::new(a, b).map_or(f64::NAN, |beta| beta.inverse_cdf(p))
}

/// The smallest value that at least this share of all does not exceed; `None` of nothing.
pub fn quantile(values: &mut [f64], share: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let rank = (share * values.len() as f64).ceil() as usize;
    values.get(rank.max(1) - 1).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_miss_the_bound_is_the_root_of_the_risk() {
        let share = Share {
            count: 299,
            of: 299,
        };
        // 0.05^(1/299): with 299 runs and no miss, 99 % is proven.
        assert!((share.at_least() - 0.05_f64.powf(1.0 / 299.0)).abs() < 1e-6);
        assert!(share.at_least() > 0.99);
        assert_eq!(share.at_most(), 1.0);
    }

    /// The tail of the binomial distribution, summed.
    #[test]
    fn bounds_are_those_at_which_the_observation_becomes_unlikely() {
        let share = Share { count: 3, of: 40 };
        let tail = |p: f64, counts: std::ops::RangeInclusive<u32>| -> f64 {
            let choose = |k: u32| (0..k).fold(1.0, |c, j| c * f64::from(40 - j) / f64::from(j + 1));
            counts
                .map(|k| choose(k) * p.powi(k as i32) * (1.0 - p).powi(40 - k as i32))
                .sum()
        };
        // 1e-4: how far the library's search goes.
        assert!((tail(share.at_least(), 3..=40) - RISK).abs() < 1e-4);
        assert!((tail(share.at_most(), 0..=3) - RISK).abs() < 1e-4);
    }

    #[test]
    fn quantiles_are_values_that_occurred() {
        let mut values = [4.0, 1.0, 3.0, 2.0];
        assert_eq!(quantile(&mut values, 0.5), Some(2.0));
        assert_eq!(quantile(&mut values, 0.95), Some(4.0));
        assert_eq!(quantile(&mut [], 0.5), None);
    }
}
