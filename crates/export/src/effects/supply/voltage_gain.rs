//! All voltage channels show `gain` times the truth.

use crate::algebra::Body;
use crate::effects::{Equations, Given, Own};

/// Gain of all voltage channels.
pub struct VoltageGain;

impl Equations for VoltageGain {
    fn inputs(&self, own: &Own, body: &mut Body, given: &mut Given) {
        let back = 1.0 / (1.0 + &own.p[0]);
        given.u = body.vector("u_true", &(&given.u * &back));
    }
}
