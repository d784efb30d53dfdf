//! The row of the negative sequence, `(V_2 - Z_2 I_2)/V_1`, and how each cause moves it.

use num_complex::Complex32;

use super::directions::impedance;
use super::healthy::Uncertainty;
use crate::model::effects::Corrected;
use crate::window::Window;
use motor::TParams;

/// How the row of the negative sequence moves, per relative change in all three phases; one phase gives a third of it,
/// turned by its axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Negative {
    pub value: Complex32,
    pub voltage: Complex32,
    pub current: Complex32,
    pub series: Complex32,
    pub turns: Complex32,
    /// `Z_2 I_2/V_1`, whose impedance is only roughly known.
    pub drop: Complex32,
    /// By how much that drop grows with the leakage of all phases, of which it consists for the most part.
    pub leakage: Complex32,
}

impl Negative {
    /// From voltages, currents and speed.
    pub fn from_voltages(window: &Window, measured: &Corrected, n_p: f32) -> Self {
        let slip = (window.omega_sync + measured.omega_mech * n_p) / window.omega_sync;
        let z_2 = impedance(&measured.params, window.omega_sync, slip);
        let (v_1, i_1) = (window.u_s.positive, window.i_s.positive);
        let i_2 = window.i_s.negative / v_1;
        let drop = z_2 * i_2;
        let p = measured.params;
        let leaky = TParams {
            l_ls: 2.0 * p.l_ls,
            l_lr: 2.0 * p.l_lr,
            ..p
        };
        let leakage = (impedance(&leaky, window.omega_sync, slip) - z_2) * i_2;
        let current = -z_2 * i_1 / v_1;
        // Per motor current, in phase with the voltage.
        let length = libm::sqrtf(i_1.norm_sqr() / v_1.norm_sqr());
        Negative {
            value: window.u_s.unbalance() - drop,
            voltage: Complex32::ONE,
            current,
            series: i_1 / v_1 * measured.params.r_s,
            turns: -z_2 * length,
            drop,
            leakage,
        }
    }
}

/// Standard deviation of the angle of `Z_2` that the uncertain parameters leave open, rad: to first order, each by itself.
pub(super) fn angle_left_open(
    window: &Window,
    measured: &Corrected,
    n_p: f32,
    u: &Uncertainty,
) -> f32 {
    let slip = (window.omega_sync + measured.omega_mech * n_p) / window.omega_sync;
    let p = measured.params;
    let z_2 = impedance(&p, window.omega_sync, slip);
    let leakage = 1.0 + u.leakage;
    let stator = TParams {
        r_s: p.r_s * (1.0 + u.stator_resistance),
        ..p
    };
    let rotor = TParams {
        r_r: p.r_r * (1.0 + u.rotor_resistance),
        ..p
    };
    let stray = TParams {
        l_ls: p.l_ls * leakage,
        l_lr: p.l_lr * leakage,
        ..p
    };
    let squares = [stator, rotor, stray].map(|moved| {
        let turned = impedance(&moved, window.omega_sync, slip) / z_2;
        let angle = turned.im / turned.re;
        angle * angle
    });
    let angle = libm::sqrtf(squares.iter().sum());
    if angle.is_finite() { angle } else { 0.0 }
}
