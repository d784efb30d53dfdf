//! Inductance of an output filter or cable between the voltage and the motor.

use crate::algebra::Body;
use crate::effects::{Equations, Motor, Own};

/// Inductance before the motor.
pub struct SeriesInductance;

impl Equations for SeriesInductance {
    fn motor(&self, own: &Own, body: &mut Body, motor: &mut Motor) {
        motor.l_ls = body.name("l_ls_with_series", &motor.l_ls + &own.p[0]);
    }
}
