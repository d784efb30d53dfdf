//! Broken rotor bars: the sidebands that they leave in the current at twice the slip frequency.
//!
//! An asymmetric cage answers the rotor's field with a second one that turns backwards against the rotor. Seen from the
//! stator it turns at `(1 - 2 s)` times the supply's frequency; the torque that it swings sets the speed swinging, which
//! adds its mirror at `(1 + 2 s)` (Deleroi 1984; Filippetti et al., IEEE Trans. Ind. Appl. 34 (1998) 98,
//! doi:10.1109/28.658729). Seen from the voltage both are turns at plus and minus `2 s omega`, whose angle is known: supply
//! and shaft are measured. So whole turns of that angle are summed up, over which all else cancels; turns at other
//! frequencies of the same block tell how restless the current is beside them.

use core::f32::consts::TAU;

use num_complex::Complex32;

use crate::checks::speed_swing::Driven;
use pll::{renormalise, small_rotation};

/// Turns of twice the slip angle in one block: load steps and other pulsations cancel the better, the more there are.
const TURNS: f32 = 4.0;
/// Largest step of twice the slip angle from one cycle to the next, rad.
const LARGEST_STEP: f32 = 2.0 * TAU * Sidebands::LARGEST_SLIP;
/// Lines of a block beside the lower sideband, in turns of the block, and the sideband itself: turns of the block are
/// orthogonal to each other.
const LINES: usize = 5;
/// Place of the sideband among them; the others are two and one turn to each side of it.
const SIDEBAND: usize = 2;
/// Times the lines beside it that a sideband must be. Noise that is alike in all five lines passes in `(1 + 3^2/4)^-4`, nine in
/// a thousand blocks (a line's power over the mean of four others is distributed as F with 2 and 8 degrees of freedom),
/// and in a row of three blocks, which FAULT takes, in 7 of ten million; and it must pass the limit as well. A step of the
/// load stays below 1.3 times. A swing passes within 9 % of twice the slip frequency: so well must the slip be known.
const CLEAR: f32 = 3.0;
/// Largest sideband of a cage, share of the active current: what a third of the bars of a small cage would leave. A press whose
/// strokes come at twice the slip frequency leaves more.
const LARGEST: f32 = 0.2;

/// Times what a swing of the speed explains at the lower sideband that the cage's own share must be. A swinging load alone leaves nothing of its
/// own there, and less than this where the circuit is 15 to 20 % wrong (`tests/behaviour/rotor_unrest.rs`); broken bars about twice at least: of a shaft without inertia, whose speed they swing the
/// most, the torques of both lines cancel, so that the speed takes half of what the cage leaves. Between them nothing is said.
const OWN: f32 = 1.0;

/// What one block of whole turns says about the cage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sidebands {
    /// Amplitude at `(1 - 2 s)` times the supply's frequency, as a share of the active current.
    pub lower: f32,
    /// Amplitude at `(1 + 2 s)` times the supply's frequency, as a share of the active current.
    pub upper: f32,
    /// What the swing of the speed that the upper one shows leaves at the lower one, as a share of the active current.
    pub from_speed: f32,
    /// The lower one without that, as a share of the active current: the cage's own.
    pub from_cage: f32,
    /// Root mean square of the lines beside the lower sideband, as a share of the active current: the motor's own unrest.
    pub beside: f32,
    /// Active current, A; negative in a generator.
    pub active: f32,
}

impl Sidebands {
    /// Least active current, as a share of the rated current: below it the cage carries too little to show anything.
    pub const LEAST_ACTIVE: f32 = 0.2;
    /// Slip beyond which nothing is tested: the motor is starting, and the sidebands lie too far from the supply's frequency.
    pub const LARGEST_SLIP: f32 = 0.13;

    /// Whether the lower sideband stands clear of the lines beside it, so that what it shows is at twice the slip frequency, is no
    /// larger than a cage can leave, and no swing of the speed explains it.
    pub fn may_be_bars(&self) -> bool {
        self.is_clear() && self.lower < LARGEST && self.is_of_the_cage()
    }

    /// Whether the lower sideband stands clear and is that of a speed that swings, as a load makes it: what the cage leaves beside it cannot
    /// be told.
    pub fn is_swing(&self) -> bool {
        self.is_clear() && !self.is_of_the_cage()
    }

    fn is_clear(&self) -> bool {
        self.lower > CLEAR * self.beside
    }

    /// Not where either is unknown (NaN).
    fn is_of_the_cage(&self) -> bool {
        self.from_cage > OWN * self.from_speed
    }
}

/// Sums over the open block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotorState {
    /// Unit vector at a quarter of twice the slip angle: one turn a block.
    axis: Complex32,
    turned: f32,
    cycles: f32,
    current: Complex32,
    /// Sums of the axes of the lines, and of the current times them.
    axes: [Complex32; LINES],
    lower: [Complex32; LINES],
    upper: Complex32,
}

impl Default for RotorState {
    fn default() -> Self {
        RotorState {
            axis: Complex32::ONE,
            turned: 0.0,
            cycles: 0.0,
            current: Complex32::ZERO,
            axes: [Complex32::ZERO; LINES],
            lower: [Complex32::ZERO; LINES],
            upper: Complex32::ZERO,
        }
    }
}

impl RotorState {
    /// Takes one cycle: the current `i` of it and the one before seen from the voltage, A, and the `step` of twice the slip angle since the cycle
    /// before, rad. The last cycle of a block gives its sidebands, of a motor that is `driven` so.
    #[inline(never)]
    pub fn follow(&mut self, i: Complex32, step: f32, driven: &Driven<'_>) -> Option<Sidebands> {
        if step.is_nan() || step.abs() >= LARGEST_STEP {
            *self = RotorState::default();
            return None;
        }
        self.add(i);
        self.axis *= small_rotation(step / TURNS);
        renormalise(&mut self.axis);
        self.turned += step;
        if self.turned.abs() < TURNS * TAU {
            return None;
        }
        let sidebands = self.sidebands(driven);
        *self = RotorState::default();
        Some(sidebands)
    }

    fn add(&mut self, i: Complex32) {
        let two = self.axis * self.axis;
        let three = two * self.axis;
        let lines = [two, three, two * two, two * three, three * three];
        self.cycles += 1.0;
        self.current += i;
        for ((line, axes), lower) in lines.iter().zip(&mut self.axes).zip(&mut self.lower) {
            *axes += line;
            *lower += i * line;
        }
        self.upper += i * lines[SIDEBAND].conj();
    }

    /// Covariances of the current with the turns: the mean of the current falls out, however the last turn ended.
    fn sidebands(&self, driven: &Driven<'_>) -> Sidebands {
        let share = 1.0 / self.cycles;
        let mean = self.current * share;
        let mut lines = [Complex32::ZERO; LINES];
        for ((line, lower), axes) in lines.iter_mut().zip(self.lower).zip(self.axes) {
            *line = (lower - mean * axes) * share;
        }
        let lower = lines[SIDEBAND];
        let upper = (self.upper - mean * self.axes[SIDEBAND].conj()) * share;
        let all: f32 = lines.iter().map(Complex32::norm_sqr).sum();
        let beside = all - lower.norm_sqr();
        let step = self.turned * share;
        // A cycle turns the supply once, and the axis by twice the slip.
        let from_speed = driven.mirrored(upper, mean, step / (2.0 * TAU));
        // The mean of two cycles of a turn is short by `sin(x)/x cos(x)`, `x` half a step: to second order.
        let per_active = (1.0 + step * step / 6.0) / mean.re.abs();
        let amplitude = |square: f32| processor::sqrtf(square.max(0.0)) * per_active;
        Sidebands {
            lower: amplitude(lower.norm_sqr()),
            upper: amplitude(upper.norm_sqr()),
            from_speed: amplitude(from_speed.norm_sqr()),
            from_cage: amplitude((lower - from_speed).norm_sqr()),
            beside: amplitude(beside / (LINES - 1) as f32),
            active: mean.re,
        }
    }
}

#[cfg(test)]
mod tests {
    use motor::TParams;

    use super::*;
    use crate::checks::cage::Cage;

    /// At a slip of 2 % some motor that takes 5 - 3j A.
    const MOTOR: Driven<'_> = Driven {
        params: &TParams {
            r_s: 2.0,
            r_r: 1.2,
            l_ls: 0.011,
            l_lr: 0.011,
            l_m: 0.3,
        },
        voltage: 325.0,
        omega_sync: 50.0 * TAU,
    };

    fn normalised(block: &Sidebands) -> f32 {
        Cage::UNKNOWN.limits(1.0, 2.0).normalised(block)
    }

    fn counts(block: &Sidebands) -> bool {
        normalised(block) >= 1.0
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
        currents
            .filter_map(|i| state.follow(i, STEP, &MOTOR))
            .collect()
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
            assert!(block.may_be_bars() && (normalised(&block) - 4.0).abs() < 0.08);
        }
    }

    #[test]
    fn a_steady_current_has_none() {
        for block in blocks(1000, |_| Complex32::ZERO) {
            assert!(normalised(&block) < 0.01, "{block:?}");
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

    /// A press of the same rhythm swings the current by tens of per cent; a cage with a third of its bars broken does not.
    #[test]
    fn a_line_that_no_cage_leaves_is_not_taken_for_bars() {
        let of_a_cage = |share: f32| {
            blocks(1000, move |angle| {
                Complex32::from_polar(5.0 * share, 0.3 - angle)
            })
        };
        for block in of_a_cage(0.3) {
            assert!(block.lower > 0.25 && !counts(&block), "{block:?}");
        }
        for block in of_a_cage(0.15) {
            assert!(counts(&block), "{block:?}");
        }
    }

    /// A line above that stands at the mirror image of the one below, as far as ends of blocks between cycles let tell.
    #[test]
    fn a_swing_of_the_speed_is_not_taken_for_bars() {
        let (mean, slip) = (Complex32::new(5.0, -3.0), 0.25 / (2.0 * TAU));
        for phase in [0.0, 1.0, 2.0, 4.0] {
            let upper = Complex32::from_polar(0.3, phase);
            let lower = MOTOR.mirrored(upper, mean, slip);
            for block in blocks(1000, |angle| {
                let turned = Complex32::from_polar(1.0, angle);
                upper * turned + lower * turned.conj()
            }) {
                assert!(block.lower > 0.05 && !counts(&block), "{block:?}");
                assert!(block.from_cage < 0.1 * block.from_speed, "{block:?}");
            }
        }
    }

    /// A motor without a voltage or a flux has no twin of a line; bars are not claimed of it.
    #[test]
    fn what_the_speed_leaves_must_be_known() {
        let block = Sidebands {
            lower: 0.05,
            upper: 0.02,
            from_speed: f32::NAN,
            from_cage: f32::NAN,
            beside: 0.001,
            active: 5.0,
        };
        assert!(!block.may_be_bars() && !counts(&block));
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
            assert_eq!(state.follow(Complex32::ONE, 0.25, &MOTOR), None);
        }
        for step in [2.0, -2.0, f32::NAN] {
            assert_eq!(state.follow(Complex32::ONE, step, &MOTOR), None);
            assert_eq!(state, RotorState::default());
        }
        assert!((0..100_000).all(|_| state.follow(Complex32::ONE, 0.0, &MOTOR).is_none()));
    }

    #[test]
    fn a_generator_shows_them_too() {
        let mut state = RotorState::default();
        let angle = |k: u32| -0.25 * k as f32;
        let current = |k| Complex32::new(-5.0, -3.0) + Complex32::from_polar(0.25, -angle(k));
        let found = (0..200)
            .find_map(|k| state.follow(current(k), -0.25, &MOTOR))
            .expect("a block");
        assert!((found.lower - 0.05).abs() < 1e-3, "{found:?}");
    }
}
