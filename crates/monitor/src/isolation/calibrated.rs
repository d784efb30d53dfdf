//! What a calibrated monitor does with a window beyond the residuals: the cause behind it, and the winding's temperature.

use crate::config::LoadKind;
use crate::frames::magnitude;
use crate::isolation::{
    Bench, Evidence, Healthy, Heating, Isolation, PositiveEvidence, ROWS, Temperature,
};
use crate::model::movement::DERIVATIVE_DOUBT;
use crate::model::operating_point::OperatingPoint;
use crate::model::residuals::{FieldCurrent, ResidualModel, Residuals};
use crate::monitor::{Monitor, MonitorState};
use crate::noise::allowance::Allowance;
use crate::rehearsal::Rehearsal;
use crate::report::Report;
use crate::window::Window;

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

    /// Which cause explains a steady window with its noise.
    #[inline(never)]
    pub(crate) fn isolate(
        &self,
        healthy: &Healthy,
        [voltages, currents]: [bool; 2],
        rehearsal: &Rehearsal,
        temperature: &Temperature,
        (window, noise): (&Window, &Allowance),
        report: &mut Report,
    ) {
        if report.not_judged.is_some() {
            return;
        }
        let evidence = if voltages {
            self.evidence_of_all(
                healthy,
                rehearsal,
                temperature.latest(),
                window,
                &noise.rows,
            )
        } else {
            currents.then(|| Evidence::of_currents(healthy, window, &noise.rows))
        };
        let expected = temperature.expected(healthy);
        report.isolation = evidence.map(|evidence| Isolation::of(&evidence, healthy, expected));
        // Without voltages there are no residuals, at any temperature.
        if let (Some(isolation), true) = (report.isolation, voltages) {
            self.evaluate_warm(isolation.heating.rise, rehearsal, window, report);
        }
    }

    /// The residuals that the lamps show, with the resistances of the winding temperature that the evidence implies.
    #[inline(never)]
    fn evaluate_warm(
        &self,
        heating: f32,
        rehearsal: &Rehearsal,
        window: &Window,
        report: &mut Report,
    ) {
        if let Some((point, residuals)) = self.warm_residuals(heating, rehearsal, window) {
            report.point = Some(point);
            let visible = report.visible.unwrap_or(self.config.thresholds);
            let torque_known = self.tau_load(window).is_some();
            report.normalised = Some(self.normalise(&residuals, &visible, torque_known));
            report.residuals = Some(residuals);
        }
    }

    fn warm_residuals(
        &self,
        heating: f32,
        rehearsal: &Rehearsal,
        window: &Window,
    ) -> Option<(OperatingPoint, Residuals)> {
        let corrected = self.corrected_at(heating, window)?;
        let omega_el = corrected.omega_mech * self.config.mechanics.n_p;
        let frame = self.config.frame;
        let point = OperatingPoint::new(&corrected, frame, window.omega_sync, omega_el)?;
        let point = point.rehearse(rehearsal);
        let residuals = self.model.evaluate(&point, self.tau_load(window));
        Some((point, residuals))
    }

    /// What a window shows beyond the healthy motor: the material of a calibration. Currents alone give their sequence
    /// components; with voltages the speed is needed too, and `None` without it.
    pub fn evidence(&self, healthy: &Healthy, window: &Window) -> Option<Evidence> {
        if window.u_s.positive.norm_sqr() > 0.0 {
            self.evidence_of_all(healthy, &Rehearsal::default(), 0.0, window, &[0.0; ROWS])
        } else {
            Some(Evidence::of_currents(healthy, window, &[0.0; ROWS]))
        }
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
        let (_, residuals) = self.warm_residuals(heating.rise, rehearsal, window)?;
        Some(residuals)
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
            torque_known: self.config.load == LoadKind::Friction || tau_load.is_some(),
        };
        let n_p = self.config.mechanics.n_p;
        Some(Evidence::new(
            healthy, window, &measured, n_p, &positive, noise,
        ))
    }
}
