//! How each quantity, changed alone, would move the residuals of the positive sequence.
//!
//! A residual is a function of parameters and measurements, zero when both are right. If a parameter of the motor
//! changed, the residual with the old parameter becomes minus its derivative; if a sensor's gain changed, plus its
//! derivative. So no motor model is solved: the directions are difference quotients at the measured point.

use motor::TParams;
use num_complex::Complex32;

use crate::model::effects::Corrected;
use crate::model::operating_point::{Frame, OperatingPoint};
use crate::model::residuals::ResidualModel;
use frames::magnitude;

/// Residuals of the positive sequence: torque balance, `e_d`, `e_q`.
pub type Positive = [f32; 3];

/// Change of the residuals per relative change of each quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Directions {
    pub r_s: Positive,
    pub r_r: Positive,
    pub l_m: Positive,
    pub leakage: Positive,
    pub friction: Positive,
    pub current: Positive,
    pub voltage: Positive,
    pub speed: Positive,
    /// Current through shorted turns, in phase with the voltage, per motor current.
    pub turns: Positive,
    /// The same current a quarter of a turn behind.
    pub turns_lagging: Positive,
}

/// Large enough against the rounding of a residual (1e-6), small enough against its curvature.
pub(super) const STEP: f32 = 0.01;
/// Away from rated load leakage shows when it has doubled, and its departure bends on the way: the chord to three times the
/// leakage instead of the tangent.
pub(super) const LEAKAGE_STEP: f32 = 2.0;

/// The residuals as a function of everything that they depend on.
#[derive(Clone, Copy)]
pub struct Bench<'a> {
    pub model: &'a ResidualModel,
    pub measured: &'a Corrected,
    pub omega_sync: f32,
    pub tau_load: Option<f32>,
}

impl Bench<'_> {
    /// The residuals at the measured point.
    pub fn residuals(&self) -> Option<Positive> {
        self.at(self.measured)
    }

    #[inline(never)]
    fn at(&self, measured: &Corrected) -> Option<Positive> {
        let omega_el = measured.omega_mech * self.model.mechanics.n_p;
        let point = OperatingPoint::new(measured, Frame::RotorFlux, self.omega_sync, omega_el)?;
        let residuals = self.model.evaluate(&point, self.tau_load);
        let [_, r2, ..] = residuals.r;
        Some([r2, residuals.e_d, residuals.e_q])
    }

    /// All directions at the measured point, whose residuals are `base`.
    #[inline(never)]
    pub fn directions(&self, base: &Positive) -> Option<Directions> {
        let sensor = |changed: Corrected| self.quotient(base, &changed, STEP);
        let by_step = |changed: TParams<f32>, step: f32| {
            let moved = self.with_parameters(changed);
            self.quotient(base, &moved, -step)
        };
        let parameter = |changed: TParams<f32>| by_step(changed, STEP);
        let (m, p) = (self.measured, self.measured.params);
        let more = 1.0 + STEP;
        let shunt = m.u_s * (magnitude(m.i_s) * STEP / magnitude(m.u_s));
        Some(Directions {
            r_s: parameter(TParams {
                r_s: p.r_s * more,
                ..p
            })?,
            r_r: parameter(TParams {
                r_r: p.r_r * more,
                ..p
            })?,
            l_m: parameter(TParams {
                l_m: p.l_m * more,
                ..p
            })?,
            leakage: by_step(
                TParams {
                    l_ls: p.l_ls * (1.0 + LEAKAGE_STEP),
                    l_lr: p.l_lr * (1.0 + LEAKAGE_STEP),
                    ..p
                },
                LEAKAGE_STEP,
            )?,
            friction: [
                -self
                    .model
                    .friction_share(self.omega_sync, m.omega_mech, self.tau_load.is_some()),
                0.0,
                0.0,
            ],
            current: sensor(Corrected {
                i_s: m.i_s * more,
                ..*m
            })?,
            voltage: sensor(Corrected {
                u_s: m.u_s * more,
                ..*m
            })?,
            speed: sensor(Corrected {
                omega_mech: m.omega_mech * more,
                ..*m
            })?,
            turns: sensor(Corrected {
                i_s: m.i_s + shunt,
                ..*m
            })?,
            turns_lagging: sensor(Corrected {
                i_s: m.i_s - shunt * Complex32::I,
                ..*m
            })?,
        })
    }

    fn with_parameters(&self, params: TParams<f32>) -> Corrected {
        Corrected {
            params,
            ..*self.measured
        }
    }

    #[inline(never)]
    fn quotient(&self, base: &Positive, changed: &Corrected, step: f32) -> Option<Positive> {
        let mut moved = self.at(changed)?;
        for (x, base) in moved.iter_mut().zip(base) {
            *x = (*x - base) / step;
        }
        Some(moved)
    }
}

/// Impedance of the T model's star phase at `slip`, ohm; the negative sequence sees `2 - s`.
#[inline(never)]
pub fn impedance(p: &TParams<f32>, omega_sync: f32, slip: f32) -> Complex32 {
    let stator = Complex32::new(p.r_s, omega_sync * p.l_ls);
    let main = Complex32::new(0.0, omega_sync * p.l_m);
    // The rotor's branch times the slip: without slip it is open, and nothing is divided by zero.
    let rotor = Complex32::new(p.r_r, slip * omega_sync * p.l_lr);
    stator + main * rotor / (main * slip + rotor)
}
