//! A formula as a report shows it.

use super::effect::Formula;
use super::prove::{Proven, coordinates_of};
use super::write::{Number, as_written, numbers, text};
use crate::report::law::FormulaReport;
use crate::report::parameter::ParameterReport;
use estimation::data::study::Study;
use motor::effect::to_entry;

/// The report of a formula; `None` where a trial holds none.
pub(crate) fn formula_report(study: &Study, proven: &Proven) -> Option<FormulaReport> {
    let trial = &proven.trial;
    let rated = &study.prior.plant.rated;
    let configs = trial.fit.hypothesis.configs(rated);
    let index = configs.iter().rposition(|c| Formula::of(c).is_some())?;
    let config = &configs[index];
    let formula = Formula::of(config)?;
    let action = formula.action;
    let quantity = action.place.quantity(action.coordinate);
    let typical = quantity.typical * quantity.scale.of(rated);
    let covariance = study.covariance(trial);
    let deviation = |at: &usize| covariance[(*at, *at)].max(0.0).sqrt();
    let own = coordinates_of(trial, index);
    let parameter = |(n, at): (Number, &usize)| ParameterReport {
        name: n.name,
        value: n.value,
        std_error: n.slope.unwrap_or(typical) * deviation(at),
        unit: n.unit.to_owned(),
    };
    Some(FormulaReport {
        shape: formula.shape.name.clone(),
        formula: text(formula, &config.values),
        parameters: numbers(formula, &config.values)
            .into_iter()
            .zip(&own)
            .map(parameter)
            .collect(),
        held_out_error_over_noise: study.proof_error(trial),
        fold_error_over_noise: study.fold_error(&trial.folds),
        entry: as_written(config).map(|config| to_entry(&config)),
    })
}
