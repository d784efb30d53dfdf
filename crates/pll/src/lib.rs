//! Supply synchronisation: the angle and frequency of phase a from its rising zero crossings.
//!
//! The paper's instrument does the same (its third stage). A crossing is interpolated between
//! samples; a second-order tracking loop steers an oscillator whose phase never jumps while locked,
//! so that windows cut at its turns hold whole cycles.

#![cfg_attr(not(test), no_std)]

mod rotation;

pub use rotation::{arcsine, renormalise, small_rotation};

use core::f32::consts::{PI, TAU};

use num_complex::Complex32;
use processor::higher;

/// Share of a peak that is forgotten per second.
pub const PEAK_DECAY_PER_SECOND: f32 = 5.0;

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
/// Good crossings that count at most, and how many of them a crossing outside the capture range takes back: three such in a row end
/// any lock. An oscillator that stays behind on a ramp of the frequency still meets a quarter of the crossings by chance.
const GOOD_AT_MOST: u8 = 12;
/// See [`GOOD_AT_MOST`].
const STRAY_TAKES: u8 = 4;
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

/// The supply's oscillator as others see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supply {
    /// Axis `e^{j theta}` of length 1.
    pub axis: Complex32,
    /// Frequency, rad/s.
    pub omega: f32,
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

    /// Axis of the oscillator at the next sample.
    pub fn axis(&self) -> Complex32 {
        self.axis
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
            if !state.armed {
                state.armed = x < -ARM_SHARE * state.peak && state.peak > self.min_amplitude;
            }
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
        let Mode::Tracking { good, missed } = state.mode else {
            return;
        };
        let at_crossing = state.theta - fraction * state.omega_oscillator * self.t_sample;
        let error = if at_crossing > PI {
            at_crossing - TAU
        } else {
            at_crossing
        };
        if error.abs() > CAPTURE_RANGE {
            state.mode = match good.saturating_sub(STRAY_TAKES) {
                0 => Mode::Searching,
                good => Mode::Tracking { good, missed },
            };
            return;
        }
        let turn = TAU / state.omega;
        let omega = state.omega - FREQUENCY_GAIN * error / turn;
        // Not `clamp`: it panics when the limits are the wrong way round.
        state.omega = omega.max(self.omega_min).min(self.omega_max);
        state.mode = Mode::Tracking {
            good: (good + 1).min(GOOD_AT_MOST),
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
mod tests;
