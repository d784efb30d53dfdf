//! How much noise moves what a window shows: learnt from cycle to cycle, known as well as the cycles seen allow.
//!
//! What a single cycle shows, less the two before it and with the one before those, is free of any steady value, of any
//! straight line and of what changes its sign from cycle to cycle, as a motor of four poles shows its turn: a window takes
//! the mean of that away. Of white noise of variance `s^2` it has `4 s^2`. Nothing is assumed of the noise's origin, and
//! what lasts (a fault, harmonics, a ramp) does not count.
//!
//! Noise that begins: what was seen while the samples were quieter is scaled as what the samples let expect has grown
//! since, and counts for as many differences less.

use processor::{higher, lower};

/// Quantities that are followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatterState<const N: usize> {
    /// The cycles before the next one, the newest first.
    before: [[f32; N]; 3],
    /// Cycles in a row, up to three.
    in_row: u8,
    variance: [f32; N],
    /// What was believed of the variance meanwhile.
    believed: [f32; N],
    /// Differences that `variance` stands for, at most [`MEMORY`].
    seen: f32,
}

/// What is believed of single cycles before any was compared with another: variances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belief<const N: usize> {
    /// What the samples beside their fundamentals let expect if they were white noise: an inverter's ripple is none.
    pub expected: [f32; N],
    /// No less than this, whatever the samples say.
    pub floor: [f32; N],
}

/// Noise of a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise<const N: usize> {
    /// Variances of single cycles.
    pub variance: [f32; N],
    /// Degrees of freedom behind the one that is known least.
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
/// Where the variance that is believed has grown by so much, nothing that was seen counts.
const BEYOND_COMPARISON: f32 = 1e6;
/// Deviations to which what was seen must be as certain as what is expected: what a calibrated cause asks for.
const FARTHEST: f32 = 5.5;

impl<const N: usize> Default for ScatterState<N> {
    fn default() -> Self {
        ScatterState {
            before: [[0.0; N]; 3],
            in_row: 0,
            variance: [0.0; N],
            believed: [0.0; N],
            seen: 0.0,
        }
    }
}

impl<const N: usize> ScatterState<N> {
    /// Takes what one cycle shows.
    pub fn follow(&mut self, cycle: &[f32; N], belief: &Belief<N>) {
        if !cycle.iter().all(|x| x.is_finite()) {
            self.interrupt();
            return;
        }
        if self.in_row >= 3 {
            self.learn(cycle, belief);
        }
        self.in_row = (self.in_row + 1).min(3);
        let [y, z, _] = self.before;
        self.before = [*cycle, y, z];
    }

    fn learn(&mut self, cycle: &[f32; N], belief: &Belief<N>) {
        let noise = self.noise(belief);
        self.seen = (self.seen + 1.0).min(MEMORY);
        let [y, z, w] = &self.before;
        let pasts = y.iter().zip(z).zip(w);
        let learnt = self.variance.iter_mut().zip(&mut self.believed);
        let now = cycle
            .iter()
            .zip(pasts)
            .zip(noise.variance)
            .zip(belief.all());
        for ((variance, believed), (((x, ((y, z), w)), known), belief)) in learnt.zip(now) {
            let difference = x - y - z + w;
            let square = difference * difference / DIFFERENCE;
            let admitted = if known > 0.0 {
                lower(square, LARGEST * known)
            } else {
                square
            };
            *variance += (admitted - *variance) / self.seen;
            *believed += (belief - *believed) / self.seen;
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
    pub fn noise(&self, belief: &Belief<N>) -> Noise<N> {
        let (seen_variance, grown) = self.scaled(belief);
        let seen = FREEDOM * self.seen / grown;
        let freedom = BELIEF + seen;
        let alone = match belief.is_more_than(&seen_variance) {
            true => doubt(seen, FARTHEST) / doubt(freedom, FARTHEST),
            false => 1.0,
        };
        let mut variance = seen_variance;
        for (variance, (expected, floor)) in variance.iter_mut().zip(belief.pairs()) {
            // `alone` is no number where nothing was seen: what is expected holds.
            let believed = higher(lower(alone * alone * *variance, expected), floor);
            *variance = (BELIEF * believed + seen * *variance) / freedom;
        }
        Noise { variance, freedom }
    }

    /// The variances that were seen, each scaled as what is believed of it has grown since, and the largest such growth, at
    /// least 1.
    fn scaled(&self, belief: &Belief<N>) -> ([f32; N], f32) {
        let (mut scaled, mut most) = (self.variance, 1.0_f32);
        let pairs = self.believed.iter().zip(belief.all());
        for (variance, (before, now)) in scaled.iter_mut().zip(pairs) {
            if now > *before {
                let grown = lower(now / before, BEYOND_COMPARISON);
                *variance *= grown;
                most = higher(most, grown);
            }
        }
        (scaled, most)
    }
}

impl<const N: usize> Belief<N> {
    fn pairs(&self) -> impl Iterator<Item = (f32, f32)> + '_ {
        self.expected.iter().copied().zip(self.floor)
    }

    fn all(&self) -> impl Iterator<Item = f32> + '_ {
        self.pairs()
            .map(|(expected, floor)| higher(expected, floor))
    }

    /// Whether the samples let expect more of any quantity than its floor and what was seen of it: elsewhere it does not matter
    /// how surely that was seen.
    fn is_more_than(&self, seen: &[f32; N]) -> bool {
        let mut all = self.pairs().zip(seen);
        all.any(|((expected, floor), seen)| expected > floor && expected > *seen)
    }
}

impl<const N: usize> Noise<N> {
    /// How much farther than `deviations` of a known one an estimated standard deviation must reach for the same certainty.
    pub fn doubt(&self, deviations: f32) -> f32 {
        doubt(self.freedom, deviations)
    }
}

/// Student's distribution with `nu` degrees of freedom over the normal one's `deviations`, by Wallace (Ann. Math. Stat. 30
/// (1959) 1124).
fn doubt(nu: f32, deviations: f32) -> f32 {
    let z = deviations * (8.0 * nu + 3.0) / (8.0 * nu + 1.0);
    processor::sqrtf(nu * libm::expm1f(z * z / nu)) / deviations
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};

    fn normal(random: &mut rand_pcg::Pcg64) -> f32 {
        (0..12).map(|_| random.random::<f32>()).sum::<f32>() - 6.0
    }

    fn floor<const N: usize>(floor: [f32; N]) -> Belief<N> {
        Belief {
            expected: [0.0; N],
            floor: floor.map(|sigma| sigma * sigma),
        }
    }

    fn white<const N: usize>(expected: [f32; N]) -> Belief<N> {
        Belief {
            expected: expected.map(|sigma| sigma * sigma),
            floor: [0.0; N],
        }
    }

    #[test]
    fn white_noise_is_measured_whatever_it_rides_on() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(1);
        let (mut state, mut mean) = (ScatterState::<2>::default(), 0.0);
        let believed = floor([0.5, 0.0]);
        for k in 0..6000_u16 {
            let ramp = 3.0 + 0.2 * f32::from(k);
            let cycle = [
                7.0 + 2.0 * normal(&mut random),
                ramp + 0.1 * normal(&mut random),
            ];
            state.follow(&cycle, &believed);
            if k >= 500 {
                let noise = state.noise(&believed);
                mean += noise.variance[0].sqrt() / 5500.0;
                // One standard deviation of a deviation with 70 degrees of freedom is 8.5 %.
                assert!(
                    (noise.variance[1].sqrt() / 0.1 - 1.0).abs() < 0.45,
                    "{noise:?}"
                );
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
            state.follow(&[turn + 0.1 * normal(&mut random)], &floor([0.1]));
        }
        let noise = state.noise(&floor([0.1]));
        assert!(
            (noise.variance[0].sqrt() / 0.1 - 1.0).abs() < 0.45,
            "{noise:?}"
        );
    }

    /// A fault that comes at once: the noise that is known hardly grows.
    #[test]
    fn a_jump_is_no_noise() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(2);
        let mut state = ScatterState::<1>::default();
        let mut largest = 0.0_f32;
        for k in 0..200 {
            let jump = if k < 60 { 0.0 } else { 100.0 };
            state.follow(&[jump + normal(&mut random)], &floor([1.0]));
            largest = largest.max(state.noise(&floor([1.0])).variance[0].sqrt());
        }
        assert!(largest < 1.5, "{largest}");
    }

    /// Ten times the noise from one cycle to the next, and the samples say so: nothing may be judged by the quiet past.
    #[test]
    fn noise_that_begins_counts_at_once() {
        let [quiet, noisy] = [white([0.1]), white([1.0])];
        for seed in 0..200 {
            let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
            let mut state = ScatterState::<1>::default();
            for _ in 0..300 {
                state.follow(&[0.1 * normal(&mut random)], &quiet);
            }
            assert!(state.noise(&quiet).freedom > BELIEF + 0.99 * FREEDOM * MEMORY);
            // A hundredth of 69 degrees of freedom, beside sixteen of the belief.
            assert!(state.noise(&noisy).freedom < BELIEF + 0.7);
            for k in 0..300 {
                // Four true deviations at the least, in 60 000 cycles, where 5.5 are asked.
                let noise = state.noise(&noisy);
                let reach = noise.variance[0].sqrt() * noise.doubt(FARTHEST);
                assert!(reach > 0.7, "{seed}, {k}: {noise:?}");
                state.follow(&[normal(&mut random)], &noisy);
            }
        }
    }

    /// Samples without any noise, and then some: the past says nothing.
    #[test]
    fn noise_after_none_is_as_the_samples_show_it() {
        let mut state = ScatterState::<1>::default();
        for _ in 0..300 {
            state.follow(&[0.0], &white([0.0]));
        }
        let noise = state.noise(&white([1.0]));
        assert!((noise.variance[0] - 1.0).abs() < 1e-3, "{noise:?}");
        assert!((noise.freedom - BELIEF).abs() < 1e-3, "{noise:?}");
    }

    /// An inverter's ripple: the samples let expect twenty times what cycles do.
    #[test]
    fn ripple_that_moves_no_cycle_is_learnt_within_half_a_second() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(5);
        let (mut state, ripple) = (ScatterState::<1>::default(), white([1.0]));
        for k in 0..500 {
            state.follow(&[0.05 * normal(&mut random)], &ripple);
            let sigma = state.noise(&ripple).variance[0].sqrt();
            assert!(k > 2 || sigma == 1.0, "{k}: {sigma}");
            assert!(k < 25 || sigma < 0.2, "{k}: {sigma}");
            // Twice the 8 % of 69 degrees of freedom, once they are there.
            assert!(k < 120 || (0.04..0.065).contains(&sigma), "{k}: {sigma}");
        }
        let floored = Belief {
            floor: [0.01],
            ..ripple
        };
        assert!(state.noise(&floored).variance[0].sqrt() > 0.4 * 0.1);
    }

    #[test]
    fn what_does_not_follow_is_not_compared() {
        let mut state = ScatterState::<1>::default();
        for x in [0.0, 100.0, 0.0, 100.0] {
            state.interrupt();
            state.follow(&[x], &floor([1.0]));
        }
        state.follow(&[f32::NAN], &floor([1.0]));
        let noise = state.noise(&floor([1.0]));
        assert_eq!((noise.variance, noise.freedom), ([1.0], BELIEF));
    }

    /// Tables of Student's distribution: two-sided 0.0027 (three normal deviations) at 8 and 60 degrees of freedom are 4.28 and
    /// 3.13.
    #[test]
    fn few_degrees_of_freedom_reach_farther() {
        let doubt = |freedom| super::doubt(freedom, 3.0);
        assert!((doubt(8.0) - 4.28 / 3.0).abs() < 0.02, "{}", doubt(8.0));
        assert!((doubt(60.0) - 3.13 / 3.0).abs() < 0.01, "{}", doubt(60.0));
    }
}
