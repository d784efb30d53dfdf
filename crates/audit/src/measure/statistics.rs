//! Robust averages.

use num_complex::Complex64;

/// The median; `None` of nothing.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    quantile(values, 0.5)
}

/// The value below which a share of the values lies; `None` of nothing.
pub(crate) fn quantile(values: impl IntoIterator<Item = f64>, share: f64) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    let last = values.len().checked_sub(1)?;
    let at = ((last as f64) * share).round() as usize;
    Some(*values.select_nth_unstable_by(at, f64::total_cmp).1)
}

/// Median of real and imaginary parts: averages phasors coherently, so that noise leaves no bias.
pub(crate) fn median_phasor(values: &[Complex64]) -> Option<Complex64> {
    let re = median(values.iter().map(|z| z.re))?;
    let im = median(values.iter().map(|z| z.im))?;
    Some(Complex64::new(re, im))
}

/// Median and its standard error, the scatter taken from the median absolute deviation.
pub(crate) fn median_with_error(values: &[f64]) -> Option<(f64, f64)> {
    /// Standard deviation over median absolute deviation of Gaussian noise.
    const GAUSSIAN: f64 = 1.4826;
    /// Standard error of a median over that of a mean, Gaussian noise.
    const MEDIAN: f64 = 1.2533;
    let middle = median(values.iter().copied())?;
    let deviation = median(values.iter().map(|x| (x - middle).abs()))?;
    Some((
        middle,
        MEDIAN * GAUSSIAN * deviation / (values.len() as f64).sqrt(),
    ))
}

/// Standard deviation of the noise of one sample, from third differences: what is smooth over four
/// samples cancels.
pub(crate) fn noise(x: &[f64]) -> f64 {
    // Sum of squares of 1, -3, 3, -1 is 20; the median of |z| is 0.6745 sigma.
    let third = || {
        x.windows(4)
            .map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs())
    };
    median_of_many(third).unwrap_or(0.0) / (20f64.sqrt() * 0.674_5)
}

/// Leading bits of a number by which values are counted: its exponent and what tells a sixteenth of an octave.
const LEADING: u32 = 16;

/// [`median`] of values from 0 on that come twice: only those near it are kept.
fn median_of_many<I: Iterator<Item = f64>>(values: impl Fn() -> I) -> Option<f64> {
    // From 0 on the bits of numbers are in the order of the numbers.
    let class = |x: f64| (x.to_bits() >> (u64::BITS - LEADING)) as usize;
    let mut counts = vec![0_usize; 1 << LEADING];
    values().for_each(|x| counts[class(x)] += 1);
    let last = counts.iter().sum::<usize>().checked_sub(1)?;
    let mut at = (last as f64 * 0.5).round() as usize;
    let holds = |count: &usize| match at.checked_sub(*count) {
        Some(beyond) => {
            at = beyond;
            false
        }
        None => true,
    };
    let middle = counts.iter().position(holds)?;
    let mut near: Vec<f64> = values().filter(|x| class(*x) == middle).collect();
    Some(*near.select_nth_unstable_by(at, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_wild_value_moves_no_median() {
        assert_eq!(median([1.0, 2.0, 1e9]), Some(2.0));
        assert_eq!(median([]), None);
        let phasors = [
            Complex64::new(1.0, -1.0),
            Complex64::new(1.0, -1.0),
            Complex64::i() * 1e6,
        ];
        assert_eq!(median_phasor(&phasors), Some(Complex64::new(1.0, -1.0)));
    }

    #[test]
    fn the_median_of_many_is_the_median() {
        let few = [0.0, 3.0, 1e-300, 7.0, 3.0, f64::INFINITY];
        // Sizes that lie in many octaves, and in one; an even and an odd number.
        let wide: Vec<f64> = (0..5_000).map(|k| f64::from(k % 977).exp2()).collect();
        let narrow: Vec<f64> = (0..5_001).map(|k| 1.0 + f64::from(k % 13) * 1e-3).collect();
        for values in [&few[..], &few[..3], &few[..1], &[], &wide, &narrow] {
            let all = || values.iter().copied();
            assert_eq!(median_of_many(all), median(all()));
        }
    }

    #[test]
    fn noise_is_told_from_a_smooth_signal() {
        // Uniform noise by splitmix64: sigma is its width over sqrt 12.
        let mut state = 1u64;
        let mut uniform = || {
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let z = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            (z ^ (z >> 31)) as f64 / u64::MAX as f64 - 0.5
        };
        let x: Vec<f64> = (0..20_000)
            .map(|k| 300.0 * (f64::from(k) * 0.0314).sin() + uniform())
            .collect();
        // Third differences of four uniform values are not quite Gaussian: their median is 6 % off.
        assert!(
            (noise(&x) * 12f64.sqrt() - 1.0).abs() < 0.08,
            "{}",
            noise(&x)
        );
    }
}
