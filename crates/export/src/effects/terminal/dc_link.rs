//! DC link that is not what the inverter believes: `u (1 + a + b P)`, `P` the electrical power.

use crate::algebra::Body;
use crate::effects::{At, Equations, Own, Terminal, Winding};

/// DC link that droops.
pub struct DcLink;

impl Equations for DcLink {
    fn terminal(
        &self,
        own: &Own,
        body: &mut Body,
        _at: &At,
        winding: &Winding,
        terminal: &mut Terminal,
    ) {
        let (u, i) = (&terminal.u, &winding.i_s);
        let power = body.name("p_dc_link", 1.5 * (&u.re * &i.re + &u.im * &i.im));
        let factor = body.name("dc_link", 1.0 + &own.p[0] + &own.p[1] * power);
        terminal.u = body.vector("u_dc_link", &(&terminal.u * &factor));
    }
}
