//! What the user gets, with the stable keys of the JSON interface.

use crate::design::report::DesignReport;
use crate::report::law::LawReport;
use crate::report::parameter::{NominalReport, ParameterReport};
use audit::Audit;
use estimation::data::given::Fitted;
use estimation::data::stretches::StretchReport;
pub use estimation::fit::readings::DifferenceReport;
use estimation::model::scale_report::SpeedScaleReport;
use estimation::proof::channels::ChannelsReport;
use estimation::proof::windings::WindingsReport;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The answer of an explanation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[schemars(rename = "ExplainVerdict")]
pub enum Verdict {
    /// The model explains the recording; parameters may have moved.
    Adequate,
    /// An effect is missing and was found.
    Effect,
    /// An effect is missing; several explain the recording equally well.
    Ambiguous,
    /// Something is missing that the library does not hold.
    Unknown,
    /// The recording cannot be judged.
    #[default]
    Unsupported,
    /// The recording is explained only by parameters that no such motor has.
    Implausible,
    /// A law is missing that the library does not hold; place, coordinate and curve were found and proven.
    Law,
}

/// One effect that was added.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct StepReport {
    /// Name of the effect.
    pub effect: String,
    /// Form of the effect, empty for the only one.
    pub form: String,
    /// Kind of answer: physics, sensor or supply.
    pub kind: String,
    /// Effects or parameters that explain the recording as well.
    pub tied_with: Vec<String>,
    /// The test that would separate them.
    pub separating_test: String,
    /// What a person sees when the effect is missing.
    pub symptom: String,
    /// Held-out error over noise with the effect.
    pub held_out_error_over_noise: f64,
    /// Error over noise by block folds of the fitted recording.
    pub fold_error_over_noise: f64,
    /// Share of the excess error that the effect explains, percent.
    pub explained_percent: f64,
    /// Power that it takes at rated voltage and synchronous speed, W, if it is a loss.
    pub loss_watt: Option<f64>,
    /// Its parameters.
    pub parameters: Vec<ParameterReport>,
    /// What the frame of the monitor's model costs, if that is what the step is about.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<FrameReport>,
}

/// A model's error and parameters.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FitReport {
    /// Held-out error over noise.
    pub held_out_error_over_noise: f64,
    /// Error over noise by block folds of the fitted recording.
    pub fold_error_over_noise: f64,
    /// Nominal parameters.
    pub parameters: Vec<NominalReport>,
    /// Recordings that prove in which the windings had other resistances.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub windings: Vec<WindingsReport>,
}

/// An effect in the ranking of the first screen.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RankReport {
    /// Name of the effect.
    pub effect: String,
    /// Held-out error over noise, linearised unless refitted.
    pub held_out_error_over_noise: f64,
    /// Gain against the refitted model without it, percent.
    pub gain_percent: f64,
    /// Whether the effect was refitted.
    pub refitted: bool,
    /// Share of the noise floor that a typical size would show in this recording, percent.
    pub visibility_percent: f64,
}

/// What is left when nothing in the library explains the recording.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Unexplained {
    /// A colleague's description.
    pub description: String,
    /// Quantities with which the remaining error grows, the strongest first.
    pub correlates_with: Vec<String>,
    /// The best lead, if any.
    pub best_lead: Option<String>,
    /// Share of the excess that the best lead explains, percent.
    pub best_lead_explains_percent: f64,
    /// Where each of two recordings alone is explained with nothing missing: parameters that differ from the first to the second.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub each_alone: Option<Vec<DifferenceReport>>,
}

/// Share of the excess, percent, from which an effect that is not proven leaves nothing to look for outside the library.
const SUFFICES_PERCENT: f64 = 85.0;

impl Unexplained {
    /// The best lead, if it would explain what is missing; too few moments of the recording show it to prove it.
    pub fn sufficient_lead(&self) -> Option<&str> {
        let lead = self.best_lead.as_deref();
        lead.filter(|_| self.best_lead_explains_percent > SUFFICES_PERCENT)
    }
}

/// Something that cannot be concluded while the scale of the speed is free.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Inconclusive {
    /// A parameter of the motor file, a quantity or an effect.
    pub name: String,
    /// Which of the three: `parameter`, `quantity`, `effect`.
    pub kind: String,
    /// Standard error, percent of the value (friction: of rated torque at rated speed).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub std_error_percent: Option<f64>,
    /// What the standard error would be if the scale were known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub std_error_with_known_scale_percent: Option<f64>,
    /// Correlation of the estimates of the parameter and of the sensor's gain.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correlation_with_scale: Option<f64>,
    /// The same in words.
    pub why: String,
}

/// The report of `explain`; that of a recording that was not judged holds nothing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct ExplainReport {
    /// Audit of the fitted recording.
    pub audit: Audit,
    /// Of recordings that were too long to be kept: what of them is fitted, and what proves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stretches: Vec<StretchReport>,
    /// Which recordings are fitted, where it is not as they are given.
    #[serde(default, skip_serializing_if = "Fitted::is_as_given")]
    pub fitted: Fitted,
    /// The answer.
    pub verdict: Verdict,
    /// One sentence that says it.
    pub summary: String,
    /// What the recorder's channels are off by, where it is part of the answer: then all models below are beside it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channels: Option<ChannelsReport>,
    /// The model with refitted parameters and nothing added.
    pub baseline: Option<FitReport>,
    /// Effects added, in order.
    pub steps: Vec<StepReport>,
    /// The model with everything that was found.
    #[serde(rename = "final")]
    pub final_: Option<FitReport>,
    /// All effects, best first.
    pub ranking: Vec<RankReport>,
    /// Effects that a typical size would not show in this recording.
    pub not_testable: Vec<String>,
    /// Laws that no library holds, in the order in which they were found.
    pub laws: Vec<LawReport>,
    /// What is left, if the library does not explain it.
    pub unexplained: Option<Unexplained>,
    /// The fitted scale of the speed, where it was declared unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_scale: Option<SpeedScaleReport>,
    /// What cannot be concluded because of it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cannot_be_concluded: Vec<Inconclusive>,
    /// The next experiment, where it was asked for and something is open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub next_run: Option<DesignReport>,
}

impl ExplainReport {
    /// Error over noise of data that was not fitted, of the refitted model and of each thing that was added to it, in order.
    pub fn errors(&self) -> Vec<(String, f64)> {
        let refitted = self.baseline.iter().map(|baseline| {
            let beside = match self.channels {
                Some(_) => "with what the channels are off by",
                None => REFITTED,
            };
            (beside.to_owned(), baseline.held_out_error_over_noise)
        });
        let channels = self.channels.iter();
        let without = channels.map(|c| (REFITTED.to_owned(), c.held_out_error_over_noise_without));
        let steps = self.steps.iter().filter(|step| step.frame.is_none());
        let steps = steps.map(|step| {
            (
                format!("with {}", step.effect),
                step.held_out_error_over_noise,
            )
        });
        let laws = self.laws.iter().filter(|law| law.proven);
        let laws = laws.map(|law| {
            (
                format!("with {}", law.name()),
                law.held_out_error_over_noise,
            )
        });
        without.chain(refitted).chain(steps).chain(laws).collect()
    }
}

/// The model with nothing added.
const REFITTED: &str = "all parameters refitted";

/// One signal: model against measurement.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SignalReport {
    /// Channel.
    pub name: String,
    /// Unit of the next three.
    pub unit: String,
    /// Rms of the measurement.
    pub rms: f64,
    /// Rms of the difference.
    pub error_rms: f64,
    /// Rms of the difference if nothing were missing.
    pub noise_floor: f64,
    /// Ratio of the last two.
    pub error_over_noise: f64,
}

/// A part of the recording.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RegionReport {
    /// What the machine did.
    pub name: String,
    /// Begin, s.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// Rms error over noise.
    pub error_over_noise: f64,
}

/// A class of operating points, spread over the recording.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BandReport {
    /// What is divided: load, voltage, slip, frequency.
    pub quantity: String,
    /// Lower end, in percent of rated.
    pub from_percent: f64,
    /// Upper end, in percent of rated.
    pub to_percent: f64,
    /// Rms error over noise.
    pub error_over_noise: f64,
}

/// A rotating component of the current error.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct OrderReport {
    /// Order of the supply frequency; negative turns backwards, 0 is a constant.
    pub order: f64,
    /// Amplitude, A.
    pub amplitude_amp: f64,
}

/// Rms error over noise of everything.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Overall {
    /// Rms error over noise.
    pub error_over_noise: f64,
}

/// The residual at one load, with the parameters of the motor file.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FrameBand {
    /// Air-gap torque over rated torque, percent, to the nearest ten.
    pub load_percent: f64,
    /// Windows of steady running at this load.
    pub windows: usize,
    /// Root mean square of r1 over the voltage in the frame of the motor file, percent.
    pub r1_before_percent: f64,
    /// The same in the rotor-flux frame with live field current, percent.
    pub r1_after_percent: f64,
}

/// What the frame of the motor file costs.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FrameReport {
    /// Windows of steady running.
    pub windows: usize,
    /// Error over noise of r1 in the motor file's frame, on the proving recordings or else on the only one; its
    /// parameters explain currents and speed, r1 itself is never fitted.
    pub held_out_before: f64,
    /// The same in the rotor-flux frame.
    pub held_out_after: f64,
    /// Error over noise of r1 on the first recording before.
    pub fitted_before: f64,
    /// The same after.
    pub fitted_after: f64,
    /// Whether the gain is proven on every recording.
    pub proven: bool,
    /// By load.
    pub by_load: Vec<FrameBand>,
}

/// The report of `compare`: the motor file as it is, nothing refitted.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct CompareReport {
    /// Audit of the recording.
    pub audit: Audit,
    /// Of a recording that was too long to be kept: what of it is compared.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stretches: Vec<StretchReport>,
    /// Per channel.
    pub signals: Vec<SignalReport>,
    /// Per part of the recording, in time.
    pub regions: Vec<RegionReport>,
    /// Per band of operating points.
    pub bands: Vec<BandReport>,
    /// Per order of the supply frequency.
    pub orders: Vec<OrderReport>,
    /// Everything.
    pub overall: Option<Overall>,
    /// The fitted scale of the speed, where it was declared unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_scale: Option<SpeedScaleReport>,
    /// What cannot be concluded because of it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cannot_be_concluded: Vec<Inconclusive>,
}

/// Errors before or after an adoption.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ErrorReport {
    /// Rms error over noise on the fitted data.
    pub error_over_noise: f64,
    /// Rms error over noise on data that was not fitted.
    pub held_out_error_over_noise: f64,
}

/// The report of `adopt`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct AdoptReport {
    /// Audit of the fitted recording.
    pub audit: Audit,
    /// Of recordings that were too long to be kept: what of them is fitted, and what proves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stretches: Vec<StretchReport>,
    /// Which recordings are fitted, where it is not as they are given.
    #[serde(default, skip_serializing_if = "Fitted::is_as_given")]
    pub fitted: Fitted,
    /// The effect.
    pub effect: String,
    /// The refitted model without it.
    pub before: ErrorReport,
    /// The refitted model with it.
    pub after: ErrorReport,
    /// Whether the gain is proven on data that was not fitted.
    pub proven: bool,
    /// Its parameters.
    pub parameters: Vec<ParameterReport>,
    /// Nominal parameters of the new motor file.
    pub nominals: Vec<NominalReport>,
    /// Where the new motor file was written; empty until it is.
    pub motor_file: String,
    /// What the frame of the monitor's model cost, if that is what was adopted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<FrameReport>,
    /// The laws that were adopted.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub laws: Vec<LawReport>,
    /// The fitted scale of the speed, where it was declared unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_scale: Option<SpeedScaleReport>,
    /// What cannot be concluded because of it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cannot_be_concluded: Vec<Inconclusive>,
}
