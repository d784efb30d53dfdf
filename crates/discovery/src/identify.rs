//! Parameters from recordings, with the intervals of the motor file as prior.

use audit::Audit;
use motor::MotorFile;
use motor::motor_file::{ParameterInterval, Uncertainty};
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::{Progress, as_believed, errors, updated};
use crate::report::present::{effect_parameters, fit_report};
use crate::report::types::ErrorReport;
use estimation::data::given::Sources;
use estimation::data::question::{Error, Question};
use estimation::data::stretches::StretchReport;
use estimation::data::study::{Study, Trial};
use estimation::model::prior::{FRICTION, LEAKAGE, NOMINALS};

/// Parameters before and after, and what would tell those that the recordings did not.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct IdentifyReport {
    /// Audit of the fitted recording.
    pub audit: Audit,
    /// Of recordings that were too long to be kept: what of them is fitted, and what proves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stretches: Vec<StretchReport>,
    /// Errors of the motor file as it was.
    pub before: ErrorReport,
    /// Errors with the parameters found.
    pub after: ErrorReport,
    /// Every parameter that was refitted.
    pub parameters: Vec<IdentifiedParameter>,
}

/// One parameter with its 95 % intervals.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct IdentifiedParameter {
    /// Key in the motor file.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// As the motor file had it.
    pub believed: f64,
    /// As found.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Whether the recordings narrowed the interval to half or less.
    pub told: bool,
    /// The recording that would tell it, where these did not.
    pub would_tell: Option<String>,
}

/// An interval narrowed to less than this share of the prior's was told by the recordings.
const TOLD: f64 = 0.5;
/// Logarithms with a greater standard deviation are as good as unknown.
const WIDEST: f64 = 1.5;
/// 95 % of a normal distribution lie within so many standard deviations.
const TWO_SIDED_95: f64 = 1.959_964;

/// What shows each nominal parameter best, in the order of [`NOMINALS`].
const WOULD_TELL: [&str; NOMINALS.len()] = [
    "a recording at full load, or the DC resistance of the winding",
    "a recording at full load with the speed",
    "a start, or a second load",
    "a recording without load",
    "a start or a coast-down with the speed",
    "a coast-down with the speed",
];

/// Refits the parameters of a motor file within its intervals; the new motor file carries the narrower ones.
///
/// The first source is fitted, further ones prove; with a single one folds of it prove.
///
/// # Errors
/// Wrong effects in the motor file, or sources that cannot be judged.
pub fn identify<'a>(
    sources: impl Into<Sources<'a>>,
    motor: &MotorFile,
    progress: &mut Progress<'_>,
) -> Result<(IdentifyReport, MotorFile), Error> {
    let question = Question::new(sources, motor, progress)?;
    let study = &question.study;
    progress("refitting the parameters", 0.3);
    let trial = study.at_one_temperature(study.refitted());
    progress("standard errors", 0.8);
    let parameters = parameters(study, &trial);
    let mut file = updated(study, &trial, motor);
    file.uncertainty = Some(intervals(motor, &file, &parameters));
    let report = IdentifyReport {
        audit: question.audit.clone(),
        stretches: question.stretches.clone(),
        before: errors(study, &as_believed(study)),
        after: errors(study, &trial),
        parameters,
    };
    progress("done", 1.0);
    Ok((report, file))
}

fn parameters(study: &Study, trial: &Trial) -> Vec<IdentifiedParameter> {
    let nominals = fit_report(study, trial).parameters.into_iter().enumerate();
    let nominals = nominals.filter(|(k, _)| trial.fit.free.contains(k));
    let of_motor = nominals.map(|(k, n)| {
        let prior = match k {
            FRICTION => study.prior.deviations[k] * study.prior.friction_unit,
            _ => study.prior.deviations[k] * n.believed,
        };
        identified(Found {
            name: n.name,
            unit: n.unit,
            believed: n.believed,
            value: n.value,
            error: n.std_error,
            prior,
            would_tell: WOULD_TELL[k],
        })
    });
    let first = usize::from(study.speed_scale.is_some());
    let effects = study.prior.uncertain.iter().enumerate();
    let of_effects = effects.flat_map(|(k, effect)| {
        let descriptor = effect.config.effect.descriptor();
        let found = effect_parameters(study, trial, first + k)
            .into_iter()
            .enumerate();
        found.filter_map(move |(place, p)| {
            let believed = descriptor.parameters[place].to_file(effect.config.values[place]);
            Some(identified(Found {
                prior: effect.deviations[place]? * believed,
                name: p.name,
                unit: p.unit,
                believed,
                value: p.value,
                error: p.std_error,
                would_tell: descriptor.separating_test,
            }))
        })
    });
    of_motor.chain(of_effects).collect()
}

/// One parameter as the fit left it; errors and priors in its own unit.
struct Found {
    name: String,
    unit: String,
    believed: f64,
    value: f64,
    error: f64,
    prior: f64,
    would_tell: &'static str,
}

fn identified(found: Found) -> IdentifiedParameter {
    let told = found.error < TOLD * found.prior;
    let relative = found.error / found.value.abs().max(f64::MIN_POSITIVE);
    let half = TWO_SIDED_95 * found.error;
    // What is above zero has an interval of its logarithm; friction may be nothing.
    let (low, high) = if found.value > 0.0 {
        let factor = (TWO_SIDED_95 * relative.min(WIDEST)).exp();
        (
            found.value / factor,
            (found.value * factor).max(found.value + half),
        )
    } else {
        (0.0, half)
    };
    IdentifiedParameter {
        name: found.name,
        unit: found.unit,
        believed: found.believed,
        value: found.value,
        low,
        high,
        told,
        would_tell: (!told).then(|| found.would_tell.to_owned()),
    }
}

/// Smallest lower end that a motor file takes.
const LEAST: f64 = 1e-12;

/// The intervals of the old file with the new ones in their place; correlations hold for the old ones alone.
fn intervals(old: &MotorFile, file: &MotorFile, parameters: &[IdentifiedParameter]) -> Uncertainty {
    let mut uncertainty = old.uncertainty.clone().unwrap_or_default();
    uncertainty.correlations.clear();
    let mut set = |key: &str, low: f64, high: f64| {
        uncertainty.intervals.retain(|interval| interval.key != key);
        uncertainty.intervals.push(ParameterInterval {
            key: key.to_owned(),
            low: low.max(LEAST),
            high: high.max(LEAST),
        });
    };
    for p in parameters
        .iter()
        .filter(|p| p.high > 0.0 && p.value.is_finite())
    {
        if p.name == NOMINALS[LEAKAGE].name {
            let (l_ls, l_lr) = (file.parameters.l_ls, file.parameters.l_lr);
            for (key, leakage) in [
                ("stator_leakage_henry", l_ls),
                ("rotor_leakage_henry", l_lr),
            ] {
                set(key, leakage * p.low / p.value, leakage * p.high / p.value);
            }
        } else {
            set(&p.name, p.low, p.high);
        }
    }
    let of_effect = |key: &str| {
        file.effects
            .iter()
            .any(|effect| effect.number(key).is_some())
    };
    uncertainty
        .intervals
        .retain(|interval| is_nominal(&interval.key) || of_effect(&interval.key));
    uncertainty
}

fn is_nominal(key: &str) -> bool {
    key == "rotor_leakage_henry" || NOMINALS.iter().any(|nominal| nominal.name == key)
}
