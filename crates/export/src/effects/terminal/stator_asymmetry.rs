//! Series resistance or shorted turns in one phase: voltage drop `R_s (i + k conj(i))`.

use crate::algebra::{Body, Vector};
use crate::effects::{At, Equations, Own, Terminal, Winding};

/// Broken symmetry of the stator.
pub struct StatorAsymmetry;

impl Equations for StatorAsymmetry {
    fn terminal(
        &self,
        own: &Own,
        body: &mut Body,
        _at: &At,
        winding: &Winding,
        terminal: &mut Terminal,
    ) {
        let k = &Vector::new(&own.p[0], &own.p[1]) * &winding.r_s;
        let u = &terminal.u - &k.times(&terminal.i.conj());
        terminal.u = body.vector("u_asymmetric", &u);
    }
}
