//! Core loss behind the stator resistance: `i = (i_s + g u)/(1 + g R_s)`, `g` one over the loss resistance.

use crate::algebra::Body;
use crate::effects::{At, Equations, Own, Terminal, Winding};

/// Core loss behind the stator resistance.
pub struct CoreLoss;

impl Equations for CoreLoss {
    fn terminal(
        &self,
        own: &Own,
        body: &mut Body,
        _at: &At,
        winding: &Winding,
        terminal: &mut Terminal,
    ) {
        let g = body.name("g_core_loss", &own.p[0]);
        let share = 1.0 / (1.0 + &g * &winding.r_s);
        let i = &(&terminal.i + &(&terminal.u * &g)) * &share;
        terminal.i = body.vector("i_with_core_loss", &i);
    }
}
