//! Fitted parameters, with the stable keys of the JSON interface.

use schemars::JsonSchema;
use serde::Serialize;

/// A nominal parameter, believed and fitted.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NominalReport {
    /// Key in the motor file.
    pub name: String,
    /// Value in the motor file.
    pub believed: f64,
    /// Fitted value.
    pub value: f64,
    /// Standard error of the fitted value.
    pub std_error: f64,
    /// Unit.
    pub unit: String,
    /// Whether it moved by more than three standard errors and 5 % (friction: 2 % of rated torque).
    pub off: bool,
    /// Change against the prior, percent; friction: percent of rated torque at rated speed.
    pub change_percent: f64,
}

/// A parameter of an effect.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ParameterReport {
    /// Key in the motor file.
    pub name: String,
    /// Fitted value.
    pub value: f64,
    /// Standard error.
    pub std_error: f64,
    /// Unit.
    pub unit: String,
}
