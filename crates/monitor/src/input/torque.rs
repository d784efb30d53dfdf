//! Brake torque of a cycle: its mean, and how well its samples tell it.

/// Sums over one cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TorqueTally {
    samples: u16,
    last: f32,
    sum: f32,
    /// Of squares of what a sample is beside the one before.
    steps: f32,
}

/// What one cycle says about the load.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TorqueReading {
    /// Mean brake torque, N m; `None` unless every sample carried one.
    pub mean: Option<f32>,
    /// Standard deviation of the mean by the noise from sample to sample, N m: a load that pulsates is no noise (the mean
    /// square successive difference; von Neumann, Ann. Math. Stat. 12 (1941) 153). 0 without a mean.
    pub noise: f32,
}

impl TorqueTally {
    /// Takes one sample, N m, finite.
    #[inline(always)]
    pub fn add(&mut self, tau: f32) {
        if self.samples > 0 {
            let step = tau - self.last;
            self.steps += step * step;
        }
        self.last = tau;
        self.sum += tau;
        self.samples = self.samples.saturating_add(1);
    }

    /// What the cycle of so many samples says.
    pub fn close(&self, samples: u16) -> TorqueReading {
        if self.samples == 0 || self.samples != samples {
            return TorqueReading::default();
        }
        let n = f32::from(samples);
        let variance = 0.5 * self.steps / (n - 1.0).max(1.0);
        TorqueReading {
            mean: Some(self.sum / n),
            noise: processor::sqrtf(variance / n),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    fn reading(torques: impl Iterator<Item = f64>) -> TorqueReading {
        let (mut tally, mut samples) = (TorqueTally::default(), 0);
        for tau in torques {
            tally.add(tau as f32);
            samples += 1;
        }
        tally.close(samples)
    }

    /// Noise of 0.5 N m on 200 samples moves their mean by 0.0354; a load that pulsates by 5 N m once a cycle hardly counts.
    #[test]
    fn noise_counts_and_a_pulsating_load_does_not() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(1);
        let normal = Normal::new(0.0, 0.5).expect("a deviation");
        let turn = |k: u32| core::f64::consts::TAU * f64::from(k) / 200.0;
        let pulsating = |k| 20.0 + 5.0 * turn(k).sin();
        let expected = 0.5 / 200.0_f64.sqrt();
        for _ in 0..20 {
            let noisy = reading((0..200).map(|k| pulsating(k) + normal.sample(&mut random)));
            // Of 200 samples' differences a deviation is known to sqrt(3/800), 6 %: four times that.
            assert!((f64::from(noisy.noise) / expected - 1.0).abs() < 0.25);
        }
        // Steps of `2 pi 5/200 cos`: root mean square 0.111 N m, over sqrt(2) and sqrt(200).
        let clean = reading((0..200).map(pulsating));
        assert!((clean.mean.unwrap_or(0.0) - 20.0).abs() < 1e-4);
        assert!((clean.noise - 0.00555).abs() < 1e-4, "{clean:?}");
    }

    #[test]
    fn a_cycle_with_a_sample_too_few_has_no_torque() {
        let mut tally = TorqueTally::default();
        assert_eq!(tally.close(0), TorqueReading::default());
        tally.add(2.0);
        assert_eq!(tally.close(2).mean, None);
        assert_eq!(
            (tally.close(1).mean, tally.close(1).noise),
            (Some(2.0), 0.0)
        );
    }
}
