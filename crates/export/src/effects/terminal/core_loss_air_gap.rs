//! Core loss at the air gap: `i = i_s + g j w_sync psi_m`, `g` one over the loss resistance.

use crate::algebra::Body;
use crate::effects::{At, Equations, Own, Terminal, Winding};

/// Core loss at the air gap.
pub struct CoreLossAirGap;

impl Equations for CoreLossAirGap {
    fn terminal(
        &self,
        own: &Own,
        body: &mut Body,
        at: &At,
        winding: &Winding,
        terminal: &mut Terminal,
    ) {
        let psi_m = &at.psi_s - &(&winding.i_s * &at.motor.l_ls);
        let loss = psi_m.quarter(&own.p[0] * &at.omega_sync);
        terminal.i = body.vector("i_with_core_loss", &(&terminal.i + &loss));
    }
}
