//! What an effect may look at and change: the symbols behind `motor::effect::effect`.

use crate::algebra::{Body, Expr, Vector};

/// The T model as expressions.
#[derive(Clone, Debug)]
pub struct Motor {
    /// Stator resistance, ohm.
    pub r_s: Expr,
    /// Rotor resistance, ohm.
    pub r_r: Expr,
    /// Stator leakage, H.
    pub l_ls: Expr,
    /// Rotor leakage, H.
    pub l_lr: Expr,
    /// Magnetizing inductance, H.
    pub l_m: Expr,
}

impl Motor {
    /// Stator inductance, H.
    pub fn l_s(&self) -> Expr {
        &self.l_ls + &self.l_m
    }

    /// Rotor inductance, H.
    pub fn l_r(&self) -> Expr {
        &self.l_lr + &self.l_m
    }
}

/// Rated quantities.
#[derive(Clone, Debug)]
pub struct Rated {
    /// Phase voltage, V peak.
    pub voltage: Expr,
    /// Line current, A peak.
    pub current: Expr,
    /// Supply frequency, rad/s.
    pub omega_sync: Expr,
    /// Pole pairs.
    pub n_p: Expr,
}

impl Rated {
    /// Stator flux linkage, V s peak.
    pub fn flux(&self) -> Expr {
        &self.voltage / &self.omega_sync
    }

    /// Synchronous mechanical speed, rad/s.
    pub fn speed(&self) -> Expr {
        &self.omega_sync / &self.n_p
    }
}

/// One instant.
#[derive(Clone, Debug)]
pub struct At {
    /// Time, s.
    pub t: Expr,
    /// Stator flux linkage, V s.
    pub psi_s: Vector,
    /// Rotor flux linkage, V s.
    pub psi_r: Vector,
    /// Mechanical speed, rad/s.
    pub omega_mech: Expr,
    /// Shaft angle, rad.
    pub theta_mech: Expr,
    /// Supply frequency, rad/s.
    pub omega_sync: Expr,
    /// Rated quantities.
    pub rated: Rated,
    /// Constant parameters of the motor.
    pub motor: Motor,
}

impl At {
    /// Slip, 1 at standstill.
    pub fn slip(&self) -> Expr {
        1.0 - &self.rated.n_p * &self.omega_mech / &self.omega_sync
    }
}

/// What the windings carry.
#[derive(Clone, Debug)]
pub struct Winding {
    /// Stator winding current, A.
    pub i_s: Vector,
    /// Rotor current, A.
    pub i_r: Vector,
    /// Stator resistance now, ohm.
    pub r_s: Expr,
    /// Rotor resistance now, ohm.
    pub r_r: Expr,
}

/// A second rotor circuit.
#[derive(Clone, Debug)]
pub struct Cage {
    /// Leakage inductance, H.
    pub l: Expr,
    /// Flux linkage, V s.
    pub psi: Vector,
}

/// Parameters of the windings at one instant.
#[derive(Clone, Debug)]
pub struct Now {
    /// T model.
    pub motor: Motor,
    /// A second cage, if there is one.
    pub cage: Option<Cage>,
}

/// What the stator terminals see.
#[derive(Clone, Debug)]
pub struct Terminal {
    /// Voltage of the supply, V.
    pub supply: Vector,
    /// Voltage that drives the stator circuit, V.
    pub u: Vector,
    /// Current in the supply line, A.
    pub i: Vector,
}

/// Everything that flows.
#[derive(Clone, Debug)]
pub struct Flow {
    /// Windings.
    pub winding: Winding,
    /// Terminals.
    pub terminal: Terminal,
    /// Electromagnetic torque, N m.
    pub tau_em: Expr,
    /// Load torque, N m.
    pub tau_load: Expr,
    /// Moment of inertia, kg m2.
    pub inertia: Expr,
    /// Pole pairs.
    pub n_p: Expr,
}

/// Rates of change, per second.
#[derive(Clone, Debug)]
pub struct Rates {
    /// Stator flux linkage, V.
    pub psi_s: Vector,
    /// Rotor flux linkage, V.
    pub psi_r: Vector,
    /// Speed, rad/s2.
    pub omega_mech: Expr,
    /// The effect's own states.
    pub extra: Vec<Expr>,
}

/// What drives the motor, from what was measured.
#[derive(Clone, Debug)]
pub struct Given {
    /// Stator voltage, V.
    pub u: Vector,
    /// Load torque, N m.
    pub tau_load: Expr,
}

/// What instruments show.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Phase currents, A.
    pub i: [Expr; 3],
    /// Speed, rad/s.
    pub omega_mech: Expr,
    /// Shaft angle, rad.
    pub theta_mech: Expr,
    /// Time, s.
    pub t: Expr,
}

/// Stator and rotor current of the linear T model, A.
pub fn linear_currents(
    body: &mut Body,
    motor: &Motor,
    psi_s: &Vector,
    psi_r: &Vector,
) -> (Vector, Vector) {
    let det = &motor.l_ls * motor.l_r() + &motor.l_m * &motor.l_lr;
    let per_det = body.name("per_det", 1.0 / det);
    let inv_m = body.name("inv_m", &motor.l_m * &per_det);
    let i_s = &(psi_s * &(motor.l_r() * &per_det)) - &(psi_r * &inv_m);
    let i_r = &(psi_r * &(motor.l_s() * &per_det)) - &(psi_s * &inv_m);
    (i_s, i_r)
}
