//! A user's own term: the equations behind `motor::effect::expression`.

use super::formula::{Formula, NotWritten};
use crate::algebra::{Body, Expr, Vector};
use crate::effects::{At, Equations, Flow, Own, Rates, Terminal, Winding};

/// Where the value of the formula goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    Torque,
    VoltageD,
    VoltageQ,
}

/// A formula with its target.
pub struct Expression {
    formula: Formula,
    /// Names of its parameters, in their order.
    parameters: Vec<&'static str>,
    target: Target,
}

impl Expression {
    /// The formula of a motor file, with the names of its parameters and its key `adds_to`.
    ///
    /// # Errors
    /// A formula that is not understood here.
    pub fn new(
        formula: &str,
        adds_to: &str,
        parameters: Vec<&'static str>,
    ) -> Result<Expression, NotWritten> {
        Ok(Expression {
            formula: Formula::read(formula)?,
            parameters,
            target: match adds_to {
                "voltage_d" => Target::VoltageD,
                "voltage_q" => Target::VoltageQ,
                _ => Target::Torque,
            },
        })
    }

    /// Value of the formula, and the direction of the rotor flux.
    fn value(&self, own: &Own, body: &mut Body, at: &At, i: &Vector, u: &Vector) -> (Expr, Vector) {
        body.note("the formula, in the frame of the rotor flux");
        let psi = body.name("psi", at.psi_r.length());
        let share =
            |x: &Expr, at_rest: f64| (x / &psi).where_holds(Expr::from(0.0).less(&psi), at_rest);
        let d_axis = Vector::new(share(&at.psi_r.re, 1.0), share(&at.psi_r.im, 0.0));
        let d_axis = body.vector("d_axis", &d_axis);
        let (i, u) = (i.times(&d_axis.conj()), u.times(&d_axis.conj()));
        let dq = [("i_d", i.re), ("i_q", i.im), ("u_d", u.re), ("u_q", u.im)];
        let dq = dq.map(|(name, value)| (name, body.name(name, value)));
        let slip = body.name("slip", at.slip());
        let replace = |name: &str| {
            let parameter = self.parameters.iter().position(|p| *p == name);
            let frame = dq.iter().find(|(known, _)| *known == name);
            match (parameter, frame) {
                (Some(k), _) => own.p[k].clone(),
                (None, Some((_, value))) => value.clone(),
                (None, None) => match name {
                    "psi" => psi.clone(),
                    "omega" => at.omega_mech.clone(),
                    "slip" => slip.clone(),
                    "theta" => at.theta_mech.clone(),
                    _ => at.t.clone(),
                },
            }
        };
        let value = self.formula.with(&replace);
        (body.name("formula", value), d_axis)
    }
}

impl Equations for Expression {
    fn terminal(
        &self,
        own: &Own,
        body: &mut Body,
        at: &At,
        _winding: &Winding,
        terminal: &mut Terminal,
    ) {
        let (value, d_axis) = self.value(own, body, at, &terminal.i, &terminal.u);
        let more = match self.target {
            Target::VoltageD => &d_axis * &value,
            Target::VoltageQ => d_axis.quarter(value),
            Target::Torque => return,
        };
        terminal.u = body.vector("u_with_formula", &(&terminal.u + &more));
    }

    fn finish(&self, own: &Own, body: &mut Body, at: &At, flow: &Flow, rates: &mut Rates) {
        if self.target == Target::Torque {
            let (u, i) = (&flow.terminal.u, &flow.terminal.i);
            let (value, _) = self.value(own, body, at, i, u);
            rates.omega_mech = &rates.omega_mech - value / &flow.inertia;
        }
    }
}
