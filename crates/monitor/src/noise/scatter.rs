//! How much noise moves what a window shows: learnt from cycle to cycle, known as well as the cycles seen allow.
//!
//! What a single cycle shows, less the two before it and with the one before those, is free of any steady value, of any
//! straight line and of what changes its sign from cycle to cycle, as a motor of four poles shows its turn: a window takes
//! the mean of that away. Of white noise of variance `s^2` it has `4 s^2`. Nothing is assumed of the noise's origin, and
//! what lasts (a fault, harmonics, a ramp) does not count.

/// Quantities that are followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatterState<const N: usize> {
    /// The cycles before the next one, the newest first.
    before: [[f32; N]; 3],
    /// Cycles in a row, up to three.
    in_row: u8,
    variance: [f32; N],
    /// Differences that `variance` stands for, at most [`MEMORY`].
    seen: f32,
}

/// Noise of a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise<const N: usize> {
    /// Standard deviations of single cycles.
    pub cycle: [f32; N],
    /// Degrees of freedom behind them.
    pub freedom: f32,
}

/// Differences that are remembered: half of them are forgotten within a second and a half at 50 Hz.
const MEMORY: f32 = 120.0;
/// Variance of a difference `x - y - z + w` of white noise of variance 1.
const DIFFERENCE: f32 = 4.0;
/// Degrees of freedom in one difference: neighbours share values (correlations -1/4, -1/2 and 1/4).
const FREEDOM: f32 = 1.0 / (1.0 + 2.0 * (1.0 / 16.0 + 1.0 / 4.0 + 1.0 / 16.0));
/// A difference counts for at most so many times the variance: a fault that comes is no noise.
const LARGEST: f32 = 9.0;
/// Degrees of freedom with which what is believed beforehand counts.
const BELIEF: f32 = 16.0;

impl<const N: usize> Default for ScatterState<N> {
    fn default() -> Self {
        ScatterState {
            before: [[0.0; N]; 3],
            in_row: 0,
            variance: [0.0; N],
            seen: 0.0,
        }
    }
}

impl<const N: usize> ScatterState<N> {
    /// Takes what one cycle shows; `believed` are the standard deviations of a cycle before anything was seen.
    pub fn follow(&mut self, cycle: &[f32; N], believed: &[f32; N]) {
        if !cycle.iter().all(|x| x.is_finite()) {
            self.interrupt();
            return;
        }
        if self.in_row >= 3 {
            self.learn(cycle, believed);
        }
        self.in_row = (self.in_row + 1).min(3);
        let [y, z, _] = self.before;
        self.before = [*cycle, y, z];
    }

    fn learn(&mut self, cycle: &[f32; N], believed: &[f32; N]) {
        let noise = self.noise(believed);
        self.seen = (self.seen + 1.0).min(MEMORY);
        let [y, z, w] = &self.before;
        let pasts = y.iter().zip(z).zip(w);
        for (((variance, x), ((y, z), w)), sigma) in self
            .variance
            .iter_mut()
            .zip(cycle)
            .zip(pasts)
            .zip(noise.cycle)
        {
            let difference = x - y - z + w;
            let square = difference * difference / DIFFERENCE;
            let known = sigma * sigma;
            let admitted = if known > 0.0 {
                square.min(LARGEST * known)
            } else {
                square
            };
            *variance += (admitted - *variance) / self.seen;
        }
    }

    /// The next cycle does not follow the one before: time is missing, or the motor was not steady.
    pub fn interrupt(&mut self) {
        self.in_row = 0;
    }

    /// Whether the next cycle begins anew.
    pub fn is_interrupted(&self) -> bool {
        self.in_row == 0
    }

    /// What is known now.
    pub fn noise(&self, believed: &[f32; N]) -> Noise<N> {
        let seen = FREEDOM * self.seen;
        let mut cycle = *believed;
        for (sigma, variance) in cycle.iter_mut().zip(self.variance) {
            let sum = BELIEF * *sigma * *sigma + seen * variance;
            *sigma = processor::sqrtf(sum / (BELIEF + seen));
        }
        Noise {
            cycle,
            freedom: BELIEF + seen,
        }
    }
}

impl<const N: usize> Noise<N> {
    /// How much farther than `deviations` of a known one an estimated standard deviation must reach for the same certainty:
    /// Student's distribution, by Wallace (Ann. Math. Stat. 30 (1959) 1124).
    pub fn doubt(&self, deviations: f32) -> f32 {
        let nu = self.freedom;
        let z = deviations * (8.0 * nu + 3.0) / (8.0 * nu + 1.0);
        processor::sqrtf(nu * libm::expm1f(z * z / nu)) / deviations
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};

    fn normal(random: &mut rand_pcg::Pcg64) -> f32 {
        (0..12).map(|_| random.random::<f32>()).sum::<f32>() - 6.0
    }

    #[test]
    fn white_noise_is_measured_whatever_it_rides_on() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(1);
        let (mut state, mut mean) = (ScatterState::<2>::default(), 0.0);
        let believed = [0.5, 0.0];
        for k in 0..6000_u16 {
            let ramp = 3.0 + 0.2 * f32::from(k);
            let cycle = [
                7.0 + 2.0 * normal(&mut random),
                ramp + 0.1 * normal(&mut random),
            ];
            state.follow(&cycle, &believed);
            if k >= 500 {
                let noise = state.noise(&believed);
                mean += noise.cycle[0] / 5500.0;
                // One standard deviation of a deviation with 70 degrees of freedom is 8.5 %.
                assert!((noise.cycle[1] / 0.1 - 1.0).abs() < 0.45, "{noise:?}");
            }
        }
        // What exceeds three standard deviations is cut, and the belief of a quarter pulls by a tenth.
        assert!((mean / 2.0 - 0.9).abs() < 0.07, "{mean}");
    }

    /// Once a turn of four poles is half the supply's frequency, less half the slip: 100 times the noise, of which a window of
    /// five cycles keeps a fifth at the most and takes none for noise.
    #[test]
    fn a_motor_that_shows_its_turn_is_not_noisy() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(3);
        let mut state = ScatterState::<1>::default();
        for k in 0..500_u16 {
            let turn = if k % 2 == 0 { 10.0 } else { -10.0 };
            state.follow(&[turn + 0.1 * normal(&mut random)], &[0.1]);
        }
        let noise = state.noise(&[0.1]);
        assert!((noise.cycle[0] / 0.1 - 1.0).abs() < 0.45, "{noise:?}");
    }

    /// A fault that comes at once: the noise that is known hardly grows.
    #[test]
    fn a_jump_is_no_noise() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(2);
        let mut state = ScatterState::<1>::default();
        let mut largest = 0.0_f32;
        for k in 0..200 {
            let jump = if k < 60 { 0.0 } else { 100.0 };
            state.follow(&[jump + normal(&mut random)], &[1.0]);
            largest = largest.max(state.noise(&[1.0]).cycle[0]);
        }
        assert!(largest < 1.5, "{largest}");
    }

    #[test]
    fn what_does_not_follow_is_not_compared() {
        let mut state = ScatterState::<1>::default();
        for x in [0.0, 100.0, 0.0, 100.0] {
            state.interrupt();
            state.follow(&[x], &[1.0]);
        }
        state.follow(&[f32::NAN], &[1.0]);
        let noise = state.noise(&[1.0]);
        assert_eq!((noise.cycle, noise.freedom), ([1.0], BELIEF));
    }

    /// Tables of Student's distribution: two-sided 0.0027 (three normal deviations) at 8 and 60 degrees of freedom are 4.28 and
    /// 3.13.
    #[test]
    fn few_degrees_of_freedom_reach_farther() {
        let doubt = |freedom| {
            Noise {
                cycle: [1.0],
                freedom,
            }
            .doubt(3.0)
        };
        assert!((doubt(8.0) - 4.28 / 3.0).abs() < 0.02, "{}", doubt(8.0));
        assert!((doubt(60.0) - 3.13 / 3.0).abs() < 0.01, "{}", doubt(60.0));
    }
}
