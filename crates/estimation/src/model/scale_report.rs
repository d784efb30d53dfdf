//! What a report says of a speed whose scale was unknown.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where the reading at rest comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AtRest {
    /// The user gave it.
    Given,
    /// The recording holds the motor at rest.
    Measured,
    /// Unknown: zero.
    Assumed,
}

/// Where the standard error of a fitted scale comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ErrorSource {
    /// The recording, which the model explains.
    Recording,
    /// The model does not explain the recording: all that is known is that the least slip lies between none and that
    /// at rated load.
    Physics,
}

/// The scale of a speed channel that was declared unknown, as fitted: speed = factor x (column - offset).
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SpeedScaleReport {
    /// Factor.
    pub factor: f64,
    /// Its standard error.
    pub std_error: f64,
    /// Where the standard error comes from.
    pub std_error_is: ErrorSource,
    /// Unit of both.
    pub unit: String,
    /// Column at rest, in the column's own unit.
    pub offset: f64,
    /// Its standard error; 0 unless it was measured.
    pub offset_std_error: f64,
    /// Where the offset comes from.
    pub offset_is: AtRest,
    /// What is taken from the channel as it was read, rad/s, before the factor is applied.
    pub at_rest_rad_s: f64,
}
