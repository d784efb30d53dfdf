//! Residuals of a window against what lights their lamps, or the reason why they are not judged.

use crate::checks::sensors::SensorFinding;
use crate::config::LoadKind;
use crate::model::movement::Movement;
use crate::model::operating_point::{Frame, OperatingPoint};
use crate::model::residuals::{RESIDUALS, Residuals};
use crate::monitor::Monitor;
use crate::noise::allowance::Allowance;
use crate::rehearsal::Rehearsal;
use crate::report::{NotJudged, Report};
use crate::window::Window;

/// A residual is too noisy when it must exceed so many thresholds to be seen.
const NOISY: f32 = 10.0;
/// Speeds below this share of the synchronous one are slow: beyond the breakdown slip of any cage.
const SLOW: f32 = 0.5;
/// Frequency in the cage, a share of the rated one, from which on the shaft is held or slow: loads bring 0.15 at the most, and beyond the
/// breakdown slip no motor stays.
const HELD_SLIP: f32 = 0.5;
/// Impedance of a motor whose shaft is held, over that of its circuit short-circuited at the most: at rated load it is four to six times as
/// much, at the breakdown torque 1.5 to 2.
const HELD: f32 = 1.5;

impl Monitor {
    /// What lights the lamps in this window, or the reason why it is not judged.
    #[inline(never)]
    pub(crate) fn set_limits(
        &self,
        rehearsal: &Rehearsal,
        window: &Window,
        movement: &Movement,
        noise: &Allowance,
        report: &mut Report,
    ) {
        let mut visible = self.visible(movement, noise);
        let noisy = self.is_too_noisy(&visible);
        let doubt = self.parameter_doubt(rehearsal, window);
        for (visible, doubt) in visible.iter_mut().zip(doubt) {
            *visible += doubt;
        }
        report.visible = Some(visible);
        if movement.is_plugged {
            report.not_judged = report.not_judged.or(Some(NotJudged::Reversing));
        } else if !movement.is_steady {
            report.not_judged = report.not_judged.or(Some(NotJudged::Transient));
        } else if noisy {
            report.not_judged = report.not_judged.or(Some(NotJudged::Noise));
        } else if window.invalid_samples == 0 && !window.clipped.any() {
            // Clipped currents imply no speed: those of a start or a stall are cut where they are largest.
            report.sensor = report.sensor.or(self.check_speed(rehearsal, window));
        }
        if report.sensor.is_none() && self.is_slow(window) {
            report.not_judged = report.not_judged.or(Some(NotJudged::Held));
        }
    }

    /// The residuals against what lights their lamps, with resistances that have risen by this share: zero for a motor
    /// that is not calibrated.
    #[inline(never)]
    pub(crate) fn evaluate(
        &self,
        rise: f32,
        rehearsal: &Rehearsal,
        window: &Window,
        report: &mut Report,
    ) {
        let Some((point, residuals)) = self.residuals_with(rise, rehearsal, window) else {
            return;
        };
        let visible = report.visible.unwrap_or(self.config.thresholds);
        let torque_known = self.tau_load(window).is_some();
        report.point = Some(point);
        report.normalised = Some(self.normalise(&residuals, &visible, torque_known));
        report.residuals = Some(residuals);
    }

    /// Operating point and residuals with resistances that have risen by this share.
    pub(crate) fn residuals_with(
        &self,
        rise: f32,
        rehearsal: &Rehearsal,
        window: &Window,
    ) -> Option<(OperatingPoint, Residuals)> {
        let corrected = self.corrected_at(rise, window)?;
        let point = self.point_at(&corrected, self.config.frame, rehearsal, window)?;
        let residuals = self.model.evaluate(&point, self.tau_load(window));
        Some((point, residuals))
    }

    /// Residuals that light their lamps: the thresholds, or what the noise of this window can do where that is more (a
    /// threshold holds the noise with which it was derived), and what its changes leave in doubt.
    fn visible(&self, movement: &Movement, noise: &Allowance) -> [f32; RESIDUALS] {
        let mut visible = self.config.thresholds;
        let more = movement.doubt.iter().zip(noise.residuals);
        for (x, (doubt, noise)) in visible.iter_mut().zip(more) {
            *x = x.max(noise) + doubt;
        }
        visible
    }

    fn is_too_noisy(&self, [visible, ..]: &[f32; RESIDUALS]) -> bool {
        let [threshold, ..] = self.config.thresholds;
        *visible > NOISY * threshold
    }

    /// Over what lights the lamps: noise stands in it already. What an undeclared load makes meaningless becomes NaN, which
    /// no comparator counts.
    fn normalise(
        &self,
        residuals: &Residuals,
        visible: &[f32; RESIDUALS],
        torque_known: bool,
    ) -> [f32; RESIDUALS] {
        let load_known = self.config.load == LoadKind::Friction || torque_known;
        let mut normalised = residuals.r;
        for (x, visible) in normalised.iter_mut().zip(visible) {
            *x /= visible;
        }
        if !load_known {
            normalised.iter_mut().skip(1).for_each(|x| *x = f32::NAN);
        }
        normalised
    }

    /// Whether the shaft is held or slow, of a motor whose parameters nobody has measured there.
    fn is_slow(&self, window: &Window) -> bool {
        let omega_el = window
            .omega_mech
            .map(|omega| omega * self.config.mechanics.n_p);
        self.config.healthy.is_none()
            && omega_el.is_some_and(|omega| {
                (window.omega_sync - omega).abs() > HELD_SLIP * self.config.rated_omega
            })
    }

    /// Whether the shaft stands or is slow and the motor takes the current of a motor whose shaft is held. Next to nothing is then left of the rotor
    /// flux, and leakage that has saturated makes of it any slip.
    fn is_held(&self, window: &Window) -> bool {
        let p = &self.config.params;
        let resistance = p.r_s + p.r_r;
        let reactance = window.omega_sync * (p.l_ls + p.l_lr);
        let short_circuit = resistance * resistance + reactance * reactance;
        let (u, i) = (window.u_s.positive, window.i_s.positive);
        let omega_el = window
            .omega_mech
            .map(|omega| omega * self.config.mechanics.n_p);
        omega_el.is_some_and(|omega| omega.abs() < SLOW * window.omega_sync)
            && u.norm_sqr() < HELD * HELD * short_circuit * i.norm_sqr()
    }

    /// In the rotor-flux frame whatever frame is shown: only there do voltages and currents imply a speed.
    fn check_speed(&self, rehearsal: &Rehearsal, window: &Window) -> Option<SensorFinding> {
        if self.is_held(window) {
            return None;
        }
        let point = self.operating_point(Frame::RotorFlux, rehearsal, window)?;
        let implied = self.model.implied_speed(&point);
        let [_, rotor_resistance, ..] = self.config.doubt.circuit;
        self.health
            .check_speed(point.omega_sync, point.omega_el, implied, rotor_resistance)
    }
}
