//! The row of the negative sequence, `(V_2 - Z_2 I_2)/V_1`, and how each cause moves it.

use num_complex::Complex32;

use super::directions::{LEAKAGE_STEP, STEP, impedance};
use crate::model::effects::Corrected;
use crate::window::Window;
use motor::TParams;

/// How the row moves, per relative change in all three phases; one phase gives a third of it, turned by its axis.
///
/// A parameter of all phases makes no negative sequence, but changes what the supply's own one drops: `Z_2 I_2` with the old
/// parameter is too small by the derivative of `Z_2`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Negative {
    pub value: Complex32,
    pub voltage: Complex32,
    pub current: Complex32,
    pub series: Complex32,
    pub turns: Complex32,
    /// `Z_2 I_2/V_1`, whose impedance is only roughly known.
    pub drop: Complex32,
    /// By how much that drop grows with each parameter of all phases.
    pub grown: ByParameter,
}

/// What grows with each parameter that `Z_2` is made of.
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
        // Per motor current, in phase with the voltage.
        let length = libm::sqrtf(i_1.norm_sqr() / v_1.norm_sqr());
        Negative {
            value: window.u_s.unbalance() - drop,
            voltage: Complex32::ONE,
            current: -z_2 * i_1 / v_1,
            series: i_1 / v_1 * p.r_s,
            turns: -z_2 * length,
            drop,
            grown: grown(z_2, &p, [window.omega_sync, slip], i_2),
        }
    }
}

/// Change of `Z_2`, times `i_2`, per relative change of each parameter.
fn grown(
    z_2: Complex32,
    p: &TParams<f32>,
    [omega_sync, slip]: [f32; 2],
    i_2: Complex32,
) -> ByParameter {
    let quotient = |changed: TParams<f32>, step: f32| {
        (impedance(&changed, omega_sync, slip) - z_2) * i_2 / step
    };
    let more = 1.0 + STEP;
    let leaky = 1.0 + LEAKAGE_STEP;
    ByParameter {
        r_s: i_2 * p.r_s,
        r_r: quotient(
            TParams {
                r_r: p.r_r * more,
                ..*p
            },
            STEP,
        ),
        l_m: quotient(
            TParams {
                l_m: p.l_m * more,
                ..*p
            },
            STEP,
        ),
        leakage: quotient(
            TParams {
                l_ls: p.l_ls * leaky,
                l_lr: p.l_lr * leaky,
                ..*p
            },
            LEAKAGE_STEP,
        ),
    }
}
