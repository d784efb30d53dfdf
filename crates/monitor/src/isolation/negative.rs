//! The row of the negative sequence, `(V_2 - Z_2 I_2)/V_1`, and how each cause moves it.

use num_complex::Complex32;

use super::directions::{LEAKAGE_STEP, STEP, impedance};
use super::healthy::Uncertainty;
use crate::model::effects::Corrected;
use crate::window::Window;
use motor::TParams;

/// How the row moves, per relative change in all three phases; one phase gives a third of it, turned by its axis.
///
/// A parameter of all phases makes no negative sequence, but changes what the supply's own one drops: `Z_2 I_2` with the old
/// parameter is too small by the derivative of `Z_2`. The supply's own drop is not larger than `V_2`: current beyond `V_2/Z_2` is
/// drawn by something that differs from phase to phase, and no belief about `Z_2` takes it away.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Negative {
    pub value: Complex32,
    pub voltage: Complex32,
    pub current: Complex32,
    pub series: Complex32,
    pub turns: Complex32,
    /// `Z_2 I_2/V_1` of the supply's own part, whose impedance is only roughly known.
    pub drop: Complex32,
    /// How `Z_2`, and with it that drop, grows with each parameter of all phases.
    pub growth: ByParameter,
}

/// Relative change of `Z_2` per relative change of each parameter that it is made of: to first order, but for leakage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ByParameter {
    pub r_s: Complex32,
    pub r_r: Complex32,
    pub l_m: Complex32,
    pub leakage: Complex32,
}

impl Negative {
    /// From voltages, currents and speed.
    pub fn from_voltages(window: &Window, measured: &Corrected, n_p: f32) -> Self {
        let slip = (window.omega_sync + measured.omega_mech * n_p) / window.omega_sync;
        let p = measured.params;
        let z_2 = impedance(&p, window.omega_sync, slip);
        let (v_1, i_1) = (window.u_s.positive, window.i_s.positive);
        let i_2 = window.i_s.negative / v_1;
        let drop = z_2 * i_2;
        let unbalance = window.u_s.unbalance();
        let supplied = processor::sqrtf(unbalance.norm_sqr() / drop.norm_sqr()).min(1.0);
        // Per motor current, in phase with the voltage.
        let length = processor::sqrtf(i_1.norm_sqr() / v_1.norm_sqr());
        Negative {
            value: unbalance - drop,
            voltage: Complex32::ONE,
            current: -z_2 * i_1 / v_1,
            series: i_1 / v_1 * p.r_s,
            turns: -z_2 * length,
            drop: drop * supplied,
            growth: ByParameter::of(z_2, &p, [window.omega_sync, slip]),
        }
    }

    /// Standard deviation of the angle of `Z_2` that the uncertain parameters leave open, rad: to first order, each by itself.
    pub(super) fn angle_left_open(&self, u: &Uncertainty) -> f32 {
        let by = &self.growth;
        let turned = [
            by.r_s.im * u.stator_resistance,
            by.r_r.im * u.rotor_resistance,
            (by.r_s.im + by.r_r.im) * u.heating,
            by.l_m.im * u.magnetizing_inductance,
            by.leakage.im * u.leakage,
            u.negative_impedance,
        ];
        let angle = processor::sqrtf(turned.iter().map(|angle| angle * angle).sum());
        if angle.is_finite() { angle } else { 0.0 }
    }
}

impl ByParameter {
    fn of(z_2: Complex32, p: &TParams<f32>, [omega_sync, slip]: [f32; 2]) -> Self {
        let growth = |changed: TParams<f32>, step: f32| {
            (impedance(&changed, omega_sync, slip) / z_2 - Complex32::ONE) / step
        };
        let more = 1.0 + STEP;
        let leaky = 1.0 + LEAKAGE_STEP;
        ByParameter {
            r_s: Complex32::from(p.r_s) / z_2,
            r_r: growth(
                TParams {
                    r_r: p.r_r * more,
                    ..*p
                },
                STEP,
            ),
            l_m: growth(
                TParams {
                    l_m: p.l_m * more,
                    ..*p
                },
                STEP,
            ),
            leakage: growth(
                TParams {
                    l_ls: p.l_ls * leaky,
                    l_lr: p.l_lr * leaky,
                    ..*p
                },
                LEAKAGE_STEP,
            ),
        }
    }
}
