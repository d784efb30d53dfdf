//! Coulomb friction: `T_c sgn(w)`, smoothed over 0.5 % of synchronous speed.

use crate::algebra::{Body, Function};
use crate::effects::{At, Equations, Flow, Own, Rates};

/// Coulomb friction.
pub struct CoulombFriction;

impl Equations for CoulombFriction {
    fn finish(&self, own: &Own, body: &mut Body, at: &At, flow: &Flow, rates: &mut Rates) {
        let turning = &at.omega_mech / (at.rated.speed() * 0.005);
        let tau = body.name("tau_coulomb", &own.p[0] * turning.of(Function::Tanh));
        rates.omega_mech = &rates.omega_mech - tau / &flow.inertia;
    }
}
