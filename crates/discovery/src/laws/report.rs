//! A law as a report shows it.

use crate::bursts::report::{bursts_report, corners};
use crate::laws::curve::as_knots;
use crate::laws::formula::prove::{coordinates_of, law_of};
use crate::laws::formula::report::formula_report;
use crate::laws::modes::{self, Modes};
use crate::laws::search::LawStep;
use crate::report::law::{LawCurve, LawPlace, LawReport};
use estimation::data::study::{Study, Trial};
use estimation::proof::accept::explained;
use motor::effect::curve::{Action, Coordinate, Place};
use motor::effect::to_entry;
use nalgebra::DVector;

/// Points of a reported curve.
const POINTS: usize = 61;
/// Standard deviations of the band: 95 %.
const BAND: f64 = 1.96;

/// The report of a law.
pub(crate) fn law_report(study: &Study, step: &LawStep) -> LawReport {
    let at = named(step.action);
    let formulas = step.formulas.iter();
    let formulas: Vec<_> = formulas.filter_map(|f| formula_report(study, f)).collect();
    let first = formulas.first().cloned();
    let first = first.as_ref();
    LawReport {
        tied_with: ties(step, &at),
        place: at.place,
        coordinate: at.coordinate,
        meaning: step.action.place.meaning(step.action.coordinate).to_owned(),
        curve: match step.bursts.first() {
            Some(pulses) => corners(
                study,
                step.action.place,
                &step.trial,
                pulses,
                duration(study),
            ),
            None => curve(study, &step.trial),
        },
        bursts: bursts_report(study, step.action.place, &step.trial, &step.bursts),
        formula: first.map(|f| f.formula.clone()),
        formula_parameters: first.map_or_else(Vec::new, |f| f.parameters.clone()),
        formulas,
        explained_percent: 100.0 * explained(study, &step.before, &step.trial),
        held_out_error_over_noise: study.proof_error(&step.trial),
        fold_error_over_noise: study.fold_error(&step.trial.folds),
        held_out_error_over_noise_without: study.proof_error(&step.before),
        proven: step.proven,
        entry: law_of(study, &step.trial)
            .and_then(|(_, config)| as_knots(&config))
            .map(|config| to_entry(&config)),
    }
}

/// Time from the first to the last sample of the fitted recording, s.
fn duration(study: &Study) -> f64 {
    let waveform = study.fitted.case.waveform();
    waveform.map_or(0.0, |one| one.time_of(one.measured.len().saturating_sub(1)))
}

/// Other places and coordinates, each once: friction and torque over time have one name.
fn ties(step: &LawStep, at: &LawPlace) -> Vec<LawPlace> {
    let mut ties: Vec<LawPlace> = Vec::new();
    for tie in step.rivals.iter().map(|rival| named(rival.action)) {
        if tie != *at && !ties.contains(&tie) {
            ties.push(tie);
        }
    }
    ties
}

/// Names as reports have them: a phase's own current is a current.
fn named(action: Action) -> LawPlace {
    let coordinate = match action.coordinate {
        Coordinate::PhaseCurrent => Coordinate::Current,
        coordinate => coordinate,
    };
    let place = match action.place {
        Place::Friction => Place::Torque,
        place => place,
    };
    LawPlace {
        place: place.name().to_owned(),
        coordinate: coordinate.name().to_owned(),
    }
}

/// The curve with its band.
fn curve(study: &Study, trial: &Trial) -> LawCurve {
    let Some((index, config)) = law_of(study, trial) else {
        return LawCurve::default();
    };
    let Some(law) = Modes::of(&config) else {
        return LawCurve::default();
    };
    let p = &config.values;
    let quantity = law.action.place.quantity(law.action.coordinate);
    let typical = quantity.typical * quantity.scale.of(&study.prior.plant.rated);
    let deviation = deviation(study, trial, index, law);
    let mut curve = LawCurve {
        x_unit: law.action.coordinate.unit().to_owned(),
        y_unit: quantity.unit.to_owned(),
        ..LawCurve::default()
    };
    for k in 0..POINTS {
        let x = p[0] + (p[1] - p[0]) * k as f64 / (POINTS - 1) as f64;
        let y = law.value(p, x);
        let band = BAND * typical * deviation(&law.shares(p, x));
        curve.x.push(x);
        curve.y.push(y);
        curve.lower.push(y - band);
        curve.upper.push(y + band);
    }
    curve
}

/// Standard deviation of a sum of modes, typical sizes.
fn deviation<'s>(
    study: &'s Study,
    trial: &'s Trial,
    index: usize,
    law: &Modes,
) -> impl Fn(&[f64]) -> f64 + use<'s> {
    let covariance = study.covariance(trial);
    let n = modes::count(law.action.coordinate);
    let at = coordinates_of(trial, index);
    move |shares: &[f64]| {
        if at.len() != n {
            return 0.0;
        }
        let shares = DVector::from_column_slice(shares);
        let block = nalgebra::DMatrix::from_fn(n, n, |a, b| covariance[(at[a], at[b])]);
        (shares.dot(&(&block * &shares))).max(0.0).sqrt()
    }
}
