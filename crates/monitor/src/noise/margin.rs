//! What the noise of this window can do: lamps take their threshold and as much more.

use motor::steady_state::rotor_flux;

use crate::isolation::{Bench, ROWS, rows_of, rows_of_currents};
use crate::model::effects::Corrected;
use crate::model::operating_point::OperatingPoint;
use crate::model::residuals::{FieldCurrent, RESIDUALS, ResidualModel};
use crate::monitor::{Monitor, MonitorState};
use crate::noise::allowance::{Allowance, FLUX, FOLLOWED, SPEED};
use crate::noise::scatter::{Belief, Noise};
use crate::noise::trend::rate_noise;
use crate::window::Window;
use frames::magnitude;

/// Standard deviations that noise may reach: once in 150 000 windows, and a lamp wants three in a row.
const DEVIATIONS: f32 = 4.5;
/// Before anything was seen the noise of a window is believed to be this share of the threshold.
const BELIEVED: f32 = 0.125;

impl Monitor {
    /// Learns from the cycles of a steady window and says what their noise can do to it.
    #[inline(never)]
    pub(crate) fn allowance(
        &self,
        state: &mut MonitorState,
        window: &Window,
        is_steady: bool,
    ) -> Allowance {
        let belief = self.belief(window);
        if is_steady {
            self.follow_cycles(state, window, &belief);
        } else {
            state.scatter.interrupt();
        }
        self.allowed(&state.scatter.noise(&belief), &belief.expected, window)
    }

    fn follow_cycles(&self, state: &mut MonitorState, window: &Window, belief: &Belief<FOLLOWED>) {
        let cycles = match state.scatter.is_interrupted() {
            true => self.config.window_cycles,
            false => 1,
        };
        for age in (0..cycles).rev() {
            let cycle = state.window.single(age, window);
            match cycle.and_then(|cycle| self.shown(&cycle)) {
                Some(shown) => state.scatter.follow(&shown, belief),
                None => state.scatter.interrupt(),
            }
        }
    }

    /// What the samples beside their fundamentals let expect, but no less than what thresholds and calibration hold.
    fn belief(&self, window: &Window) -> Belief<FOLLOWED> {
        let length = self.config.window_cycles as f32;
        let mut floor = [0.0; FOLLOWED];
        for (sigma, threshold) in floor.iter_mut().zip(self.config.thresholds) {
            *sigma = BELIEVED * threshold;
        }
        if let Some(healthy) = &self.config.healthy {
            let rows = floor.iter_mut().skip(RESIDUALS);
            for (sigma, scatter) in rows.zip(healthy.scatter) {
                *sigma = scatter;
            }
        }
        Belief {
            expected: self.expected(window),
            floor: floor.map(|sigma| length * sigma * sigma),
        }
    }

    /// What white noise of the samples does to what a cycle shows, in the order of what is followed: variances.
    fn expected(&self, window: &Window) -> [f32; FOLLOWED] {
        let (p, mechanics) = (&self.config.params, &self.config.mechanics);
        let noise = window.cycle_noise(self.config.t_sample);
        let (u, i) = (one_part(noise.voltage), one_part(noise.current));
        let omega = window.omega_sync;
        let (volt, ampere) = (
            window.u_s.positive.norm_sqr(),
            window.i_s.positive.norm_sqr(),
        );
        let square = |x: f32| x * x;
        let psi = share(volt, square(omega));
        let flux = share(u + square(omega * p.l_s()) * i, volt);
        let load = self.tau_load(window).map_or(0.0, |_| noise.torque);
        let air_gap = square(1.5 * mechanics.n_p) * psi * 2.0 * i;
        let per_torque = self
            .model
            .acceleration_share(omega, 1.0 / mechanics.inertia);
        let torque = square(per_torque) * (air_gap + square(load));
        let turned = psi * square(mechanics.n_p * noise.speed);
        let slip = share(square(p.r_r) * i + turned, volt);
        let leakage = square(p.r_s + p.r_r) + square(omega * p.l_a());
        let negative = share(u + leakage * i, volt);
        let (zero_i, zero_u) = (share(i, ampere), share(u, volt));
        let flux_rate = share(u, square(omega)) + square(p.l_a()) * i;
        [
            flux,
            torque,
            torque,
            flux, // r1..r4
            torque,
            flux,
            slip, // torque balance, e_d, e_q
            negative,
            negative,
            zero_i,
            zero_i,
            zero_u,
            zero_u,
            flux_rate,
            square(noise.speed),
        ]
    }

    /// What one cycle shows; `None` where voltages, currents or speed are missing.
    #[inline(never)]
    fn shown(&self, cycle: &Window) -> Option<[f32; FOLLOWED]> {
        let mut shown = [0.0; FOLLOWED];
        if cycle.u_s.positive.norm_sqr() == 0.0 {
            self.config.healthy.as_ref()?;
            let rows = shown.iter_mut().skip(RESIDUALS);
            rows.zip(rows_of_currents(cycle))
                .for_each(|(x, row)| *x = row);
            return Some(shown);
        }
        let measured = self.moving_at(0.0, cycle)?;
        let point = self.point_of(&measured, cycle.omega_sync)?;
        let tau_load = self.tau_load(cycle);
        let residuals = self.model.evaluate(&point, tau_load);
        shown.iter_mut().zip(residuals.r).for_each(|(x, r)| *x = r);
        if self.config.healthy.is_some() {
            let rows = self.rows(cycle, &measured, tau_load)?;
            let places = shown.iter_mut().skip(RESIDUALS);
            places.zip(rows).for_each(|(x, row)| *x = row);
        }
        let psi_r = rotor_flux(
            &measured.params,
            measured.u_s,
            measured.i_s,
            cycle.omega_sync,
        );
        let last = [(FLUX, magnitude(psi_r)), (SPEED, measured.omega_mech)];
        for (k, value) in last {
            if let Some(place) = shown.get_mut(k) {
                *place = value;
            }
        }
        Some(shown)
    }

    fn rows(
        &self,
        cycle: &Window,
        measured: &Corrected,
        tau_load: Option<f32>,
    ) -> Option<[f32; ROWS]> {
        let model = ResidualModel {
            field: FieldCurrent::Live,
            ..self.model
        };
        let bench = Bench {
            model: &model,
            measured,
            omega_sync: cycle.omega_sync,
            tau_load,
        };
        let n_p = self.config.mechanics.n_p;
        Some(rows_of(cycle, measured, n_p, &bench.residuals()?))
    }

    fn allowed(
        &self,
        noise: &Noise<FOLLOWED>,
        expected: &[f32; FOLLOWED],
        window: &Window,
    ) -> Allowance {
        let length = self.config.window_cycles;
        let share = 1.0 / length as f32;
        // Alike in all cycles of a window: no mean makes it smaller.
        let leakage = window.leakage(self.config.t_sample);
        let leakage = leakage * leakage;
        let mut allowance = Allowance::default();
        let places = allowance.residuals.iter_mut().chain(&mut allowance.rows);
        for ((x, variance), expected) in places.zip(noise.variance).zip(expected) {
            *x = processor::sqrtf(variance * share + leakage * expected);
        }
        let rate = rate_noise(length, window.span);
        let of_rate = |k: usize| {
            let variance = noise.variance.get(k).copied().unwrap_or_default();
            rate * processor::sqrtf(variance)
        };
        let charging = self.charging_share(window, of_rate(FLUX));
        let speeding = self
            .model
            .acceleration_share(window.omega_sync, of_rate(SPEED));
        let [r1, r2, r3, r4] = &mut allowance.residuals;
        let [torque, flux, ..] = &mut allowance.rows;
        for (x, more) in [
            (r1, charging),
            (r4, charging),
            (flux, charging),
            (r2, speeding),
            (r3, speeding),
            (torque, speeding),
        ] {
            *x = processor::sqrtf(*x * *x + more * more);
        }
        let far = DEVIATIONS * noise.doubt(DEVIATIONS);
        allowance.residuals.iter_mut().for_each(|x| *x *= far);
        let significance = self.config.healthy.map_or(DEVIATIONS, |h| h.significance);
        let doubt = noise.doubt(significance.min(MOST_DEVIATIONS));
        allowance.rows.iter_mut().for_each(|x| *x *= doubt);
        allowance
    }

    /// What a rate of the rotor flux, V s/s, adds to r1: the current that charges it, on the scale of the voltage.
    pub(crate) fn charging_share(&self, window: &Window, psi_rate: f32) -> f32 {
        let p = &self.config.params;
        let volt = magnitude(window.u_s.positive);
        if volt > f32::MIN_POSITIVE {
            window.omega_sync * p.l_m / p.r_r * psi_rate / volt
        } else {
            0.0
        }
    }

    fn point_of(&self, measured: &Corrected, omega_sync: f32) -> Option<OperatingPoint> {
        let omega_el = measured.omega_mech * self.config.mechanics.n_p;
        OperatingPoint::new(measured, self.config.frame, omega_sync, omega_el)
    }
}

/// Variance of one part of a complex number whose parts scatter alike; of the standard deviation of both.
fn one_part(sigma: f32) -> f32 {
    0.5 * sigma * sigma
}

fn share(x: f32, of: f32) -> f32 {
    if of > f32::MIN_POSITIVE { x / of } else { 0.0 }
}

/// Beyond so many deviations Student's distribution at few degrees of freedom leaves single precision.
const MOST_DEVIATIONS: f32 = 8.0;
