//! Windage: `k w abs(w)`.

use crate::algebra::{Body, Function};
use crate::effects::{At, Equations, Flow, Own, Rates};

/// Windage.
pub struct Windage;

impl Equations for Windage {
    fn finish(&self, own: &Own, body: &mut Body, at: &At, flow: &Flow, rates: &mut Rates) {
        let omega = &at.omega_mech;
        let tau = body.name("tau_windage", &own.p[0] * omega * omega.of(Function::Abs));
        rates.omega_mech = &rates.omega_mech - tau / &flow.inertia;
    }
}
