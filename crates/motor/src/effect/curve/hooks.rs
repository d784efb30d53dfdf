//! What a law does to the motor: the same for knots in a motor file and for curves that are still being fitted.

use super::{Action, Coordinate, Place, Table};
use crate::dynamic::{Flow, Linear, clarke, phases};
use crate::effect::steady::length;
use crate::effect::{At, Effect, Hook, Instantaneous, Outputs, Rated, Rates, SteadyEffect};
use core::f64::consts::TAU;
use num_complex::Complex64;

/// Least factor that a curve may leave of an inductance or of the magnetizing current.
const LEAST_FACTOR: f64 = 0.05;
/// Speed below which friction turns over, share of the synchronous speed.
const TURNS_OVER: f64 = 0.01;

impl Action {
    /// Hooks in which it takes part.
    pub fn hooks(self) -> &'static [Hook] {
        match self.place {
            Place::Magnetizing if self.coordinate == Coordinate::Flux => &[Hook::Magnetizing],
            Place::Magnetizing | Place::Leakage => &[Hook::Parameters],
            Place::SensorSpeed | Place::SensorIa | Place::SensorIb | Place::SensorIc => {
                &[Hook::Outputs]
            }
            _ => &[Hook::Finish],
        }
    }

    /// So much of the coordinate is one on the axis of its table: flux counts in rated flux in the magnetizing hook.
    pub fn per_unit(self, rated: &Rated<f64>) -> f64 {
        match self.hooks() {
            [Hook::Magnetizing] => rated.flux(),
            _ => 1.0,
        }
    }

    /// Factor on the magnetizing current at the air-gap flux `x` (over rated flux), and its derivative.
    pub fn magnetizing(self, table: Table<'_>, x: f64) -> (f64, f64) {
        let (more, slope) = table.with_slope(x);
        match 1.0 + more > LEAST_FACTOR {
            true => (1.0 + more, slope),
            false => (LEAST_FACTOR, 0.0),
        }
    }

    /// Changes inductances from instant to instant.
    pub fn parameters(
        self,
        table: Table<'_>,
        at: &At<'_>,
        i_s: Complex64,
        now: &mut Instantaneous,
    ) {
        if self.place == Place::Magnetizing {
            let more = table.at(self.of_supply(at));
            now.motor.l_m /= (1.0 + more).max(LEAST_FACTOR);
            return;
        }
        let (l_ls, l_lr) = (now.motor.l_ls, now.motor.l_lr);
        let mut scale = |x: f64| {
            let f = (1.0 + table.at(x)).max(LEAST_FACTOR);
            (now.motor.l_ls, now.motor.l_lr) = (l_ls * f, l_lr * f);
            Linear::new(&now.motor).winding(at.psi_s, at.psi_r).i_s
        };
        if self.coordinate != Coordinate::Current {
            scale(self.of_supply(at));
            return;
        }
        let mut i_s = i_s;
        // The current depends on the leakage that depends on it: three rounds reach 1e-3 of the change.
        for _ in 0..3 {
            i_s = scale(length(i_s));
        }
    }

    /// Coordinates that need no current.
    fn of_supply(self, at: &At<'_>) -> f64 {
        match self.coordinate {
            Coordinate::Slip => at.slip() * at.omega_sync / TAU,
            Coordinate::Frequency => at.omega_sync / TAU,
            Coordinate::Speed => at.omega_mech,
            Coordinate::Angle => at.theta_mech,
            _ => at.t,
        }
    }

    /// Value of the curve where the motor is.
    fn value(self, table: Table<'_>, at: &At<'_>, flow: &Flow) -> f64 {
        let x = match self.coordinate {
            Coordinate::Angle => return table.at_angle(at.theta_mech),
            Coordinate::AngleElectrical => return table.at_angle(flow.terminal.supply.arg()),
            Coordinate::Current if self.place == Place::Rotor => length(flow.winding.i_r),
            Coordinate::Current => length(flow.winding.i_s),
            Coordinate::Flux => length(at.psi_s - flow.winding.i_s * at.motor.l_ls),
            Coordinate::Voltage => length(flow.terminal.supply),
            Coordinate::LoadTorque => flow.tau_load,
            _ => self.of_supply(at),
        };
        table.at(x)
    }

    /// Changes the rates of the state.
    pub fn finish(self, table: Table<'_>, at: &At<'_>, flow: &Flow, rates: &mut Rates<'_>) {
        match self.place {
            Place::Torque => rates.omega_mech -= self.value(table, at, flow) / flow.inertia,
            Place::Friction => {
                let sign = (at.omega_mech / (TURNS_OVER * at.rated.speed())).tanh();
                rates.omega_mech -= sign * self.value(table, at, flow) / flow.inertia;
            }
            Place::Rotor => {
                let more = self.value(table, at, flow).max(LEAST_FACTOR - 1.0);
                rates.psi_r -= flow.winding.i_r * (flow.winding.r_r * more);
            }
            _ => rates.psi_s -= self.drop(table, at, flow),
        }
    }

    /// Voltage drop in the stator circuit, V.
    fn drop(self, table: Table<'_>, at: &At<'_>, flow: &Flow) -> Complex64 {
        let (i, r_s) = (flow.terminal.i, flow.winding.r_s);
        if self.coordinate == Coordinate::PhaseCurrent {
            let drops = phases(i).map(|x| table.at(x));
            return match self.place.phase() {
                Some(phase) => clarke(only(phase, drops[phase])),
                None => clarke(drops),
            };
        }
        let more = self.value(table, at, flow);
        match self.place.phase() {
            Some(phase) => clarke(only(phase, r_s * more * phases(i)[phase])),
            None => i * (r_s * more),
        }
    }

    /// Turns true outputs into what the instruments show.
    pub fn outputs(self, table: Table<'_>, outputs: &mut Outputs) {
        let time = |k: usize| outputs.t_start + outputs.t_sample * k as f64;
        if let Some(phase) = self.place.phase() {
            for k in 0..outputs.i_s_abc.len() {
                let i = outputs.i_s_abc[k][phase];
                let x = match self.coordinate {
                    Coordinate::Time => time(k),
                    _ => i,
                };
                outputs.i_s_abc[k][phase] = i * (1.0 + table.at(x));
            }
            return;
        }
        for k in 0..outputs.omega_mech.len() {
            let more = match self.coordinate {
                Coordinate::Angle => table.at_angle(outputs.theta_mech[k]),
                Coordinate::Time => table.at(time(k)),
                _ => table.at(outputs.omega_mech[k]),
            };
            outputs.omega_mech[k] *= 1.0 + more;
        }
    }
}

/// Phase quantities of which only one is there.
fn only(phase: usize, value: f64) -> [f64; 3] {
    let mut abc = [0.0; 3];
    abc[phase] = value;
    abc
}

/// A curve in some form (knots, modes, a formula) at a place over a coordinate: an [`Effect`] by its table.
pub trait Law: SteadyEffect {
    /// Where it acts, over what.
    fn action(&self) -> Action;

    /// The curve for the values `p`, as [`super::tabulated`] writes it.
    fn table(&self, p: &[f64], rated: &Rated<f64>) -> Vec<f64>;

    /// Number of knots of a curve that a motor file holds; `None` for a form that only a fit has.
    fn knots(&self) -> Option<usize> {
        None
    }

    /// Prior standard deviation of a size, in typical sizes, where it is not that of all sizes.
    fn deviation(&self, _p: &[f64], _parameter: usize) -> Option<f64> {
        None
    }
}

impl<L: Law> Effect for L {
    fn hooks(&self) -> &'static [Hook] {
        self.action().hooks()
    }

    fn law(&self) -> Option<(Action, usize)> {
        Some((self.action(), self.knots()?))
    }

    fn prepared(&self, p: &[f64], rated: &Rated<f64>) -> Vec<f64> {
        self.table(p, rated)
    }

    fn prior_deviation(&self, p: &[f64], parameter: usize) -> Option<f64> {
        self.deviation(p, parameter)
    }

    fn parameters(&self, p: &[f64], at: &At<'_>, i_s: Complex64, now: &mut Instantaneous) {
        self.action().parameters(Table::of(p), at, i_s, now);
    }

    fn magnetizing(&self, p: &[f64], x: f64) -> (f64, f64) {
        self.action().magnetizing(Table::of(p), x)
    }

    fn finish(&self, p: &[f64], at: &At<'_>, flow: &Flow, rates: &mut Rates<'_>) {
        self.action().finish(Table::of(p), at, flow, rates);
    }

    fn outputs(&self, p: &[f64], _rated: &Rated<f64>, outputs: &mut Outputs) {
        self.action().outputs(Table::of(p), outputs);
    }
}
