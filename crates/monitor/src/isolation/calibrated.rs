//! What a calibrated monitor does with a window beyond the residuals: the cause behind it, and the winding's temperature.

use crate::config::LoadKind;
use crate::isolation::{
    Bench, Beyond, Conditions, Evidence, Healthy, Heating, Isolation, PositiveEvidence, ROWS,
    impedance, length,
};
use crate::model::effects::Corrected;
use crate::model::movement::DERIVATIVE_DOUBT;
use crate::model::residuals::{FieldCurrent, ResidualModel, Residuals};
use crate::monitor::{Monitor, MonitorState};
use crate::noise::allowance::Allowance;
use crate::rehearsal::Rehearsal;
use crate::report::{NotJudged, Report};
use crate::window::Window;
use frames::magnitude;
use num_complex::Complex32;

/// Speeds below this share of the synchronous one are a standstill: a torque over such a speed is a friction of ten times the rated one
/// and more.
const STANDSTILL: f32 = 0.1;

/// As much of `I_2/I_1` as any supply makes: a motor that hardly draws anything shows nothing.
const MOST_SUPPLIED: f32 = 10.0;

impl Monitor {
    /// Time has passed since the last report, and current has heated the winding.
    pub(crate) fn let_winding_warm(&self, state: &mut MonitorState, window: Option<&Window>) {
        if self.config.healthy.is_none() {
            return;
        }
        let seconds = state.since_report as f32 * self.config.t_sample;
        match window {
            Some(window) => {
                let current = magnitude(window.i_s.positive) / self.config.rated_current;
                state.temperature.pass(seconds, current);
            }
            None => state.temperature.rest(seconds),
        }
    }

    /// Which cause explains a steady window of a calibrated motor, and how far it says the resistances have risen.
    #[inline(never)]
    pub(crate) fn isolate(
        &self,
        state: &mut MonitorState,
        window: &Window,
        noise: &Allowance,
        report: &mut Report,
    ) -> f32 {
        let calibrated = self.config.healthy.as_ref();
        let Some(healthy) = calibrated.filter(|_| report.not_judged.is_none()) else {
            if report.not_judged == Some(NotJudged::Transient) {
                state.temperature.interrupt(self.config.window_cycles);
            }
            return 0.0;
        };
        let [voltages, currents] = state.measured;
        let temperature = &mut state.temperature;
        let evidence = if voltages {
            let near = temperature.latest();
            self.evidence_of_all(healthy, &state.rehearsal, near, window, &noise.rows)
        } else {
            currents.then(|| self.evidence_of_currents(healthy, window, &noise.rows))
        };
        let Some(evidence) = evidence else {
            return 0.0;
        };
        let expected = [temperature.expected(healthy), temperature.expected_apart()];
        let isolation = Isolation::of_two(&evidence, healthy, expected);
        report.isolation = Some(isolation);
        temperature.follow(&isolation, healthy, state.panel.is_isolated());
        isolation.heating.rise
    }

    /// What a window shows beyond the healthy motor: the material of a calibration. Currents alone give their sequence
    /// components; with voltages the speed is needed too, and `None` without it.
    pub fn evidence(&self, healthy: &Healthy, window: &Window) -> Option<Evidence> {
        if window.u_s.positive.norm_sqr() > 0.0 {
            self.evidence_of_all(healthy, &Rehearsal::default(), 0.0, window, &[0.0; ROWS])
        } else {
            Some(self.evidence_of_currents(healthy, window, &[0.0; ROWS]))
        }
    }

    /// Nothing tells what the unseen supply does: its unbalance wanders, and what it draws of one stays the same where the load, and
    /// with it the current that it is compared with, changes.
    #[inline(never)]
    fn evidence_of_currents(
        &self,
        healthy: &Healthy,
        window: &Window,
        noise: &[f32; ROWS],
    ) -> Evidence {
        let config = &self.config;
        let current = magnitude(window.i_s.positive).max(f32::MIN_POSITIVE);
        let standing = magnitude(impedance(&config.params, config.rated_omega, 2.0));
        let drawn =
            healthy.uncertainty.supply_unbalance * config.rated_voltage / (standing * current);
        let learnt = healthy.current_unbalance_at * config.rated_current;
        let [re, im] = healthy.current_unbalance;
        let away = if learnt > 0.0 {
            (learnt - current).abs() / current
        } else {
            0.0
        };
        let moved = magnitude(Complex32::new(re, im)) * away;
        let supplied = length([drawn, moved]).min(MOST_SUPPLIED);
        Evidence::of_currents(healthy, window, noise, supplied)
    }

    /// The residuals of a window at the winding temperature that it implies, where voltages, currents and speed allow
    /// them: what the lamps of a calibrated motor show, under rehearsed gains.
    pub fn residuals(
        &self,
        healthy: &Healthy,
        rehearsal: &Rehearsal,
        window: &Window,
    ) -> Option<Residuals> {
        let evidence = self.evidence_of_all(healthy, rehearsal, 0.0, window, &[0.0; ROWS])?;
        let heating = Isolation::of(&evidence, healthy, Heating::any(healthy)).heating;
        let (_, residuals) = self.residuals_with(heating.rise, rehearsal, window)?;
        Some(residuals)
    }

    /// Current, flux and frequency of a window; `None` without voltages and speed.
    pub fn conditions(&self, window: &Window) -> Option<Conditions> {
        let measured = self.corrected_at(0.0, window)?;
        (window.u_s.positive.norm_sqr() > 0.0)
            .then(|| self.conditions_of(&measured, window.omega_sync))
    }

    /// How far a window lies beyond what the calibration saw; `None` where nothing says what it saw.
    pub fn beyond(&self, window: &Window) -> Option<Beyond> {
        let range = self.config.healthy.as_ref()?.range.as_ref()?;
        self.conditions(window).map(|at| range.beyond(&at))
    }

    /// Whether the shaft turns: near standstill a torque is no friction (37).
    fn turns(&self, measured: &Corrected, omega_sync: f32) -> bool {
        (measured.omega_mech * self.config.mechanics.n_p).abs() > STANDSTILL * omega_sync
    }

    fn conditions_of(&self, measured: &Corrected, omega_sync: f32) -> Conditions {
        let config = &self.config;
        let rated = [
            config.rated_voltage,
            config.rated_current,
            config.rated_omega,
            config.mechanics.n_p,
        ];
        Conditions::of(measured, omega_sync, rated)
    }

    /// `near`: the rise of the resistances around which residuals are taken for straight lines.
    #[inline(never)]
    fn evidence_of_all(
        &self,
        healthy: &Healthy,
        rehearsal: &Rehearsal,
        near: f32,
        window: &Window,
        noise: &[f32; ROWS],
    ) -> Option<Evidence> {
        let measured = self.corrected_at(near, window)?.rehearsed(rehearsal);
        let tau_load = self.tau_load(window);
        let model = ResidualModel {
            field: FieldCurrent::Live,
            ..self.model
        };
        let bench = Bench {
            model: &model,
            measured: &measured,
            omega_sync: window.omega_sync,
            tau_load,
        };
        let residuals = bench.residuals()?;
        let directions = bench.directions(&residuals)?;
        let moving = self.moving_at(near, window)?.rehearsed(rehearsal);
        let without = Bench {
            measured: &moving,
            ..bench
        };
        let mut unsteadiness = without.residuals()?;
        for (x, r) in unsteadiness.iter_mut().zip(residuals) {
            *x = DERIVATIVE_DOUBT * (*x - r).abs();
        }
        let positive = PositiveEvidence {
            residuals,
            directions,
            unsteadiness,
            rise: near,
            torque_known: self.turns(&measured, window.omega_sync)
                && (self.config.load == LoadKind::Friction || tau_load.is_some()),
        };
        let at = self.conditions_of(&measured, window.omega_sync);
        let n_p = self.config.mechanics.n_p;
        let mut evidence = Evidence::new(healthy, window, &measured, n_p, &positive, noise);
        let range = healthy.range.as_ref();
        let beyond = range.map_or(Beyond::default(), |range| range.beyond(&at));
        if !beyond.is_within() {
            let saturating = measured.params.l_m != self.config.params.l_m;
            let rated_torque = self.model.rated_torque_share(window.omega_sync);
            evidence.go_beyond(&beyond, saturating, rated_torque);
        }
        Some(evidence)
    }
}
