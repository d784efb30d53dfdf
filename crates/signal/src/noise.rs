//! Noise of a channel, declared or estimated.

use fourier::Transform;
use num_complex::Complex64;
use recording::{Channel, Recording};
use std::f64::consts::TAU;
use std::ops::RangeInclusive;

/// Samples of a piece whose spectrum is looked at: so long that the lines of a supply leave most of it free.
const PIECE: RangeInclusive<usize> = 256..=4096;
/// Pieces that a recording has at least, by halves overlapping.
const PIECES: usize = 7;
/// Share of the noise in third differences below which the spectrum is believed: they hold something that is no noise.
const CLEARLY_LESS: f64 = 0.8;

/// Standard deviation of white noise on a signal: the median magnitude of its third differences, unless lines of the spectrum
/// near half the sampling rate are most of that.
///
/// Third differences of a sinusoid of 50 Hz at 5 kHz are 2.5e-4 of its amplitude, but seven times that of one of 950 Hz at 2 kHz.
pub fn estimated_sigma(x: &[f64]) -> f64 {
    let differences = by_differences(x);
    let spectrum = by_spectrum(x).filter(|sigma| *sigma < CLEARLY_LESS * differences);
    spectrum.unwrap_or(differences).max(by_steps(x))
}

/// Fewest steps between readings that show a resolution: a load that is switched now and then makes a few, too.
const STEPS: usize = 8;
/// Share of steps of one size from which all readings are counts, and how far a step may be from that size.
const OF_ONE_SIZE: f64 = 0.9;
const SAME_SIZE: f64 = 0.01;
/// Readings within which counts are compared with their mean, and changes of the count that these hold on average at least: of a window that
/// moves on from sample to sample, as long as two hundred of them, a count stays for all of them.
const NEAR: usize = 64;
const CHANGES: usize = 4;

/// Whether readings are counts, as those of an encoder: they change by one size, or stay what they are most of the time. Noise on a converter
/// of enough bits does neither.
pub fn are_counts(x: &[f64]) -> bool {
    let steps = steps_between(x);
    let most_stay = 2 * steps.len() <= x.len();
    steps.len() >= STEPS && (most_stay || are_of_one_size(&steps, middle(&mut steps.clone())))
}

fn steps_between(x: &[f64]) -> Vec<f64> {
    let steps = x.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    steps.filter(|step| *step > 0.0).collect()
}

fn middle(steps: &mut [f64]) -> f64 {
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

fn are_of_one_size(steps: &[f64], step: f64) -> bool {
    let of_one_size = steps.iter().filter(|x| (*x / step - 1.0).abs() < SAME_SIZE);
    of_one_size.count() as f64 > OF_ONE_SIZE * steps.len() as f64
}

/// Rounding of readings that stand on steps, as counts of an encoder do: their third differences are zero, or a pattern that has lines
/// in the spectrum and nothing between them.
fn by_steps(x: &[f64]) -> f64 {
    let mut steps = steps_between(x);
    if steps.len() < STEPS {
        return 0.0;
    }
    let step = middle(&mut steps);
    let are_counts = are_of_one_size(&steps, step);
    let stand = 2 * steps.len() <= x.len();
    let rounding = step * step / 12.0;
    let near = NEAR.max(CHANGES * x.len() / steps.len());
    match are_counts {
        true => rounding.max(rounding_of_counts(x, step, near)).sqrt(),
        false if stand => rounding.sqrt(),
        false => 0.0,
    }
}

/// Variance of counts about what they count: a share `p` of readings stands one step higher than the others, which makes
/// `p (1 - p)` steps squared, a quarter at most; what changes more within `near` readings has changed itself.
fn rounding_of_counts(x: &[f64], step: f64, near: usize) -> f64 {
    let largest = step * step / 4.0;
    let variance = |piece: &[f64]| {
        let mean = piece.iter().sum::<f64>() / piece.len() as f64;
        let squares = piece.iter().map(|x| (x - mean).powi(2));
        (squares.sum::<f64>() / piece.len() as f64).min(largest)
    };
    let pieces = x.chunks(near);
    pieces.clone().map(variance).sum::<f64>() / pieces.len() as f64
}

/// What lies between the lines of the spectrum: the lower quartile of its upper half, which for white noise is the share
/// `ln(4/3)` of the mean.
fn by_spectrum(x: &[f64]) -> Option<f64> {
    let room = 2 * x.len() / (PIECES + 1);
    let count = (1 << room.checked_ilog2()?).min(*PIECE.end());
    if count < *PIECE.start() {
        return None;
    }
    let hann = |k: usize| 0.5 - 0.5 * (TAU * k as f64 / count as f64).cos();
    let window: Vec<f64> = (0..count).map(hann).collect();
    let scale: f64 = window.iter().map(|w| w * w).sum::<f64>() * (4.0f64 / 3.0).ln();
    let transform = Transform::of(count);
    let quartile = |piece: &[f64]| {
        let weighted = piece.iter().zip(&window);
        let mut lines: Vec<Complex64> = weighted.map(|(x, w)| Complex64::new(x * w, 0.0)).collect();
        transform.forward(&mut lines);
        let mut upper: Vec<f64> = lines[count / 4..count / 2]
            .iter()
            .map(|line| line.norm_sqr())
            .collect();
        let quarter = upper.len() / 4;
        *upper.select_nth_unstable_by(quarter, f64::total_cmp).1 / scale
    };
    let starts = (0..=x.len() - count).step_by(count / 2);
    let mut variances: Vec<f64> = starts.map(|k| quartile(&x[k..k + count])).collect();
    let middle = variances.len() / 2;
    Some(
        variances
            .select_nth_unstable_by(middle, f64::total_cmp)
            .1
            .sqrt(),
    )
}

fn by_differences(x: &[f64]) -> f64 {
    let mut third: Vec<f64> = x
        .windows(4)
        .map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs())
        .collect();
    if third.is_empty() {
        return 0.0;
    }
    // Variance of the difference: 1 + 9 + 9 + 1; median of |normal|: 0.6745 sigma.
    median_of_levels(&mut third) / (0.6745 * 20f64.sqrt())
}

/// Share of a value within which others are the same level of a converter.
const SAME_LEVEL: f64 = 1e-4;

/// Median of values that a converter may have put on levels: within the level on which half of them fall, by the share that lies
/// below it. The level itself would be off by up to half a step, 4 % of noise of four steps.
fn median_of_levels(values: &mut [f64]) -> f64 {
    let count = values.len();
    let level = *values.select_nth_unstable_by(count / 2, f64::total_cmp).1;
    let near = SAME_LEVEL * level;
    let is_same = |x: &&f64| (**x - level).abs() <= near;
    let same = values.iter().filter(is_same).count() as f64;
    let below = values.iter().filter(|x| **x < level - near).count() as f64;
    let others = values.iter().filter(|x| !is_same(x));
    let step = others.fold(f64::INFINITY, |step, x| step.min((x - level).abs()));
    if level == 0.0 || step == f64::INFINITY {
        return level;
    }
    level + step * ((0.5 * count as f64 - below) / same - 0.5)
}

/// Declared noise of a channel, or an estimate, never zero, nor less than the steps that its readings stand on. A converter whose noise is not declared has that of its rounding at least.
pub fn sigma(rec: &Recording, channel: Channel, x: &[f64]) -> f64 {
    let sensors = &rec.metadata.sensors;
    let declared = sensors.sigma(channel);
    let sigma = match sensors.noise_sigma_fraction_of_full_scale {
        Some(_) => declared.map_or_else(|| estimated_sigma(x), |sigma| sigma.max(by_steps(x))),
        None => estimated_sigma(x).max(declared.unwrap_or(0.0)),
    };
    let top = x.iter().fold(0.0f64, |a, b| a.max(b.abs()));
    sigma.max(1e-6 * top).max(1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    #[test]
    fn the_noise_on_a_sinusoid_is_found_within_five_percent() {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(3);
        let normal = Normal::new(0.0, 0.1).unwrap();
        let x: Vec<f64> = (0..20_000)
            .map(|k| 10.0 * (0.0314 * f64::from(k)).sin() + normal.sample(&mut rng))
            .collect();
        assert!((estimated_sigma(&x) / 0.1 - 1.0).abs() < 0.05);
    }

    /// Counts per 10 ms of an encoder at a steady speed: between two counts in the share of the speed, for which the exact deviation
    /// is that of a coin. A twelfth of the step squared is what a reading rounds, and up to three times too little.
    #[test]
    fn counts_of_an_encoder_scatter_as_a_coin_does() {
        for share in [0.3, 0.46, 0.5, 0.62, 0.77] {
            let position = |k: usize| (0.37 + (41.0 + share) * k as f64).floor();
            let x: Vec<f64> = (0..12_000)
                .map(|k| 0.153 * (position(k + 1) - position(k)))
                .collect();
            let truth = 0.153 * (share * (1.0 - share)).sqrt();
            let found = estimated_sigma(&x);
            // Pieces of 64 readings hold no whole number of periods of the pattern.
            assert!(
                (found / truth - 1.0).abs() < 0.02,
                "{share}: {found} {truth}"
            );
        }
    }

    /// The same of a window of 10 ms that moves on at 20 kHz, near a speed of a whole number of counts: each count stays for hundreds of readings.
    #[test]
    fn counts_of_a_moving_window_scatter_as_much() {
        for share in [0.02, 0.1, 0.3, 0.5] {
            let position = |k: usize| (0.37 + (1200.0 + share) * k as f64 / 200.0).floor();
            let x: Vec<f64> = (0..40_000)
                .map(|k| 0.153 * (position(k + 200) - position(k)))
                .collect();
            let truth = 0.153 * f64::sqrt((share * (1.0 - share)).max(1.0 / 12.0));
            let found = estimated_sigma(&x);
            // Pieces of two periods of the pattern, and not always whole ones.
            assert!(
                found / truth > 0.9 && found / truth < 1.1,
                "{share}: {found} {truth}"
            );
        }
    }

    /// The median of levels would jump by half a step: 6 % at two steps of noise.
    #[test]
    fn the_noise_of_readings_on_steps_is_found_within_two_percent() {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(5);
        for sigma in [1.0, 1.3, 1.7, 2.0, 2.4, 3.1, 4.0, 7.0] {
            let normal = Normal::new(0.0, sigma).unwrap();
            let x: Vec<f64> = (0..60_000)
                .map(|k| (400.0 * (0.0314 * f64::from(k)).sin() + normal.sample(&mut rng)).round())
                .map(|count: f64| 0.21 * count)
                .collect();
            // Rounding adds its own variance, a twelfth. The median of 60 000 differences scatters by 0.7 %.
            let truth = 0.21 * (sigma * sigma + 1.0f64 / 12.0).sqrt();
            let found = estimated_sigma(&x);
            assert!(
                (found / truth - 1.0).abs() < 0.02,
                "{sigma}: {found} {truth}"
            );
        }
    }

    /// A recorder of 2 kHz on a supply with a nineteenth harmonic: third differences take that for noise.
    #[test]
    fn a_line_near_half_the_sampling_rate_is_no_noise() {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(3);
        let normal = Normal::new(0.0, 0.002).unwrap();
        let x: Vec<f64> = (0..4000)
            .map(|k| {
                let angle = TAU * 0.025 * f64::from(k);
                let lines = angle.sin() + 0.03 * (19.0 * angle).sin() + 0.02 * (13.0 * angle).cos();
                lines + normal.sample(&mut rng)
            })
            .collect();
        assert!(by_differences(&x) > 10.0 * 0.002);
        // The quartile of 250 lines in each of seven pieces scatters by 3 %; lines leak into some of them.
        let sigma = estimated_sigma(&x);
        assert!((sigma / 0.002 - 1.0).abs() < 0.15, "{sigma}");
    }

    /// Counts of an encoder that turns evenly: now and then one more. The step is a third of a radian per second; rounding to it
    /// is uniform.
    #[test]
    fn readings_on_steps_have_the_noise_of_their_rounding() {
        let step = 1.0 / 3.0;
        let x: Vec<f64> = (0..640)
            .map(|k| step * (550.0 + 0.4 * (0.2 * f64::from(k)).sin()).round())
            .collect();
        assert_eq!(estimated_sigma(&x), 0.0, "it never changes");
        let truth = |k: u32| step * (550.4 + 0.2 * (0.2 * f64::from(k)).sin());
        let read = |k: u32| step * (truth(k) / step).round();
        let x: Vec<f64> = (0..640).map(read).collect();
        assert!(by_differences(&x) == 0.0);
        let squares: f64 = (0..640).map(|k| (read(k) - truth(k)).powi(2)).sum();
        let rounded = (squares / 640.0).sqrt();
        // What moves by less than a step is taken for rounding: not less than it was, nor more than half a step.
        let found = estimated_sigma(&x);
        assert!(found >= rounded && found <= 0.5 * step, "{found} {rounded}");
        // Three steps of a load are no resolution.
        let load: Vec<f64> = (0..640).map(|k| f64::from(k / 200)).collect();
        assert_eq!(estimated_sigma(&load), 0.0);
    }

    #[test]
    fn slow_signals_have_no_noise_and_short_ones_none_to_speak_of() {
        let parabola: Vec<f64> = (0..100).map(|k| f64::from(k * k)).collect();
        assert_eq!(estimated_sigma(&parabola), 0.0);
        assert_eq!(estimated_sigma(&[1.0, 5.0, 2.0]), 0.0);
        // The third difference of a single step of 4 samples: 1 - 0 + 0 - 0.
        let expected = 1.0 / (0.6745 * 20f64.sqrt());
        assert!((estimated_sigma(&[0.0, 0.0, 0.0, 1.0]) - expected).abs() < 1e-12);
    }
}
