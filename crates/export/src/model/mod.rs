//! A motor with its effects, in no language yet.

mod assemble;
mod build;
mod parameters;
mod parts;
#[cfg(test)]
mod tests;

pub(crate) use build::{check_without, label_of};

pub use build::model_of;

use crate::algebra::{Expr, Statement, Table};

/// Integration step with which our own simulation runs, s.
pub const STEP_S: f64 = 100e-6;

/// Names of the states that every model has.
pub const MOTOR_STATES: [&str; 6] = [
    "psi_s_alpha",
    "psi_s_beta",
    "psi_r_alpha",
    "psi_r_beta",
    "omega_mech",
    "theta_mech",
];

/// A number of the model that has a name, a unit and a meaning.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Its name.
    pub name: String,
    /// Its value; of a state or an input, where it begins.
    pub value: f64,
    /// Unit as printed.
    pub unit: String,
    /// What it is.
    pub meaning: String,
}

impl Quantity {
    /// A quantity.
    pub fn new(name: &str, value: f64, unit: &str, meaning: &str) -> Quantity {
        Quantity {
            name: name.to_owned(),
            value,
            unit: unit.to_owned(),
            meaning: meaning.to_owned(),
        }
    }
}

/// A function of time, states, inputs and parameters.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// What is computed on the way.
    pub statements: Vec<Statement>,
    /// What comes out.
    pub results: Vec<Expr>,
}

/// A dynamic model.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// What people call the motor.
    pub title: String,
    /// What is in it and what was left out, in lines.
    pub remarks: Vec<String>,
    /// Constants.
    pub parameters: Vec<Quantity>,
    /// Curves.
    pub tables: Vec<Table>,
    /// States, all zero at the beginning.
    pub states: Vec<Quantity>,
    /// Inputs.
    pub inputs: Vec<Quantity>,
    /// What [`Model::shown`] gives.
    pub outputs: Vec<Quantity>,
    /// Rates of change of the states, per second.
    pub derivatives: Section,
    /// What instruments show.
    pub shown: Section,
    /// Stator voltage (alpha, beta) that is decided at the beginning of a step and added during it, V. [`Model::derivatives`] then takes it
    /// by the names [`HELD`].
    pub held: Option<Section>,
    /// The effects that decide it.
    pub held_by: String,
}

/// Names of the voltage that is decided once a step.
pub const HELD: [&str; 2] = ["held_alpha", "held_beta"];
