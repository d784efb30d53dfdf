//! Broken rotor bar: rotor voltage drop `R_r (i_r + k e^(j 2 theta_el) conj(i_r))`.

use crate::algebra::{Body, Vector};
use crate::effects::{At, Equations, Flow, Own, Rates};

/// Broken symmetry of the rotor.
pub struct RotorAsymmetry;

impl Equations for RotorAsymmetry {
    fn finish(&self, own: &Own, body: &mut Body, at: &At, flow: &Flow, rates: &mut Rates) {
        let angle = body.name("theta_twice", 2.0 * &flow.n_p * &at.theta_mech);
        let turn = Vector::polar(&flow.winding.r_r, &angle);
        let turn = body.vector("asymmetry", &Vector::new(&own.p[0], &own.p[1]).times(&turn));
        rates.psi_r = &rates.psi_r - &turn.times(&flow.winding.i_r.conj());
    }
}
