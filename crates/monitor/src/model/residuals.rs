//! The four steady-state parity residuals (37) and two further ones from the rotor equations.

use motor::Mechanics;

use crate::model::operating_point::OperatingPoint;

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

    /// Rated torque on the scale of `r2`.
    pub fn rated_torque_share(&self, omega_sync: f32) -> f32 {
        let scale = self.friction_scale(omega_sync, 0.0);
        relative(self.rated_torque * self.mechanics.n_p, scale * omega_sync)
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

#[cfg(test)]
mod tests {
    use motor::TParams;

    use super::*;
    use frames::Dq;

    const PARAMS: TParams<f32> = TParams {
        r_s: 8.0,
        r_r: 7.0,
        l_ls: 0.028,
        l_lr: 0.035,
        l_m: 0.42,
    };
    const OMEGA_SYNC: f32 = 377.0;
    const FIELD: f32 = 1.1;
    const N_P: f32 = 2.0;
    const B: f32 = 0.0008;
    const B_L: f32 = 0.0035;

    /// Rated torque over what the declared friction takes at synchronous speed, 377/2 rad/s: 4.3 mN m s of it.
    #[test]
    fn rated_torque_is_told_on_the_scale_of_the_torque_balance() {
        let expected = MODEL.rated_torque / ((B + B_L) * OMEGA_SYNC / N_P);
        let got = MODEL.rated_torque_share(OMEGA_SYNC);
        assert!((got / expected - 1.0).abs() < 1e-6, "{got} {expected}");
        let free = ResidualModel {
            mechanics: Mechanics {
                friction: 0.0,
                load_friction: 0.0,
                ..MODEL.mechanics
            },
            ..MODEL
        };
        assert!((free.rated_torque_share(OMEGA_SYNC) - 1.0).abs() < 1e-6);
    }

    const MODEL: ResidualModel = ResidualModel {
        mechanics: Mechanics {
            n_p: N_P,
            inertia: 0.002,
            friction: B,
            load_friction: B_L,
        },
        field: FieldCurrent::Live,
        rated_torque: 1.7,
    };

    /// Coefficients of the paper's matched DC motor, from the text of (29)-(34).
    struct Coefficients {
        r_a: f32,
        psi: f32,
        /// `K_f N_p`.
        k: f32,
    }

    fn coefficients(i_d: f32) -> Coefficients {
        let (l_s, l_r) = (PARAMS.l_ls + PARAMS.l_m, PARAMS.l_lr + PARAMS.l_m);
        Coefficients {
            r_a: PARAMS.r_s + l_s / l_r * PARAMS.r_r,
            psi: l_s * i_d,
            k: 1.5 * N_P * N_P * PARAMS.l_m * PARAMS.l_m / l_r * i_d,
        }
    }

    /// The linear motor (33) at rest with itself: `R_a I_q + Psi w = V_q` and `K_f N_p I_q = B_t w`.
    fn steady(friction: f32) -> OperatingPoint {
        let c = coefficients(FIELD);
        let i_q = 0.6;
        let omega_el = c.k * i_q / friction;
        let u_q = c.r_a * i_q + c.psi * omega_el;
        OperatingPoint {
            u_s_dq: Dq { d: -40.0, q: u_q },
            i_s_dq: Dq { d: FIELD, q: i_q },
            u_amplitude: processor::sqrtf(40.0 * 40.0 + u_q * u_q),
            psi_r: PARAMS.l_m * FIELD,
            params: PARAMS,
            tau_extra: 0.0,
            omega_sync: OMEGA_SYNC,
            omega_el,
        }
    }

    /// Single precision: a few roundings of numbers that are some times the result.
    fn assert_close(got: f32, expected: f32) {
        assert!(
            (got - expected).abs() < 1e-5 * (1.0 + expected.abs()),
            "{got} instead of {expected}"
        );
    }

    fn assert_residuals(point: &OperatingPoint, tau_load: Option<f32>, expected: [f32; 4]) {
        let got = MODEL.evaluate(point, tau_load).r;
        println!("{got:?} {expected:?}");
        for (got, expected) in got.into_iter().zip(expected) {
            assert_close(got, expected);
        }
    }

    #[test]
    fn the_linear_motor_leaves_nothing() {
        assert_residuals(&steady(B + B_L), None, [0.0; 4]);
    }

    /// Table 1: the current sensor leaves r4 dark, and moves each of the others by its own coefficient of (37).
    #[test]
    fn a_current_sensor_moves_all_but_r4() {
        let (point, b_t) = (steady(B + B_L), B + B_L);
        let c = coefficients(FIELD);
        let more = 0.5 * point.i_s_dq.q;
        let mut seen = point;
        seen.i_s_dq.q += more;
        let k1 = c.psi * c.k + c.r_a * b_t;
        let expected = [
            c.r_a * more / point.u_amplitude,
            -c.k * more / (b_t * OMEGA_SYNC),
            k1 * more / (b_t * point.u_amplitude),
            0.0,
        ];
        assert_residuals(&seen, None, expected);
    }

    /// Table 1: the voltage sensor leaves r2 dark.
    #[test]
    fn a_voltage_sensor_moves_all_but_r2() {
        let point = steady(B + B_L);
        let mut seen = point;
        seen.u_s_dq.q *= 1.5;
        let x = -0.5 * point.u_s_dq.q / point.u_amplitude;
        assert_residuals(&seen, None, [x, 0.0, x, x]);
    }

    /// Table 1: the speed sensor leaves r3 dark.
    #[test]
    fn a_speed_sensor_moves_all_but_r3() {
        let (point, b_t) = (steady(B + B_L), B + B_L);
        let c = coefficients(FIELD);
        let more = 0.5 * point.omega_el;
        let mut seen = point;
        seen.omega_el += more;
        let k1 = c.psi * c.k + c.r_a * b_t;
        let expected = [
            c.psi * more / point.u_amplitude,
            more / OMEGA_SYNC,
            0.0,
            k1 * more / (c.k * point.u_amplitude),
        ];
        assert_residuals(&seen, None, expected);
    }

    #[test]
    fn a_nominal_field_current_replaces_the_measured_one() {
        let nominal = ResidualModel {
            field: FieldCurrent::Nominal(FIELD),
            ..MODEL
        };
        let mut point = steady(B + B_L);
        point.i_s_dq.d = 2.0 * FIELD;
        for r in nominal.evaluate(&point, None).r {
            assert_close(r, 0.0);
        }
    }

    /// A torque channel that reads `B_l w`, or an effect that takes it, says the same as the declared friction.
    #[test]
    fn torque_from_anywhere_counts_as_friction() {
        let point = steady(B + B_L);
        let brake = B_L * point.omega_el / N_P;
        assert_residuals(&point, Some(brake), [0.0; 4]);
        let mut with_effect = steady(B + 2.0 * B_L);
        with_effect.tau_extra = B_L * with_effect.omega_el / N_P;
        let r = MODEL.evaluate(&with_effect, None).r;
        for r in r {
            assert_close(r, 0.0);
        }
    }

    /// At standstill no friction can stand for a torque.
    #[test]
    fn torque_at_standstill_adds_no_friction() {
        let mut point = steady(B + B_L);
        point.omega_el = 0.0;
        let r2 = -coefficients(FIELD).k * point.i_s_dq.q / ((B + B_L) * OMEGA_SYNC);
        assert_close(MODEL.evaluate(&point, Some(1.0)).r[1], r2);
    }

    /// `e_d = |psi_r| - L_m I_d` and (16), each on the scale of the voltage.
    #[test]
    fn the_rotor_equations_tell_flux_and_slip() {
        let mut point = steady(B + B_L);
        let l_r = PARAMS.l_lr + PARAMS.l_m;
        let slip = PARAMS.r_r * PARAMS.l_m / l_r * point.i_s_dq.q / point.psi_r;
        point.omega_el = OMEGA_SYNC - slip;
        let residuals = MODEL.evaluate(&point, None);
        assert_close(residuals.e_d, 0.0);
        assert_close(residuals.e_q, 0.0);
        assert!((MODEL.implied_speed(&point) - point.omega_el).abs() < 1e-3);

        let mut faster = point;
        faster.omega_el += 1.0;
        let e_q = MODEL.evaluate(&faster, None).e_q;
        assert_close(e_q, -point.psi_r / point.u_amplitude);

        point.psi_r += 0.01;
        let e_d = MODEL.evaluate(&point, None).e_d;
        let volt = 0.01 * OMEGA_SYNC * PARAMS.l_m / l_r;
        assert_close(e_d, volt / point.u_amplitude);
    }

    /// (36) row 1 beside (37) row 1: `L_s di/dt` over the voltage; row 2: `J dw/dt` over the torque of the friction scale.
    #[test]
    fn changing_currents_and_speeds_are_unsteady() {
        let point = steady(B + B_L);
        let [volt, torque] = MODEL.unsteadiness(&point, -3.0, -5.0);
        assert_close(volt, (PARAMS.l_ls + PARAMS.l_m) * 3.0 / point.u_amplitude);
        assert_close(torque, 0.002 * 5.0 / ((B + B_L) * OMEGA_SYNC / N_P));
        assert_close(MODEL.acceleration_share(OMEGA_SYNC, -5.0), -torque);
    }

    /// Friction at synchronous speed is the whole scale; with a torque channel only the bearings' share of it is left.
    #[test]
    fn friction_has_its_share_of_the_torque_balance() {
        let omega_mech = 0.9 * OMEGA_SYNC / N_P;
        assert_close(MODEL.friction_share(OMEGA_SYNC, omega_mech, false), 0.9);
        let bearings = 0.9 * B / (B + B_L);
        assert_close(MODEL.friction_share(OMEGA_SYNC, omega_mech, true), bearings);
    }

    /// Friction that takes less than a twentieth of rated torque at synchronous speed is the bearings', no model of a
    /// load: `r2` is then a share of rated torque.
    #[test]
    fn without_a_declared_load_r2_is_a_share_of_rated_torque() {
        let rated_torque = 1.7;
        let at_sync = |share: f32| share * rated_torque * N_P / OMEGA_SYNC;
        for (share, scale) in [(0.04, 1.0), (0.06, 0.06)] {
            let mut free = MODEL;
            free.mechanics.friction = at_sync(share);
            free.mechanics.load_friction = 0.0;
            let mut point = steady(B + B_L);
            point.omega_el = 0.0;
            let torque = coefficients(FIELD).k * point.i_s_dq.q / N_P;
            let r2 = free.evaluate(&point, None).r[1];
            assert_close(r2, -torque / (scale * rated_torque));
        }
    }

    /// A brake beyond rated torque makes its own scale, so that no residual of a stalled motor exceeds all bounds.
    #[test]
    fn a_brake_beyond_rated_torque_is_its_own_scale() {
        let mut free = MODEL;
        (free.mechanics.friction, free.mechanics.load_friction) = (0.0, 0.0);
        let mut point = steady(B + B_L);
        point.i_s_dq.q = 0.0;
        point.omega_el = 100.0;
        let r2 = free.evaluate(&point, Some(10.0 * 1.7)).r[1];
        // Only `B_t w_r` is left of (37) row 2, over `B_t w_s`.
        assert_close(r2, 100.0 / OMEGA_SYNC);
    }

    #[test]
    fn a_scale_of_nothing_gives_nothing() {
        let mut point = steady(B + B_L);
        point.u_amplitude = 0.0;
        point.i_s_dq.d = 0.0;
        let residuals = MODEL.evaluate(&point, None);
        assert_eq!((residuals.r[0], residuals.r[3]), (0.0, 0.0));
        assert_eq!((residuals.e_d, residuals.e_q), (0.0, 0.0));
    }
}
