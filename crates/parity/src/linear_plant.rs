//! The published linear model (33): the d-q motor with constant field current, a matched DC motor.
//!
//! ```text
//! L_a dI_q/dt = V_q - R_a I_q - Psi w_r                (33)
//! J   dw_r/dt = K_f N_p I_q - B_t w_r                  (33)
//! ```
//!
//! Its parameters are independent of one another, as in the published fault experiments: a change of
//! `L_s` enters `Psi` and `R_a` and leaves `K_f`, although no real inductance could do that. Signs and
//! frame: rotor-flux frame, q leads d by 90 degrees; `w_r` is electrical.

use motor::{Mechanics, TParams};
use nalgebra::{Matrix2, Matrix3, Vector2};

/// Parameters of the linear model; each may be changed alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearParams {
    /// Stator resistance, ohm, > 0.
    pub r_s: f64,
    /// Rotor resistance referred to the stator, ohm, > 0.
    pub r_r: f64,
    /// Stator inductance `L_s`, H, > 0.
    pub l_s: f64,
    /// Rotor inductance `L_r`, H, > 0.
    pub l_r: f64,
    /// Magnetizing inductance, H, > 0.
    pub l_m: f64,
    /// Leakage factor, 0..1. Kept when `l_s` or `l_r` changes: `1 - L_m^2/(L_s L_r)` would turn negative
    /// at -50 %.
    pub sigma: f64,
    /// Pole pairs.
    pub n_p: f64,
    /// Inertia, kg m2, > 0.
    pub inertia: f64,
    /// Viscous friction of the motor `B`, N m s, >= 0.
    pub friction: f64,
    /// Load friction `B_l`, N m s, >= 0.
    pub load_friction: f64,
    /// Constant field current `i_f = I_d`, A, > 0.
    pub field_current: f64,
}

impl LinearParams {
    /// The linear model of a motor with the given constant field current, A.
    pub fn new(motor: &TParams<f64>, mechanics: &Mechanics<f64>, field_current: f64) -> Self {
        LinearParams {
            r_s: motor.r_s,
            r_r: motor.r_r,
            l_s: motor.l_s(),
            l_r: motor.l_r(),
            l_m: motor.l_m,
            sigma: motor.sigma(),
            n_p: mechanics.n_p,
            inertia: mechanics.inertia,
            friction: mechanics.friction,
            load_friction: mechanics.load_friction,
            field_current,
        }
    }

    /// Total friction `B_t = B + B_l`, N m s.
    pub fn b_t(&self) -> f64 {
        self.friction + self.load_friction
    }

    /// Armature inductance `L_a = sigma L_s`, H.
    pub fn l_a(&self) -> f64 {
        self.sigma * self.l_s
    }

    /// Armature resistance `R_a = R_s + (L_s/L_r) R_r`, ohm.
    pub fn r_a(&self) -> f64 {
        self.r_s + self.l_s / self.l_r * self.r_r
    }

    /// Flux linkage `Psi = L_s i_f`, V s.
    pub fn psi(&self) -> f64 {
        self.l_s * self.field_current
    }

    /// Torque per q current `K_f = (3/2) N_p (L_m^2/L_r) i_f`, N m/A.
    pub fn k_f(&self) -> f64 {
        1.5 * self.n_p * self.l_m * self.l_m / self.l_r * self.field_current
    }

    /// System matrix of (33) with the state `[I_q, w_r]`.
    pub fn a(&self) -> Matrix2<f64> {
        let (l_a, j) = (self.l_a(), self.inertia);
        Matrix2::new(
            -self.r_a() / l_a,
            -self.psi() / l_a,
            self.k_f() * self.n_p / j,
            -self.b_t() / j,
        )
    }

    /// Input matrix of (33) for the input `V_q`.
    pub fn b(&self) -> Vector2<f64> {
        Vector2::new(1.0 / self.l_a(), 0.0)
    }

    /// The state in which the model settles at a constant `v_q`, V.
    pub fn steady_state(&self, v_q: f64) -> LinearState {
        let torque_per_amp = self.k_f() * self.n_p;
        let determinant = self.psi() * torque_per_amp + self.r_a() * self.b_t();
        LinearState {
            i_q: self.b_t() * v_q / determinant,
            omega_el: torque_per_amp * v_q / determinant,
        }
    }

    /// The exact step over `t_sample` (s, > 0) with the input held.
    pub fn discretise(&self, t_sample: f64) -> LinearStep {
        let mut augmented = Matrix3::zeros();
        augmented
            .fixed_view_mut::<2, 2>(0, 0)
            .copy_from(&(self.a() * t_sample));
        augmented
            .fixed_view_mut::<2, 1>(0, 2)
            .copy_from(&(self.b() * t_sample));
        // exp([A B; 0 0] t) holds both matrices of the held-input step.
        let exponential = augmented.exp();
        LinearStep {
            a: exponential.fixed_view::<2, 2>(0, 0).into_owned(),
            b: exponential.fixed_view::<2, 1>(0, 2).into_owned(),
        }
    }
}

/// State of the linear model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinearState {
    /// q current, A.
    pub i_q: f64,
    /// Rotor speed, electrical rad/s.
    pub omega_el: f64,
}

/// One exact step of fixed length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearStep {
    a: Matrix2<f64>,
    b: Vector2<f64>,
}

impl LinearStep {
    /// The state one step later, with `v_q` (V) held meanwhile.
    pub fn advance(&self, state: LinearState, v_q: f64) -> LinearState {
        let x = self.a * Vector2::new(state.i_q, state.omega_el) + self.b * v_q;
        LinearState {
            i_q: x.x,
            omega_el: x.y,
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn assumed_300w() -> LinearParams {
        LinearParams {
            r_s: 8.0,
            r_r: 7.0,
            l_s: 0.448,
            l_r: 0.448,
            l_m: 0.42,
            sigma: 1.0 - (0.42_f64 / 0.448).powi(2),
            n_p: 2.0,
            inertia: 0.002,
            friction: 0.0008,
            load_friction: 0.0035,
            field_current: 1.05,
        }
    }

    /// (33) written out as a right-hand side, integrated by RK4 with steps of 1 us.
    fn integrate(p: &LinearParams, v_q: f64, duration: f64) -> LinearState {
        let rate = |i: f64, w: f64| {
            (
                (v_q - p.r_a() * i - p.psi() * w) / p.l_a(),     // (33)
                (p.k_f() * p.n_p * i - p.b_t() * w) / p.inertia, // (33)
            )
        };
        let h = 1e-6;
        let (mut i, mut w) = (0.0, 0.0);
        for _ in 0..(duration / h).round() as usize {
            let k1 = rate(i, w);
            let k2 = rate(i + 0.5 * h * k1.0, w + 0.5 * h * k1.1);
            let k3 = rate(i + 0.5 * h * k2.0, w + 0.5 * h * k2.1);
            let k4 = rate(i + h * k3.0, w + h * k3.1);
            i += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
            w += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
        }
        LinearState {
            i_q: i,
            omega_el: w,
        }
    }

    #[test]
    fn the_exact_step_follows_the_differential_equation() {
        let p = assumed_300w();
        let fine = integrate(&p, 179.6, 0.02);
        for t_sample in [1e-4, 1e-3, 0.02] {
            let step = p.discretise(t_sample);
            let mut state = LinearState::default();
            for _ in 0..(0.02 / t_sample).round() as usize {
                state = step.advance(state, 179.6);
            }
            // RK4 at 1 us errs by (5e3/s * 1 us)^4 = 6e-10 at most, its rounding by 2e4 * 1e-16.
            assert!((state.i_q / fine.i_q - 1.0).abs() < 1e-9, "{t_sample}");
            assert!((state.omega_el / fine.omega_el - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn the_model_settles_where_the_closed_form_says() {
        let mut p = assumed_300w();
        for (l_s, l_r) in [
            (0.448, 0.448),
            (0.224, 0.448),
            (0.448, 0.224),
            (0.672, 0.672),
        ] {
            (p.l_s, p.l_r) = (l_s, l_r);
            let step = p.discretise(1e-3);
            let mut state = LinearState::default();
            for _ in 0..20_000 {
                state = step.advance(state, 179.6);
            }
            let settled = p.steady_state(179.6);
            assert!((state.i_q / settled.i_q - 1.0).abs() < 1e-10);
            assert!((state.omega_el / settled.omega_el - 1.0).abs() < 1e-10);
        }
    }

    #[test]
    fn the_steady_state_has_no_rate() {
        let p = assumed_300w();
        let state = p.steady_state(100.0);
        let rate = p.a() * Vector2::new(state.i_q, state.omega_el) + p.b() * 100.0;
        // Voltages of 100 V over L_a = 54 mH cancel to rounding.
        assert!(rate.x.abs() < 1e-11 && rate.y.abs() < 1e-10, "{rate}");
    }
}
