//! Supply synchronisation: the angle and frequency of phase a from its rising zero crossings.
//!
//! The paper's instrument does the same (its third stage). A crossing is interpolated between
//! samples; a second-order tracking loop steers an oscillator whose phase never jumps while locked,
//! so that windows cut at its turns hold whole cycles.

use core::f32::consts::{PI, TAU};

use num_complex::Complex32;

use crate::intake::{PEAK_DECAY_PER_SECOND, higher};
use crate::rotation::{renormalise, small_rotation};

/// Limits and gains of the synchronisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SyncConfig {
    /// Sampling time, s.
    pub t_sample: f32,
    /// Lowest frequency that locks, rad/s.
    pub omega_min: f32,
    /// Highest frequency that locks, rad/s.
    pub omega_max: f32,
    /// Smallest amplitude that counts as a supply, V (or A when currents are the reference).
    pub min_amplitude: f32,
}

/// Phase error, rad, beyond which a crossing does not belong to the tracked oscillation. It must admit
/// what a fault itself moves: a lost phase turns the reference by 0.33 rad, shorted turns in a motor whose
/// currents carry 20 % harmonics move a crossing of the current by as much again.
const CAPTURE_RANGE: f32 = 0.8;
/// Share of a phase error that the next cycle takes back.
const PHASE_GAIN: f32 = 0.4;
/// Share of a phase error that is put down to the frequency: critically damped with `PHASE_GAIN`.
const FREQUENCY_GAIN: f32 = 0.06;
/// Consecutive good crossings before the lock is declared.
const LOCK_AFTER: u8 = 3;
/// Turns without a usable crossing that the oscillator bridges before the lock is given up.
const HOLDOVER_TURNS: u8 = 3;
/// A new crossing is accepted only after the signal was below this share of its amplitude.
const ARM_SHARE: f32 = 0.3;
/// Two periods this close to each other (share) start the tracking.
const ACQUIRE_SPREAD: f32 = 0.1;

/// What the synchronisation knows between two samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SyncState {
    previous: f32,
    peak: f32,
    armed: bool,
    since_crossing: f32,
    last_period: f32,
    /// Tracked frequency, rad/s.
    omega: f32,
    /// Frequency at which the oscillator runs in this turn, rad/s.
    omega_oscillator: f32,
    theta: f32,
    axis: Complex32,
    step: Complex32,
    mode: Mode,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Searching,
    Tracking { good: u8, missed: u8 },
}

/// The oscillator at one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SyncTick {
    /// Oscillator axis `e^{j theta}`; the phase-a fundamental is `Re(X axis)` with a slowly moving `X`.
    pub axis: Complex32,
    /// Oscillator frequency, rad/s.
    pub omega: f32,
    /// Set when the oscillator completes a turn before the next sample: the share of this sample's
    /// interval that still belongs to the old turn, in (0, 1].
    pub turn_ends: Option<f32>,
    /// The oscillator was set to a new phase; whatever was collected before does not fit to it.
    pub restarted: bool,
}

impl Default for SyncState {
    fn default() -> Self {
        SyncState {
            previous: 0.0,
            peak: 0.0,
            armed: false,
            since_crossing: 0.0,
            last_period: 0.0,
            omega: 0.0,
            omega_oscillator: 0.0,
            theta: 0.0,
            axis: Complex32::ONE,
            step: Complex32::ONE,
            mode: Mode::Searching,
        }
    }
}

impl SyncState {
    /// Whether the oscillator follows the supply; nothing may be judged without it.
    pub fn is_locked(&self) -> bool {
        matches!(self.mode, Mode::Tracking { good, missed } if good >= LOCK_AFTER && missed <= HOLDOVER_TURNS)
    }

    /// Whether the oscillator is still to be set to the supply's phase.
    #[inline]
    pub fn is_searching(&self) -> bool {
        self.mode == Mode::Searching
    }

    /// Tracked supply frequency, rad/s; 0 while nothing is tracked.
    pub fn omega(&self) -> f32 {
        match self.mode {
            Mode::Searching => 0.0,
            Mode::Tracking { .. } => self.omega,
        }
    }

    /// Angle of the phase-a zero crossing oscillator in [-pi, pi), rad; 0 at a rising crossing.
    pub fn theta(&self) -> f32 {
        if self.theta >= PI {
            self.theta - TAU
        } else {
            self.theta
        }
    }
}

impl SyncConfig {
    /// Takes one sample of the reference channel (phase a) and advances the oscillator by one sample.
    #[inline(always)]
    pub fn update(&self, state: &mut SyncState, reference: f32) -> SyncTick {
        let crossing = self.detect_crossing(state, reference);
        let restarted = crossing.is_some_and(|fraction| self.take_crossing(state, fraction));
        self.give_up_when_silent(state);
        self.advance(state, restarted)
    }

    /// The share of a sample interval that has passed since a rising crossing, if there was one.
    #[inline(always)]
    fn detect_crossing(&self, state: &mut SyncState, x: f32) -> Option<f32> {
        let keep = 1.0 - PEAK_DECAY_PER_SECOND * self.t_sample;
        state.peak = higher(state.peak * keep, x.abs());
        state.since_crossing += 1.0;
        let previous = core::mem::replace(&mut state.previous, x);
        if x < 0.0 {
            state.armed |= x < -ARM_SHARE * state.peak && state.peak > self.min_amplitude;
            return None;
        }
        if !state.armed || previous >= 0.0 {
            return None;
        }
        state.armed = false;
        Some(x / (x - previous))
    }

    /// Feeds a crossing `fraction` samples ago into the loop; true when the oscillator was set anew.
    #[inline(never)]
    fn take_crossing(&self, state: &mut SyncState, fraction: f32) -> bool {
        let period = state.since_crossing - fraction;
        state.since_crossing = fraction;
        let previous_period = core::mem::replace(&mut state.last_period, period);
        match state.mode {
            Mode::Searching => self.acquire(state, period, previous_period, fraction),
            Mode::Tracking { .. } => {
                self.track(state, fraction);
                false
            }
        }
    }

    fn acquire(&self, state: &mut SyncState, period: f32, previous: f32, fraction: f32) -> bool {
        let omega = TAU / (period * self.t_sample);
        let in_range = omega >= self.omega_min && omega <= self.omega_max;
        let steady = (period - previous).abs() < ACQUIRE_SPREAD * period;
        if !(in_range && steady) {
            return false;
        }
        state.omega = omega;
        state.theta = fraction * omega * self.t_sample;
        state.axis = small_rotation(state.theta);
        state.mode = Mode::Tracking { good: 1, missed: 0 };
        self.set_oscillator(state, omega);
        true
    }

    fn track(&self, state: &mut SyncState, fraction: f32) {
        let Mode::Tracking { good, .. } = state.mode else {
            return;
        };
        let at_crossing = state.theta - fraction * state.omega_oscillator * self.t_sample;
        let error = if at_crossing > PI {
            at_crossing - TAU
        } else {
            at_crossing
        };
        if error.abs() > CAPTURE_RANGE {
            return;
        }
        let turn = TAU / state.omega;
        let omega = state.omega - FREQUENCY_GAIN * error / turn;
        // Not `clamp`: it panics when the limits are the wrong way round.
        state.omega = omega.max(self.omega_min).min(self.omega_max);
        state.mode = Mode::Tracking {
            good: good.saturating_add(1),
            missed: 0,
        };
        self.set_oscillator(state, state.omega - PHASE_GAIN * error / turn);
    }

    fn set_oscillator(&self, state: &mut SyncState, omega: f32) {
        state.omega_oscillator = omega;
        state.step = small_rotation(omega * self.t_sample);
    }

    #[inline(always)]
    fn give_up_when_silent(&self, state: &mut SyncState) {
        let lost = matches!(state.mode, Mode::Tracking { missed, .. } if missed > HOLDOVER_TURNS);
        if lost || state.peak < self.min_amplitude {
            state.mode = Mode::Searching;
        }
    }

    #[inline(always)]
    fn advance(&self, state: &mut SyncState, restarted: bool) -> SyncTick {
        let d_theta = state.omega_oscillator * self.t_sample;
        let tick_axis = state.axis;
        let turn_ends = self.step_theta(state, d_theta);
        state.axis *= state.step;
        SyncTick {
            axis: tick_axis,
            omega: state.omega_oscillator,
            turn_ends,
            restarted,
        }
    }

    #[inline(always)]
    fn step_theta(&self, state: &mut SyncState, d_theta: f32) -> Option<f32> {
        let Mode::Tracking { good, missed } = state.mode else {
            return None;
        };
        let next = state.theta + d_theta;
        if next < TAU {
            state.theta = next;
            return None;
        }
        let remaining = TAU - state.theta;
        state.theta = next - TAU;
        state.mode = Mode::Tracking {
            good,
            missed: missed.saturating_add(1),
        };
        renormalise(&mut state.axis);
        Some((remaining / d_theta).clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    const T_SAMPLE: f32 = 1e-4;

    fn config() -> SyncConfig {
        SyncConfig {
            t_sample: T_SAMPLE,
            omega_min: TAU * 4.5,
            omega_max: TAU * 110.0,
            min_amplitude: 10.0,
        }
    }

    /// A supply as the issue describes it: harmonics in per cent of the fundamental, uniform noise.
    struct Supply {
        hertz: f64,
        fifth: f64,
        seventh: f64,
        noise: f64,
    }

    impl Supply {
        const CLEAN: Supply = Supply {
            hertz: 50.0,
            fifth: 0.0,
            seventh: 0.0,
            noise: 0.0,
        };

        fn at(&self, k: u64, rng: &mut Pcg64Mcg) -> f32 {
            let x = core::f64::consts::TAU * self.hertz * k as f64 * 1e-4 + 1.0;
            let clean = x.sin() + self.fifth * (5.0 * x).sin() + self.seventh * (7.0 * x).sin();
            (325.0 * (clean + self.noise * rng.random_range(-1.0..1.0))) as f32
        }
    }

    fn run(
        supply: &Supply,
        samples: u64,
        mut each: impl FnMut(u64, &SyncState, &SyncTick),
    ) -> SyncState {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let mut state = SyncState::default();
        for k in 0..samples {
            let tick = config().update(&mut state, supply.at(k, &mut rng));
            each(k, &state, &tick);
        }
        state
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        /// 5..100 Hz with 8 % harmonics and 1 % noise lock within eight cycles and hold the frequency.
        #[test]
        fn locks_and_holds_the_frequency(hertz in 5.0f64..100.0, fifth in -0.06f64..0.06, seventh in -0.06f64..0.06) {
            prop_assume!(fifth.hypot(seventh) <= 0.08);
            let supply = Supply { hertz, fifth, seventh, noise: 0.01 };
            let eight_cycles = (8.0 / hertz / 1e-4) as u64;
            let mut turns = 0;
            let mut locked_throughout = true;
            let forty_cycles = 5 * eight_cycles;
            run(&supply, forty_cycles, |k, state, tick| {
                if k > eight_cycles {
                    locked_throughout &= state.is_locked();
                    turns += u32::from(tick.turn_ends.is_some());
                }
            });
            prop_assert!(locked_throughout);
            // 32 cycles remain; the count may miss one at either end.
            prop_assert!((31..=33).contains(&turns), "{turns} turns");
        }
    }

    #[test]
    fn a_clean_supply_gives_its_angle() {
        let mut worst = 0.0_f32;
        run(&Supply::CLEAN, 5000, |k, state, _| {
            if k > 2000 {
                // theta() is the angle at the next sample, because the tick has advanced it.
                let truth = core::f64::consts::TAU * 50.0 * (k + 1) as f64 * 1e-4 + 1.0;
                let error = (f64::from(state.theta()) - truth) / core::f64::consts::TAU;
                worst = worst.max(((error - error.round()) * core::f64::consts::TAU) as f32);
            }
        });
        // Linear interpolation of a sine over 0.031 rad errs by its cube over 6 * 9 sqrt(3): 4e-7; f32 adds 1e-5.
        assert!(worst < 5e-5, "{worst}");
    }

    #[test]
    fn a_dropout_of_two_cycles_is_bridged_and_a_longer_one_is_told() {
        for (dropout_samples, stays) in [(400_u64, true), (1400, false)] {
            let mut rng = Pcg64Mcg::seed_from_u64(1);
            let mut state = SyncState::default();
            let mut always = true;
            for k in 0..8000 {
                let out = (4000..4000 + dropout_samples).contains(&k);
                let x = if out {
                    0.0
                } else {
                    Supply::CLEAN.at(k, &mut rng)
                };
                config().update(&mut state, x);
                always &= k < 1500 || state.is_locked();
            }
            assert_eq!(always, stays, "dropout of {dropout_samples} samples");
            assert!(state.is_locked(), "locks again");
        }
    }

    #[test]
    fn noise_without_a_supply_never_locks() {
        let mut rng = Pcg64Mcg::seed_from_u64(3);
        let mut state = SyncState::default();
        for _ in 0..100_000 {
            config().update(&mut state, rng.random_range(-9.0..9.0));
            assert!(!state.is_locked());
        }
    }

    #[test]
    fn a_frequency_step_is_followed() {
        let mut rng = Pcg64Mcg::seed_from_u64(3);
        let mut state = SyncState::default();
        let mut phase = 0.0_f64;
        for k in 0..20_000 {
            phase += core::f64::consts::TAU * if k < 5000 { 50.0 } else { 51.0 } * 1e-4;
            let x = 325.0 * (phase.sin() + 0.002 * rng.random_range(-1.0..1.0));
            config().update(&mut state, x as f32);
        }
        assert!(state.is_locked());
        // Crossing jitter 0.002 rad times FREQUENCY_GAIN 0.06 per turn of 6.28 rad, three sigma: 6e-5.
        assert!((state.omega() / (TAU * 51.0) - 1.0).abs() < 1e-4);
    }

    fn sine(hertz: f64, amplitude: f64) -> impl Fn(u64) -> f32 {
        move |k| (amplitude * (core::f64::consts::TAU * hertz * k as f64 * 1e-4 - 1.0).sin()) as f32
    }

    /// The state after so many samples.
    fn fed(config: &SyncConfig, samples: u64, x: impl Fn(u64) -> f32) -> SyncState {
        let mut state = SyncState::default();
        for k in 0..samples {
            config.update(&mut state, x(k));
        }
        state
    }

    #[test]
    fn frequencies_outside_the_range_are_never_followed() {
        for (hertz, follows) in [(4.0, false), (5.0, true), (100.0, true), (115.0, false)] {
            let state = fed(&config(), 30_000, sine(hertz, 325.0));
            assert_eq!(state.is_locked(), follows, "{hertz} Hz");
            assert_eq!(state.is_searching(), !follows, "{hertz} Hz");
            let omega = if follows { TAU * hertz as f32 } else { 0.0 };
            assert!(
                (state.omega() - omega).abs() < 1e-3 * TAU * 5.0,
                "{hertz} Hz: {}",
                state.omega()
            );
        }
    }

    #[test]
    fn an_amplitude_below_the_least_is_no_supply() {
        assert!(fed(&config(), 5000, sine(50.0, 10.5)).is_locked());
        assert!(fed(&config(), 5000, sine(50.0, 9.5)).is_searching());
    }

    /// Peaks are forgotten at 5 per second: from 325 V to 10 V in ln(32.5)/5 = 0.70 s.
    #[test]
    fn a_supply_that_fades_is_given_up() {
        let mut state = fed(&config(), 5000, sine(50.0, 325.0));
        let mut silent = 0;
        while !state.is_searching() {
            config().update(&mut state, 0.0);
            silent += 1;
        }
        // Four turns without a crossing come first, 80 ms.
        assert!((600..1100).contains(&silent), "{silent}");
        // A supply without crossings, a constant, is not bridged either: its peak stays, its turns do not come.
        let mut state = fed(&config(), 5000, sine(50.0, 325.0));
        for _ in 0..1100 {
            config().update(&mut state, 325.0);
        }
        assert!(state.is_searching() && state.omega() == 0.0);
    }

    /// Periods that differ by a fifth are no oscillation to follow.
    #[test]
    fn unsteady_periods_are_not_acquired() {
        let mut state = SyncState::default();
        let mut phase = 0.0_f64;
        let mut samples = 0;
        for turn in 0..60 {
            let hertz = if turn % 2 == 0 { 45.0 } else { 56.0 };
            while phase < core::f64::consts::TAU * f64::from(turn + 1) {
                config().update(&mut state, (325.0 * phase.sin()) as f32);
                phase += core::f64::consts::TAU * hertz * 1e-4;
                samples += 1;
            }
        }
        assert!(samples > 10_000 && state.is_searching());
    }

    /// Between two turns lies one period: the samples between them, and the share of a sample at either end.
    #[test]
    fn turns_end_where_the_angle_does() {
        let hertz = 47.3;
        let mut last: Option<f64> = None;
        let mut state = SyncState::default();
        let mut turns = 0;
        for k in 0..20_000_u64 {
            let tick = config().update(&mut state, sine(hertz, 325.0)(k));
            assert!((tick.axis.norm() - 1.0).abs() < 1e-5, "{k}");
            if k > 6000 {
                // The axis is the oscillator's angle, zero at a rising crossing.
                let truth = core::f64::consts::TAU * hertz * k as f64 * 1e-4 - 1.0;
                let off = tick.axis
                    * Complex32::from_polar(1.0, -(truth % core::f64::consts::TAU) as f32);
                assert!(off.im.abs() < 1e-3 && off.re > 0.9, "{k}: {off}");
                assert!((tick.omega / (TAU * hertz as f32) - 1.0).abs() < 1e-4);
                assert!(!tick.restarted);
                assert!((-PI..PI).contains(&state.theta()));
            }
            if let Some(share) = tick.turn_ends {
                assert!(share > 0.0 && share <= 1.0);
                let now = k as f64 + f64::from(share);
                if let (Some(before), true) = (last, k > 6000) {
                    assert!(
                        (now - before - 1e4 / hertz).abs() < 0.02,
                        "{}",
                        now - before
                    );
                    turns += 1;
                }
                last = Some(now);
            }
        }
        assert!((65..=67).contains(&turns), "{turns}");
    }

    /// A phase that jumps by more than the oscillator captures is found anew, and told.
    #[test]
    fn a_large_jump_of_the_phase_restarts_the_oscillator() {
        for (jump, restarts) in [(0.5, 0), (1.6, 1)] {
            let mut state = fed(&config(), 5000, sine(50.0, 325.0));
            let mut seen = 0;
            for k in 5000..12_000_u64 {
                let x =
                    325.0 * (core::f64::consts::TAU * 50.0 * k as f64 * 1e-4 - 1.0 + jump).sin();
                seen += u32::from(config().update(&mut state, x as f32).restarted);
            }
            assert!(state.is_locked());
            assert_eq!(seen, restarts, "jump of {jump} rad");
        }
    }

    /// At 50 Hz and 10 kHz every hundredth sample may be exactly zero.
    #[test]
    fn a_sample_on_the_crossing_is_a_crossing() {
        let x = |k: u64| match k % 200 {
            0 | 100 => 0.0,
            k => (325.0 * (core::f64::consts::TAU * k as f64 / 200.0).sin()) as f32,
        };
        let state = fed(&config(), 3000, x);
        assert!(state.is_locked());
        assert!((state.omega() / (TAU * 50.0) - 1.0).abs() < 1e-5);
        // After sample 2999 the next one is the crossing.
        assert!(state.theta().abs() < 1e-3, "{}", state.theta());
    }
}
