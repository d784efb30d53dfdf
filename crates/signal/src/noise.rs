//! Noise of a channel, declared or estimated.

use recording::{Channel, Recording};

/// Standard deviation of white noise on a smooth signal: the median magnitude of its third differences.
///
/// Third differences of a sinusoid of 50 Hz at 5 kHz are 2.5e-4 of its amplitude.
pub fn estimated_sigma(x: &[f64]) -> f64 {
    let mut third: Vec<f64> = x
        .windows(4)
        .map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs())
        .collect();
    if third.is_empty() {
        return 0.0;
    }
    let middle = third.len() / 2;
    let median = *third.select_nth_unstable_by(middle, f64::total_cmp).1;
    // Variance of the difference: 1 + 9 + 9 + 1; median of |normal|: 0.6745 sigma.
    median / (0.6745 * 20f64.sqrt())
}

/// Declared noise of a channel, or an estimate, never zero.
pub fn sigma(rec: &Recording, channel: Channel, x: &[f64]) -> f64 {
    let declared = rec.metadata.sensors.sigma(channel);
    let sigma = declared.unwrap_or_else(|| estimated_sigma(x));
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
