//! How a window changes: what that leaves in doubt of the residuals, and whether the window may be judged.

use crate::model::effects::Corrected;
use crate::model::operating_point::{Frame, OperatingPoint};
use crate::model::residuals::RESIDUALS;
use crate::model::settled::settled;
use crate::monitor::Monitor;
use crate::noise::trend::{frequency_rate_noise, rate_noise};
use crate::rehearsal::Rehearsal;
use crate::window::{CycleNoise, RateNoise, Rates, Window};
use frames::magnitude;

/// Share of synchronous speed that voltages and currents of a running motor imply at the least: a braked one's imply none.
const LEAST_RUNNING: f32 = 0.5;
/// A window counts as steady when what is left of the derivative terms stays below this share of the threshold.
const STEADY_SHARE: f32 = 0.25;
/// Thresholds of r1 and r2 beyond which a window's steadiness is judged no more leniently: a constant field current or the
/// voltage frame makes them tens of per cent wide, and the evidence of a calibrated motor, which knows neither, stays as sharp.
const WIDEST: [f32; 2] = [0.02, 0.05];
/// Share of the derivative terms that stays in doubt: parameters and inertia are only roughly known.
pub(crate) const DERIVATIVE_DOUBT: f32 = 0.25;
/// A step in the middle of five cycles lies 0.4 to 0.5 of itself off the straight line.
const STEP_PER_BEND: f32 = 2.0;
/// Standard deviations of the noise within which a change does not count.
const NOISE_DEVIATIONS: f32 = 4.0;

/// How a window changes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Movement {
    /// What stays in doubt of the derivative terms in r1..r4.
    pub(crate) doubt: [f32; RESIDUALS],
    pub(crate) is_steady: bool,
    /// The shaft turns against the field, and voltages and currents agree.
    pub(crate) is_plugged: bool,
}

impl Monitor {
    /// Whether the shaft turns against the field and voltages and currents agree that it does: where they show the small
    /// slip of a running motor, it is the sign of the speed that is wrong.
    fn is_plugged(&self, rehearsal: &Rehearsal, window: &Window) -> bool {
        let against = window.omega_mech.is_some_and(|omega| omega < 0.0);
        let point = || self.operating_point(Frame::RotorFlux, rehearsal, window);
        against
            && point().is_some_and(|point| {
                let implied = self.model.implied_speed(&point);
                implied < LEAST_RUNNING * point.omega_sync
            })
    }

    /// How this window changes; `None` where there is no operating point.
    #[inline(never)]
    pub(crate) fn movement(&self, rehearsal: &Rehearsal, window: &Window) -> Option<Movement> {
        let point = self.operating_point(self.config.frame, rehearsal, window)?;
        let mut noise = window.cycle_noise(self.config.t_sample);
        noise.speed += self.speed_resolution(window);
        let doubt = self.doubt(rehearsal, window, &window.rates)?;
        let beyond = window.rates.beyond(&self.noise_of_rates(window, &noise));
        let [doubt_1, doubt_2, ..] = self.doubt(rehearsal, window, &beyond)?;
        let [r1, r2] = self.steady_within();
        let [bend_1, bend_2] = self.bend(window, &noise, &point);
        let is_steady = doubt_1 < r1 && doubt_2 < r2 && bend_1 < r1 && bend_2 < r2;
        Some(Movement {
            doubt,
            is_steady,
            is_plugged: self.is_plugged(rehearsal, window),
        })
    }

    /// What may be left of the derivative terms in r1 and r2 of a steady window.
    fn steady_within(&self) -> [f32; 2] {
        let [widest_1, widest_2] = WIDEST;
        let [r1, r2, ..] = self.config.thresholds;
        [r1.min(widest_1), r2.min(widest_2)].map(|threshold| STEADY_SHARE * threshold)
    }

    /// Standard deviation of a cycle's speed by the encoder's counts: one of them more or less in a cycle, evenly spread,
    /// rad/s.
    fn speed_resolution(&self, window: &Window) -> f32 {
        /// One over the root of twelve.
        const EVENLY_SPREAD: f32 = 0.289;
        let counts = self.config.encoder_counts_per_revolution.max(1.0);
        EVENLY_SPREAD * window.omega_sync / counts
    }

    /// What stays in doubt of the derivative terms at these rates: a share of what they move.
    fn doubt(
        &self,
        rehearsal: &Rehearsal,
        window: &Window,
        rates: &Rates,
    ) -> Option<[f32; RESIDUALS]> {
        let moving = self.moving_at(0.0, window)?;
        let omega_sync = window.omega_sync;
        let still = settled(&moving, rates, omega_sync, &self.config.mechanics);
        let without = self.residuals_at(&moving, rehearsal, window)?;
        let mut doubt = self.residuals_at(&still, rehearsal, window)?;
        for (x, without) in doubt.iter_mut().zip(without) {
            *x = DERIVATIVE_DOUBT * (*x - without).abs();
        }
        Some(doubt)
    }

    fn residuals_at(
        &self,
        measured: &Corrected,
        rehearsal: &Rehearsal,
        window: &Window,
    ) -> Option<[f32; RESIDUALS]> {
        let omega_el = measured.omega_mech * self.config.mechanics.n_p;
        let point = OperatingPoint::new(measured, self.config.frame, window.omega_sync, omega_el)?;
        let residuals = self
            .model
            .evaluate(&point.rehearse(rehearsal), self.tau_load(window));
        Some(residuals.r)
    }

    /// What noise alone may make of each rate: whatever the model makes of it, right or wrong, it is no movement.
    fn noise_of_rates(&self, window: &Window, noise: &CycleNoise) -> RateNoise {
        let length = self.config.window_cycles;
        let rate = NOISE_DEVIATIONS * rate_noise(length, window.span);
        let volt = magnitude(window.u_s.positive).max(f32::MIN_POSITIVE);
        let angle = noise.voltage / volt;
        RateNoise {
            voltage: rate * noise.voltage,
            current: rate * noise.current,
            speed: rate * noise.speed,
            supply: NOISE_DEVIATIONS * frequency_rate_noise(length, window.span) * angle,
        }
    }

    /// What no straight line explains, beyond what noise bends.
    fn bend(&self, window: &Window, noise: &CycleNoise, point: &OperatingPoint) -> [f32; 2] {
        let beyond = |bend: f32, noise: f32| (bend - NOISE_DEVIATIONS * noise).max(0.0);
        let current = beyond(window.current_bend, noise.current);
        let speed = beyond(window.speed_bend, noise.speed);
        let per_second = STEP_PER_BEND / window.span;
        self.model
            .unsteadiness(point, current * per_second, speed * per_second)
    }
}
