//! The torque channel shows `gain` times the truth.

use crate::algebra::Body;
use crate::effects::{Equations, Given, Own};

/// Gain of the torque channel.
pub struct LoadGain;

impl Equations for LoadGain {
    fn inputs(&self, own: &Own, body: &mut Body, given: &mut Given) {
        given.tau_load = body.name("tau_load_true", &given.tau_load / (1.0 + &own.p[0]));
    }
}
