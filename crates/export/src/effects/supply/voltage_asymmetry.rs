//! The motor sees a negative sequence that was not measured: `u + k conj(u)`.

use crate::algebra::{Body, Vector};
use crate::effects::{Equations, Given, Own};

/// Negative sequence of the supply.
pub struct VoltageAsymmetry;

impl Equations for VoltageAsymmetry {
    fn inputs(&self, own: &Own, body: &mut Body, given: &mut Given) {
        let k = Vector::new(&own.p[0], &own.p[1]);
        given.u = body.vector("u_unbalanced", &(&given.u + &k.times(&given.u.conj())));
    }
}
