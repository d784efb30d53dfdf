//! The voltages are turned against the currents: `u e^(j delta)`.

use crate::algebra::{Body, Vector};
use crate::effects::{Equations, Given, Own};

/// Voltages turned against the currents.
pub struct FrameRotation;

impl Equations for FrameRotation {
    fn inputs(&self, own: &Own, body: &mut Body, given: &mut Given) {
        let turn = Vector::polar(&1.0.into(), &own.p[0]);
        given.u = body.vector("u_turned", &given.u.times(&turn));
    }
}
