//! Each voltage channel shows its own gain times the truth.

use crate::algebra::{Body, clarke, phases};
use crate::effects::{Equations, Given, Own};

/// Gain of each voltage channel.
pub struct PhaseVoltageGain;

impl Equations for PhaseVoltageGain {
    /// A star without zero sequence: the truth `(x_k + z)/(1 + p_k)` sums to zero.
    fn inputs(&self, own: &Own, body: &mut Body, given: &mut Given) {
        let back = [("gain_back_a", 0), ("gain_back_b", 1), ("gain_back_c", 2)]
            .map(|(name, k)| body.name(name, 1.0 / (1.0 + &own.p[k])));
        let x = phases(&given.u);
        let shown = &x[0] * &back[0] + &x[1] * &back[1] + &x[2] * &back[2];
        let zero = body.name("u_zero", -shown / (&back[0] + &back[1] + &back[2]));
        let truth = [0, 1, 2].map(|k| (&x[k] + &zero) * &back[k]);
        given.u = body.vector("u_true", &clarke(&truth));
    }
}
