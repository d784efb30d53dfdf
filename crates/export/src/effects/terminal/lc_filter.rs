//! LC filter: `L_f di/dt = v - u`, `du/dt = (2 pi f_r)^2 L_f (i - i_m)`.

use crate::algebra::{Body, Vector};
use crate::effects::{At, Equations, Flow, Own, Rates, StateNote, Terminal, Winding};
use std::f64::consts::TAU;

/// LC filter.
pub struct LcFilter;

impl Equations for LcFilter {
    fn states(&self) -> &'static [StateNote] {
        &[
            ("filter_current_alpha", "A", "filter current"),
            ("filter_current_beta", "A", "filter current"),
            ("filter_voltage_alpha", "V", "capacitor voltage"),
            ("filter_voltage_beta", "V", "capacitor voltage"),
        ]
    }

    fn terminal(
        &self,
        own: &Own,
        _body: &mut Body,
        _at: &At,
        _winding: &Winding,
        terminal: &mut Terminal,
    ) {
        terminal.u = Vector::new(&own.extra[2], &own.extra[3]);
    }

    fn finish(&self, own: &Own, body: &mut Body, _at: &At, flow: &Flow, rates: &mut Rates) {
        let i = Vector::new(&own.extra[0], &own.extra[1]);
        let u = Vector::new(&own.extra[2], &own.extra[3]);
        let omega = body.name("omega_filter", TAU * &own.p[1]);
        let i_rate = &(&flow.terminal.supply - &u) * &(1.0 / &own.p[0]);
        let u_rate = &(&i - &flow.terminal.i) * &(omega.squared() * &own.p[0]);
        rates.extra = vec![i_rate.re, i_rate.im, u_rate.re, u_rate.im];
    }
}
