//! What a law does to the motor: the equations behind `motor::effect::curve`.

use crate::algebra::{Body, Expr, Function, TableOf, Vector, clarke, number, phases};
use crate::effects::winding::iterated;
use crate::effects::{At, Equations, Flow, Now, Own, Rates, Shown};
use motor::effect::curve::{Action, Coordinate, Place};
use std::f64::consts::TAU;
use std::rc::Rc;

/// Least factor that a curve may leave of an inductance or of the magnetizing current.
const LEAST_FACTOR: f64 = 0.05;
/// Speed below which friction turns over, share of the synchronous speed.
const TURNS_OVER: f64 = 0.01;

/// A law with its table.
pub struct Curve {
    action: Action,
    table: Rc<str>,
}

impl Curve {
    /// The law of this action whose table has this name.
    pub fn new(action: Action, table: &str) -> Curve {
        Curve {
            action,
            table: table.into(),
        }
    }

    fn at(&self, x: impl Into<Expr>) -> Expr {
        Expr::Table(self.table.clone(), TableOf::Value, Rc::new(x.into()))
    }

    fn at_angle(&self, x: &Expr) -> Expr {
        let turn = x / TAU;
        self.at(TAU * (&turn - turn.of(Function::Floor)))
    }

    /// Coordinates that need no current.
    fn of_supply(&self, at: &At) -> Expr {
        match self.action.coordinate {
            Coordinate::Slip => at.slip() * &at.omega_sync / TAU,
            Coordinate::Frequency => &at.omega_sync / TAU,
            Coordinate::Speed => at.omega_mech.clone(),
            Coordinate::Angle => at.theta_mech.clone(),
            _ => at.t.clone(),
        }
    }

    /// Value of the curve where the motor is.
    fn value(&self, at: &At, flow: &Flow) -> Expr {
        let x = match self.action.coordinate {
            Coordinate::Angle => return self.at_angle(&at.theta_mech),
            Coordinate::AngleElectrical => return self.at_angle(&flow.terminal.supply.angle()),
            Coordinate::Current if self.action.place == Place::Rotor => flow.winding.i_r.length(),
            Coordinate::Current => flow.winding.i_s.length(),
            Coordinate::Flux => (&at.psi_s - &(&flow.winding.i_s * &at.motor.l_ls)).length(),
            Coordinate::Voltage => flow.terminal.supply.length(),
            Coordinate::LoadTorque => flow.tau_load.clone(),
            _ => self.of_supply(at),
        };
        self.at(x)
    }

    /// Voltage drop in the stator circuit, V.
    fn drop(&self, body: &mut Body, at: &At, flow: &Flow) -> Vector {
        let (i, r_s) = (&flow.terminal.i, &flow.winding.r_s);
        let only = |phase: usize, value: Expr| {
            let mut abc = [0.0; 3].map(number);
            abc[phase] = value;
            clarke(&abc)
        };
        if self.action.coordinate == Coordinate::PhaseCurrent {
            let [a, b, c] = phases(i).map(|x| self.at(x));
            return match self.action.place.phase() {
                Some(phase) => only(phase, body.name("drop", [a, b, c][phase].clone())),
                None => clarke(&[
                    body.name("drop_a", a),
                    body.name("drop_b", b),
                    body.name("drop_c", c),
                ]),
            };
        }
        let more = body.name("curve_value", self.value(at, flow));
        match self.action.place.phase() {
            Some(phase) => only(phase, body.name("drop", r_s * more * &phases(i)[phase])),
            None => i * &(r_s * more),
        }
    }
}

impl Equations for Curve {
    fn magnetizing(&self, _own: &Own, body: &mut Body, x: &Expr) -> (Expr, Expr) {
        let factor = body.name("curve_factor", 1.0 + self.at(x));
        let slope = Expr::Table(self.table.clone(), TableOf::Slope, Rc::new(x.clone()));
        let is_free = number(LEAST_FACTOR).less(&factor);
        (
            factor.at_least(LEAST_FACTOR),
            slope.where_holds(is_free, 0.0),
        )
    }

    fn parameters(&self, _own: &Own, body: &mut Body, at: &At, i_s: &Vector, now: &mut Now) {
        if self.action.place == Place::Magnetizing {
            let factor = (1.0 + self.at(self.of_supply(at))).at_least(LEAST_FACTOR);
            now.motor.l_m = body.name("l_m_now", &now.motor.l_m / factor);
            return;
        }
        let factor = |x: Expr| (1.0 + self.at(x)).at_least(LEAST_FACTOR);
        if self.action.coordinate == Coordinate::Current {
            iterated(body, at, i_s, now, |i2| factor(i2.root()));
            return;
        }
        let f = body.name("leakage_factor", factor(self.of_supply(at)));
        now.motor.l_ls = body.name("l_ls_now", &now.motor.l_ls * &f);
        now.motor.l_lr = body.name("l_lr_now", &now.motor.l_lr * f);
    }

    fn finish(&self, _own: &Own, body: &mut Body, at: &At, flow: &Flow, rates: &mut Rates) {
        match self.action.place {
            Place::Torque => {
                let tau = body.name("tau_curve", self.value(at, flow));
                rates.omega_mech = &rates.omega_mech - tau / &flow.inertia;
            }
            Place::Friction => {
                let sign = (&at.omega_mech / (TURNS_OVER * at.rated.speed())).of(Function::Tanh);
                let tau = body.name("tau_curve", sign * self.value(at, flow));
                rates.omega_mech = &rates.omega_mech - tau / &flow.inertia;
            }
            Place::Rotor => {
                let more = self.value(at, flow).at_least(LEAST_FACTOR - 1.0);
                let r = body.name("r_r_curve", &flow.winding.r_r * more);
                rates.psi_r = &rates.psi_r - &(&flow.winding.i_r * &r);
            }
            _ => {
                let drop = self.drop(body, at, flow);
                rates.psi_s = &rates.psi_s - &drop;
            }
        }
    }

    fn outputs(&self, _own: &Own, shown: &mut Shown) {
        if let Some(phase) = self.action.place.phase() {
            let i = &shown.i[phase];
            let x = match self.action.coordinate {
                Coordinate::Time => &shown.t,
                _ => i,
            };
            shown.i[phase] = i * (1.0 + self.at(x));
            return;
        }
        let more = match self.action.coordinate {
            Coordinate::Angle => self.at_angle(&shown.theta_mech),
            Coordinate::Time => self.at(&shown.t),
            _ => self.at(&shown.omega_mech),
        };
        shown.omega_mech = &shown.omega_mech * (1.0 + more);
    }
}
