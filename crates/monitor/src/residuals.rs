//! The four steady-state parity residuals (37) and two further ones from the rotor equations.

use motor::Mechanics;

use crate::operating_point::OperatingPoint;

/// How many residuals the lamps show.
pub const RESIDUALS: usize = 4;

/// What the field current `i_f` of the matched DC motor is taken to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldCurrent {
    /// The measured `I_d`.
    Live,
    /// A constant, A: the paper's choice.
    Nominal(f32),
}

/// The motor as the residuals see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResidualModel {
    /// Pole pairs and friction.
    pub mechanics: Mechanics<f32>,
    /// Source of the field current.
    pub field: FieldCurrent,
    /// Rated torque, N m: the scale of `r2` where no friction is declared.
    pub rated_torque: f32,
}

/// The residuals, each relative to its own scale, so that 0.01 is one per cent of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residuals {
    /// `r1/|V|`, `r2/(B_t w_s)`, `r3/(B_t |V|)`, `r4/(K_f N_p |V|)`.
    pub r: [f32; RESIDUALS],
    /// Rotor flux against `L_m I_d`, relative to the voltage.
    pub e_d: f32,
    /// Slip times rotor flux against the rotor resistance's drop, relative to the voltage.
    pub e_q: f32,
}

/// Coefficients of (37) at one operating point.
struct DcMotor {
    r_a: f32,
    psi: f32,
    k_f: f32,
    n_p: f32,
    /// Total friction `B_t`, N m s: shaft torque per mechanical speed.
    b_t: f32,
    /// Friction that gives rated torque at synchronous speed: the scale where `b_t` is not a model of the load.
    b_scale: f32,
}

impl ResidualModel {
    /// Evaluates all residuals. `tau_load` is a measured brake torque, N m, which then replaces `B_l w`.
    ///
    /// Every scale is positive for a valid operating point; a zero field current gives `r4 = 0`.
    pub fn evaluate(&self, point: &OperatingPoint, tau_load: Option<f32>) -> Residuals {
        let dc = self.dc_motor(point, tau_load);
        let (i_q, u_q, w_r) = (point.i_s_dq.q, point.u_s_dq.q, point.omega_el);
        let k = dc.k_f * dc.n_p;
        let k1 = dc.psi * k + dc.r_a * dc.b_t;
        let r1 = dc.r_a * i_q + dc.psi * w_r - u_q; // (37) row 1
        let r2 = -k * i_q + dc.b_t * w_r; // (37) row 2
        let r3 = k1 * i_q - dc.b_t * u_q; // (37) row 3
        let r4 = k1 * w_r - k * u_q; // (37) row 4
        let volt = point.u_amplitude;
        Residuals {
            r: [
                relative(r1, volt),
                relative(r2, dc.b_scale * point.omega_sync),
                relative(r3, dc.b_scale * volt),
                relative(r4, k * volt),
            ],
            e_d: self.e_d(point),
            e_q: self.e_q(point),
        }
    }

    fn dc_motor(&self, point: &OperatingPoint, tau_load: Option<f32>) -> DcMotor {
        let p = &point.params;
        let i_f = match self.field {
            FieldCurrent::Live => point.i_s_dq.d,
            FieldCurrent::Nominal(amp) => amp,
        };
        let n_p = self.mechanics.n_p;
        let b_t = self.friction(point, tau_load);
        DcMotor {
            r_a: p.r_a(),
            psi: p.l_s() * i_f,                             // below (34)
            k_f: 1.5 * n_p * p.l_m * p.l_m / p.l_r() * i_f, // (29)
            n_p,
            b_t,
            b_scale: self.friction_scale(point.omega_sync, b_t),
        }
    }

    /// `B_t` of (37), with a measured brake torque in the place of `B_l w`, and what the effects add.
    fn friction(&self, point: &OperatingPoint, tau_load: Option<f32>) -> f32 {
        let as_friction = |tau: f32| relative(tau * self.mechanics.n_p, point.omega_el);
        let declared = match tau_load {
            Some(tau) => self.mechanics.friction + as_friction(tau),
            None => self.mechanics.total_friction(),
        };
        declared + as_friction(point.tau_extra)
    }

    /// What viscous friction takes of the torque balance, on the scale of `r2`.
    pub fn friction_share(&self, omega_sync: f32, omega_mech: f32, torque_known: bool) -> f32 {
        let b_t = if torque_known {
            self.mechanics.friction
        } else {
            self.mechanics.total_friction()
        };
        let scale = self.friction_scale(omega_sync, b_t);
        relative(b_t * omega_mech * self.mechanics.n_p, scale * omega_sync)
    }

    /// Rotor and load speeding up: the inertia's term of (36) row 2, on the scale of `r2`.
    pub fn acceleration_share(&self, omega_sync: f32, mech_rate: f32) -> f32 {
        let scale = self.friction_scale(omega_sync, 0.0) * omega_sync / self.mechanics.n_p;
        relative(self.mechanics.inertia * mech_rate, scale)
    }

    fn friction_scale(&self, omega_sync: f32, b_t: f32) -> f32 {
        let declared = self.mechanics.total_friction();
        let rated = relative(self.rated_torque * self.mechanics.n_p, omega_sync);
        if declared > LEAST_FRICTION_SHARE * rated {
            declared
        } else {
            rated.max(b_t)
        }
    }

    /// `e_d = |psi_r| - L_m I_d` in volts over the voltage: d axis of the rotor equation.
    fn e_d(&self, point: &OperatingPoint) -> f32 {
        let p = &point.params;
        let e_d = point.psi_r - p.l_m * point.i_s_dq.d;
        relative(e_d * point.omega_sync * p.l_m, p.l_r() * point.u_amplitude)
    }

    /// `e_q = w_sl |psi_r| - R_r (L_m/L_r) I_q` over the voltage: q axis of the rotor equation (16).
    fn e_q(&self, point: &OperatingPoint) -> f32 {
        let p = &point.params;
        let drop = p.r_r * p.l_m / p.l_r() * point.i_s_dq.q;
        relative(point.omega_slip() * point.psi_r - drop, point.u_amplitude)
    }

    /// Electrical rotor speed, rad/s, that voltages and currents alone imply (needs the rotor-flux frame).
    pub fn implied_speed(&self, point: &OperatingPoint) -> f32 {
        let p = &point.params;
        let slip = relative(p.r_r * p.l_m / p.l_r() * point.i_s_dq.q, point.psi_r);
        point.omega_sync - slip
    }

    /// The terms of (36) that (37) leaves out, on the scales of `r1` and `r2`: how far from steady the motor is.
    pub fn unsteadiness(
        &self,
        point: &OperatingPoint,
        current_rate: f32,
        mech_rate: f32,
    ) -> [f32; 2] {
        let volt = relative(point.params.l_s() * current_rate, point.u_amplitude); // (36) row 1
        let torque = self.acceleration_share(point.omega_sync, mech_rate); // (36) row 2
        [volt.abs(), torque.abs()]
    }
}

/// Below this share of rated torque at synchronous speed, declared friction is bearing friction and no model of a load.
const LEAST_FRICTION_SHARE: f32 = 0.05;

fn relative(value: f32, scale: f32) -> f32 {
    if scale.abs() > f32::MIN_POSITIVE {
        value / scale
    } else {
        0.0
    }
}
