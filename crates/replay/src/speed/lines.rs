//! Which lines the slots and an eccentric rotor leave, and what a power at such a place says for a line.
//!
//! Slots: order `R (1 - s)/p + v`, `v` odd, turning either way. Eccentricity: order `1 +- (1 - s)/p`.

use std::sync::LazyLock;

/// A multiple of the supply's frequency that the slots modulate.
pub(super) struct Harmonic {
    /// Its order, odd.
    pub order: i32,
    /// How often a motor with slot harmonics shows it.
    pub usual: f64,
}

const fn harmonic(order: i32, usual: f64) -> Harmonic {
    Harmonic { order, usual }
}

/// The fundamental's lines are the strongest; those of the saturated air gap and of the winding's steps are weaker.
pub(super) const HARMONICS: [Harmonic; 10] = [
    harmonic(1, 0.5),
    harmonic(-1, 0.5),
    harmonic(3, 0.3),
    harmonic(-3, 0.3),
    harmonic(5, 0.3),
    harmonic(-5, 0.3),
    harmonic(7, 0.2),
    harmonic(-7, 0.2),
    harmonic(9, 0.1),
    harmonic(-9, 0.1),
];

/// How often eccentricity is seen.
pub(super) const ECCENTRIC: f64 = 0.3;

/// Numbers of bars that cages have: 9 to 26 per pole pair in small machines, fewer with many poles.
pub(super) fn plausible_bars(pole_pairs: u32) -> std::ops::RangeInclusive<u32> {
    (9 * pole_pairs).max(14)..=36 + 16 * pole_pairs
}

/// Ratios of line to noise that are equally likely: their logarithms of 10 are equally spaced.
const RATIOS: usize = 21;

/// What a sum of powers is asked for each ratio.
struct Ratio {
    ratio: f64,
    /// `ln(1 + ratio)`.
    log: f64,
}

/// The same for every sum.
static TABLE: LazyLock<[Ratio; RATIOS]> = LazyLock::new(|| {
    std::array::from_fn(|k| {
        let ratio = 10f64.powf(-1.0 + 0.25 * k as f64);
        Ratio {
            ratio,
            log: ratio.ln_1p(),
        }
    })
});

/// Logarithm of how much likelier a sum of `count` powers over noise is with a line of unknown size than without.
pub(super) fn log_ratio(sum: f64, count: f64) -> f64 {
    let each = TABLE
        .each_ref()
        .map(|r| sum * r.ratio / (1.0 + r.ratio) - count * r.log);
    log_mean_exp(each.into_iter())
}

/// Logarithm of the mean of exponentials.
pub(super) fn log_mean_exp(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let largest = values.clone().fold(f64::MIN, f64::max);
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += (value - largest).exp();
        count += 1.0;
    }
    largest + (sum / f64::max(count, 1.0)).ln()
}

/// Logarithm of how much likelier a place is when the line is expected there with probability `usual`, than when only a line
/// of another origin can be there by chance, with probability `outliers`. No single line says more than `usual/outliers`.
pub(super) fn evidence(log_ratio: f64, usual: f64, outliers: f64) -> f64 {
    // Over 1 - e + e g, both divided by g where it is large.
    let bounded = if log_ratio > 0.0 {
        1.0 / ((1.0 - outliers) * (-log_ratio).exp() + outliers)
    } else {
        let g = log_ratio.exp();
        g / (1.0 - outliers + outliers * g)
    };
    (1.0 - usual + usual * bounded).ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_speaks_against_a_line_and_a_line_for_it_up_to_a_bound() {
        assert!(evidence(log_ratio(10.0, 10.0), 0.5, 1e-3) < 0.0);
        let strong = evidence(log_ratio(1e6, 10.0), 0.5, 1e-3);
        assert!((strong - 500f64.ln()).abs() < 0.01, "{strong}");
    }

    /// The mean of the ratio over noise alone is 1: it is a ratio of two densities.
    #[test]
    fn the_ratio_is_one_of_densities() {
        for count in [1.0, 4.0] {
            let step = 0.01;
            let gamma = if count > 1.0 { 6.0 } else { 1.0 };
            let mean: f64 = (1..40_000)
                .map(|k| {
                    let x = step * f64::from(k);
                    let density = x.powf(count - 1.0) * (-x).exp() / gamma;
                    step * density * log_ratio(x, count).exp()
                })
                .sum();
            // Mass of the largest ratios lies beyond the sum.
            assert!((0.55..1.01).contains(&mean), "{count}: {mean}");
        }
    }
}
