//! DC link of a six-pulse diode bridge, an inductance and a capacitor, the motor's voltage in proportion to it:
//! `L di/dt = u6(t, phi) - u` (`i >= 0`), `C du/dt = i - P/U`, motor voltage `v u/U`, `U` the bridge's mean voltage.

use crate::algebra::{Body, Expr, Function, number};
use crate::effects::{At, Equations, Flow, Own, Rates, StateNote, Terminal, Winding};
use std::f64::consts::{FRAC_PI_3, FRAC_PI_6, PI, TAU};

/// DC link that a diode bridge charges.
pub struct DcLinkCapacitor;

/// Rectified voltage over its mean: cosine crests of 60 degrees.
fn six_pulse(body: &mut Body, angle: Expr) -> Expr {
    let turns = body.name("bridge_sixths", angle / FRAC_PI_3);
    let within = &turns - turns.of(Function::Floor);
    FRAC_PI_3 * (within * FRAC_PI_3 - FRAC_PI_6).of(Function::Cos)
}

impl Equations for DcLinkCapacitor {
    fn states(&self) -> &'static [StateNote] {
        &[
            (
                "dc_link_deviation",
                "-",
                "deviation of the link voltage from its mean, over the mean",
            ),
            ("dc_link_current", "A", "link current"),
        ]
    }

    fn terminal(
        &self,
        own: &Own,
        body: &mut Body,
        _at: &At,
        _winding: &Winding,
        terminal: &mut Terminal,
    ) {
        let factor = 1.0 + &own.extra[0];
        terminal.u = body.vector("u_dc_link", &(&terminal.u * &factor));
    }

    fn finish(&self, own: &Own, body: &mut Body, at: &At, flow: &Flow, rates: &mut Rates) {
        let [capacitance, inductance, phase, frequency] = [0, 1, 2, 3].map(|k| own.p[k].clone());
        // Mean output of a three-phase bridge: 3/pi of the line voltage's crest.
        let mean = body.name(
            "dc_link_mean",
            3.0 / PI * number(3.0).root() * &at.rated.voltage,
        );
        let angle = TAU * frequency * &at.t + phase;
        let rectified = six_pulse(body, angle);
        let rectified = body.name("bridge", rectified);
        let (u, i) = (1.0 + &own.extra[0], &own.extra[1]);
        let (supply, taken) = (&flow.terminal.supply, &flow.terminal.i);
        let power = 1.5 * (&supply.re * &taken.re + &supply.im * &taken.im);
        let blocked = i.at_most(0.0).and(rectified.less(u.clone()));
        let charging = (i.at_least(0.0) - power / &mean) / (capacitance * &mean);
        let flowing = (rectified - u) * mean / inductance;
        // What an integration step left below zero dies out in a millisecond.
        rates.extra = vec![charging, (-1e3 * i).where_holds(blocked, flowing)];
    }
}
