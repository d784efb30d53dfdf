//! Heating of a winding: `R (1 + D(1 - e^(-t/tau)))`, `t` from the start of the recording.

use crate::algebra::{Body, Expr, Function, Vector};
use crate::effects::{At, Equations, Now, Own};

/// Heating of the stator.
pub struct StatorHeating;

/// Heating of the rotor.
pub struct RotorHeating;

fn hot(own: &Own, at: &At, resistance: &Expr) -> Expr {
    resistance * (1.0 - &own.p[0] * (-&at.t / &own.p[1]).of(Function::Expm1))
}

impl Equations for StatorHeating {
    fn parameters(&self, own: &Own, body: &mut Body, at: &At, _i_s: &Vector, now: &mut Now) {
        now.motor.r_s = body.name("r_s_hot", hot(own, at, &now.motor.r_s));
    }
}

impl Equations for RotorHeating {
    fn parameters(&self, own: &Own, body: &mut Body, at: &At, _i_s: &Vector, now: &mut Now) {
        now.motor.r_r = body.name("r_r_hot", hot(own, at, &now.motor.r_r));
    }
}
