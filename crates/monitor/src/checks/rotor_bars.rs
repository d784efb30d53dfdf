//! Broken rotor bars: the sidebands that they leave in the current at twice the slip frequency.
//!
//! An asymmetric cage answers the rotor's field with a second one that turns backwards against the rotor. Seen from the
//! stator it turns at `(1 - 2 s)` times the supply's frequency; the torque that it swings sets the speed swinging, which
//! adds its mirror at `(1 + 2 s)` (Deleroi 1984; Filippetti et al., IEEE Trans. Ind. Appl. 34 (1998) 98,
//! doi:10.1109/28.658729). Seen from the voltage both are turns at plus and minus `2 s omega`, whose angle is known: supply
//! and shaft are measured. So whole turns of that angle are summed up, over which all else cancels.

use core::f32::consts::TAU;

use num_complex::Complex32;

use crate::sync::rotation::{renormalise, small_rotation};

/// Turns of twice the slip angle in one block: load steps and other pulsations cancel the better, the more there are.
const TURNS: f32 = 4.0;
/// Largest step of twice the slip angle from one cycle to the next, rad.
const LARGEST_STEP: f32 = 2.0 * TAU * Sidebands::LARGEST_SLIP;
/// Share of the current's unrest that both sidebands must explain: a load step explains 12 % at most.
const EXPLAINED: f32 = 0.5;

/// What one block of whole turns says about the cage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sidebands {
    /// Amplitude at `(1 - 2 s)` times the supply's frequency, as a share of the active current.
    pub lower: f32,
    /// Amplitude at `(1 + 2 s)` times the supply's frequency, as a share of the active current.
    pub upper: f32,
    /// Whether both explain most of what the current did in the block.
    pub dominate: bool,
}

impl Sidebands {
    /// Share of the active current from which on a bar counts as broken. One of `N` bars leaves `sin a/(2 p (2 pi - a))`
    /// of the current, `a = 2 pi p/N` (Deleroi): with two pole pairs 1.9 % of 28 bars and 1.3 % of 40, a quarter more of
    /// the active part. An intact cage leaves some tenths of a per cent.
    pub const BROKEN: f32 = 0.0125;
    /// Least active current, as a share of the rated current: below it the cage carries too little to show anything.
    pub const LEAST_ACTIVE: f32 = 0.2;
    /// Slip beyond which nothing is tested: the motor is starting, and the sidebands lie too far from the supply's frequency.
    pub const LARGEST_SLIP: f32 = 0.13;

    /// Over what counts as broken; NaN where something else shook the current.
    pub fn normalised(&self) -> f32 {
        let share = self.lower / Self::BROKEN;
        if self.dominate || share < 1.0 {
            share
        } else {
            f32::NAN
        }
    }
}

/// The cage as one report shows it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RotorReading {
    /// What the block says that this window ended; blocks are whole turns of twice the slip angle, one to some seconds.
    pub sidebands: Option<Sidebands>,
    /// Bars count as broken: block after block they said so.
    pub is_broken: bool,
}

/// Sums over the open block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotorState {
    /// Unit vector at twice the slip angle.
    axis: Complex32,
    turned: f32,
    cycles: f32,
    axes: Complex32,
    current: Complex32,
    lower: Complex32,
    upper: Complex32,
    square: f32,
}

impl Default for RotorState {
    fn default() -> Self {
        RotorState {
            axis: Complex32::ONE,
            turned: 0.0,
            cycles: 0.0,
            axes: Complex32::ZERO,
            current: Complex32::ZERO,
            lower: Complex32::ZERO,
            upper: Complex32::ZERO,
            square: 0.0,
        }
    }
}

impl RotorState {
    /// Takes one cycle: the current `i` of it and the one before seen from the voltage, A, and the `step` of twice the slip angle since the cycle
    /// before, rad. The last cycle of a block gives its sidebands.
    #[inline(never)]
    pub fn follow(&mut self, i: Complex32, step: f32) -> Option<Sidebands> {
        if step.is_nan() || step.abs() >= LARGEST_STEP {
            *self = RotorState::default();
            return None;
        }
        self.add(i);
        self.axis *= small_rotation(step);
        renormalise(&mut self.axis);
        self.turned += step;
        if self.turned.abs() < TURNS * TAU {
            return None;
        }
        let sidebands = self.sidebands();
        *self = RotorState::default();
        Some(sidebands)
    }

    fn add(&mut self, i: Complex32) {
        self.cycles += 1.0;
        self.axes += self.axis;
        self.current += i;
        self.lower += i * self.axis;
        self.upper += i * self.axis.conj();
        self.square += i.norm_sqr();
    }

    /// Covariances of the current with both turns: the mean of the current falls out, however the last turn ended.
    fn sidebands(&self) -> Sidebands {
        let share = 1.0 / self.cycles;
        let mean = self.current * share;
        let lower = (self.lower - mean * self.axes) * share;
        let upper = (self.upper - mean * self.axes.conj()) * share;
        let unrest = self.square * share - mean.norm_sqr();
        let explained = lower.norm_sqr() + upper.norm_sqr();
        // The mean of two cycles of a turn is short by `sin(x)/x cos(x)`, `x` half a step: to second order.
        let step = self.turned * share;
        let per_active = (1.0 + step * step / 6.0) / mean.re.abs();
        Sidebands {
            lower: libm::sqrtf(lower.norm_sqr()) * per_active,
            upper: libm::sqrtf(upper.norm_sqr()) * per_active,
            dominate: explained > EXPLAINED * unrest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(block: &Sidebands) -> bool {
        block.normalised() >= 1.0
    }

    /// Blocks of a current of 5 - 3j A that turns as `shape` says; 0.25 rad a cycle are 2 % slip.
    fn blocks(cycles: usize, shape: impl Fn(f32) -> Complex32) -> Vec<Sidebands> {
        const STEP: f32 = 0.25;
        let mut state = RotorState::default();
        // The mean over two cycles, as the window gives it, by eight points of it.
        let mean = |k: usize| {
            let angles = (0..8).map(|n| STEP * (k as f32 + (n as f32 - 3.5) / 4.0));
            angles.map(&shape).sum::<Complex32>() / 8.0
        };
        let currents = (0..cycles).map(|k| Complex32::new(5.0, -3.0) + mean(k));
        currents.filter_map(|i| state.follow(i, STEP)).collect()
    }

    /// Blocks end up to a step late, where lower and upper are no longer quite orthogonal: one part in a hundred.
    #[test]
    fn both_sidebands_are_measured() {
        let found = blocks(1000, |angle| {
            Complex32::from_polar(0.25, 1.0 - angle) + Complex32::from_polar(0.1, angle - 0.4)
        });
        assert_eq!(found.len(), 9);
        for block in found {
            assert!((block.lower - 0.05).abs() < 1e-3, "{block:?}");
            assert!((block.upper - 0.02).abs() < 1e-3, "{block:?}");
            assert!(block.dominate && (block.normalised() - 4.0).abs() < 0.08);
        }
    }

    #[test]
    fn a_steady_current_has_none() {
        for block in blocks(1000, |_| Complex32::ZERO) {
            assert!(block.normalised() < 0.01, "{block:?}");
        }
    }

    #[test]
    fn a_pulsation_at_another_frequency_is_not_taken_for_bars() {
        for ratio in [0.5, 1.5, 2.0, 3.3, 12.3] {
            for block in blocks(2000, |angle| {
                Complex32::new(0.5 * (ratio * angle).cos(), 0.0)
            }) {
                assert!(!counts(&block), "{ratio}: {block:?}");
            }
        }
    }

    #[test]
    fn a_load_step_anywhere_in_a_block_is_not_taken_for_bars() {
        for at in 0..110 {
            let step =
                |angle: f32| Complex32::new(if angle < 0.25 * at as f32 { 0.0 } else { 3.0 }, 0.0);
            for block in blocks(240, step) {
                assert!(!counts(&block), "{at}: {block:?}");
            }
        }
    }

    #[test]
    fn a_start_begins_anew_and_no_slip_never_ends() {
        let mut state = RotorState::default();
        for _ in 0..90 {
            assert_eq!(state.follow(Complex32::ONE, 0.25), None);
        }
        for step in [2.0, -2.0, f32::NAN] {
            assert_eq!(state.follow(Complex32::ONE, step), None);
            assert_eq!(state, RotorState::default());
        }
        assert!((0..100_000).all(|_| state.follow(Complex32::ONE, 0.0).is_none()));
    }

    #[test]
    fn a_generator_shows_them_too() {
        let mut state = RotorState::default();
        let angle = |k: u32| -0.25 * k as f32;
        let current = |k| Complex32::new(-5.0, -3.0) + Complex32::from_polar(0.25, -angle(k));
        let found = (0..200)
            .find_map(|k| state.follow(current(k), -0.25))
            .expect("a block");
        assert!((found.lower - 0.05).abs() < 1e-3, "{found:?}");
    }
}
