//! From fits to the numbers of a report.

use crate::report::parameter::{NominalReport, ParameterReport};
use crate::report::types::FitReport;
use estimation::data::study::{Study, Trial};
use estimation::fit::uncertainty::coordinate_error;
use estimation::model::prior::{FRICTION, N_NOMINAL, NOMINALS};
use motor::effect::{Kind, Role};

/// Errors and nominal parameters of a model that explains the recording: beside the errors of the channels, and which are off.
pub(crate) fn fit_report(study: &Study, trial: &Trial) -> FitReport {
    FitReport {
        windings: study.windings(trial),
        ..with_parameters(study, trial, study.polished(trial), study.off(trial))
    }
}

/// Errors and nominal parameters of a model that does not explain the recording: as they were fitted, and none is off. What is missing
/// moves them further than errors of the channels do.
pub(crate) fn inadequate_report(study: &Study, trial: &Trial) -> FitReport {
    with_parameters(study, trial, trial, &[])
}

fn with_parameters(study: &Study, trial: &Trial, polished: &Trial, off: &[usize]) -> FitReport {
    let covariance = study.covariance(polished);
    let nominal = |k: usize| {
        let z = polished.fit.hypothesis.z[k];
        let error = coordinate_error(polished, covariance, k);
        let change = if k == FRICTION { z } else { 100.0 * z.exp_m1() };
        NominalReport {
            name: NOMINALS[k].name.to_owned(),
            believed: study.prior.nominal_value(k, 0.0),
            value: study.prior.nominal_value(k, z),
            std_error: study.prior.nominal_error(k, z, error),
            unit: NOMINALS[k].unit.to_owned(),
            off: off.contains(&k),
            change_percent: change,
        }
    };
    FitReport {
        held_out_error_over_noise: study.proof_error(trial),
        fold_error_over_noise: study.fold_error(&trial.folds),
        parameters: (0..N_NOMINAL).map(nominal).collect(),
        windings: Vec::new(),
    }
}

/// Parameters of effect `index` of a trial.
pub(crate) fn effect_parameters(
    study: &Study,
    trial: &Trial,
    index: usize,
) -> Vec<ParameterReport> {
    let h = &trial.fit.hypothesis;
    let covariance = study.covariance(trial);
    let rated = &study.prior.plant.rated;
    let config = &h.configs(rated)[index];
    let descriptor = config.effect.descriptor();
    let error_of = |parameter: usize| {
        let mine = |&k: &usize| h.effect_of(k) == index && h.parameter_of(k) == parameter;
        let Some(k) = (N_NOMINAL..h.z.len()).find(mine) else {
            return 0.0;
        };
        let p = &descriptor.parameters[parameter];
        let error = coordinate_error(trial, covariance, k);
        match p.role {
            Role::Size => error * p.typical * p.scale.of(rated),
            _ => error * config.values[parameter],
        }
    };
    let parameters = descriptor.parameters.iter().enumerate();
    parameters
        .map(|(n, p)| ParameterReport {
            name: p.name.to_owned(),
            value: p.to_file(config.values[n]),
            std_error: p.error_to_file(config.values[n], error_of(n)),
            unit: p.unit.to_owned(),
        })
        .collect()
}

/// The kind of answer in words.
pub(crate) fn kind_word(kind: Kind) -> &'static str {
    match kind {
        Kind::Physics => "physics",
        Kind::Sensor => "sensor",
        Kind::Supply => "supply",
    }
}

/// Power of a loss at rated voltage and synchronous speed, W; `None` for an effect that is no loss.
pub(crate) fn loss_watt(study: &Study, trial: &Trial, index: usize) -> Option<f64> {
    let rated = &study.prior.plant.rated;
    let config = &trial.fit.hypothesis.configs(rated)[index];
    config.effect.loss_watt(&config.values, rated)
}

#[cfg(test)]
mod tests;
