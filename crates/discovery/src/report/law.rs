//! Laws that no library holds, with the stable keys of the JSON interface.

use crate::report::parameter::ParameterReport;
use motor::motor_file::EffectEntry;
use schemars::JsonSchema;
use serde::Serialize;

/// Where a law acts and over what.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct LawPlace {
    /// Place in the equations.
    pub place: String,
    /// Quantity that it depends on.
    pub coordinate: String,
}

/// A curve with its 95 % band.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct LawCurve {
    /// Coordinate, unit `x_unit`.
    pub x: Vec<f64>,
    /// Value there, unit `y_unit`.
    pub y: Vec<f64>,
    /// Lower end of the band.
    pub lower: Vec<f64>,
    /// Upper end of the band.
    pub upper: Vec<f64>,
    /// Unit of the coordinate.
    pub x_unit: String,
    /// Unit of the values; `-` for a relative change.
    pub y_unit: String,
}

/// A formula that explains the recordings as well as the curve of a law.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FormulaReport {
    /// Name of its shape in the dictionary.
    pub shape: String,
    /// The formula in the variable of the coordinate.
    pub formula: String,
    /// Its amplitudes and shape parameters.
    pub parameters: Vec<ParameterReport>,
    /// Held-out error over noise with the formula instead of the curve ...
    pub held_out_error_over_noise: f64,
    /// ... and by block folds of the fitted recording.
    pub fold_error_over_noise: f64,
    /// The formula as a motor file holds it.
    #[serde(skip)]
    pub entry: Option<EffectEntry>,
}

/// A law that no library holds.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LawReport {
    /// Place in the equations.
    pub place: String,
    /// Quantity that it depends on.
    pub coordinate: String,
    /// What the values of the curve are.
    pub meaning: String,
    /// Places and coordinates that explain the recordings as well.
    pub tied_with: Vec<LawPlace>,
    /// The curve.
    pub curve: LawCurve,
    /// The formula with the fewest numbers that fits as well as the curve, in the variable of the coordinate (`omega`,
    /// `theta`, `theta_u`, `slip_hz`, `i`, `psi`, `f`, `u`, `t`, `tau_load`).
    pub formula: Option<String>,
    /// Its parameters.
    pub formula_parameters: Vec<ParameterReport>,
    /// All formulas that fit as well as the curve, that one first.
    pub formulas: Vec<FormulaReport>,
    /// Share of the excess error that the law explains, percent.
    pub explained_percent: f64,
    /// Held-out error over noise with the law ...
    pub held_out_error_over_noise: f64,
    /// ... by block folds of the fitted recording ...
    pub fold_error_over_noise: f64,
    /// ... and held out without it.
    pub held_out_error_over_noise_without: f64,
    /// Whether a recording that was not fitted proves it; one recording alone gives a lead.
    pub proven: bool,
    /// What comes and goes instead of following a curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bursts: Option<BurstsReport>,
    /// The law as a motor file holds it.
    #[serde(skip)]
    pub entry: Option<EffectEntry>,
}

impl LawReport {
    /// Place and coordinate in words.
    pub fn name(&self) -> String {
        match self.bursts {
            Some(_) => format!("{} that comes and goes", self.place),
            None => format!("{} over {}", self.place, self.coordinate),
        }
    }
}

/// What comes and goes: all bursts of all recordings.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BurstsReport {
    /// How many there are.
    pub count: usize,
    /// Share of the time of the recordings that they take, percent.
    pub share_of_time_percent: f64,
    /// Smallest size ...
    pub smallest: f64,
    /// ... median ...
    pub median: f64,
    /// ... and largest.
    pub largest: f64,
    /// Unit of the sizes: ohm, N m, or percent of a reading.
    pub unit: String,
    /// Each of them.
    pub bursts: Vec<BurstReport>,
}

/// One burst.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BurstReport {
    /// Number of the recording, from 1.
    pub recording: usize,
    /// Beginning, s from the beginning of the recording.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// Size.
    pub size: f64,
}
