//! Torque that pulsates once per turn: `a cos(theta) + b sin(theta)`.

use crate::algebra::{Body, Function};
use crate::effects::{At, Equations, Flow, Own, Rates};

/// Torque that pulsates once per turn.
pub struct LoadPulsation;

impl Equations for LoadPulsation {
    fn finish(&self, own: &Own, body: &mut Body, at: &At, flow: &Flow, rates: &mut Rates) {
        let theta = &at.theta_mech;
        let cos = &own.p[0] * theta.of(Function::Cos);
        let sin = &own.p[1] * theta.of(Function::Sin);
        let tau = body.name("tau_pulsation", cos + sin);
        rates.omega_mech = &rates.omega_mech - tau / &flow.inertia;
    }
}
