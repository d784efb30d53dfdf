//! Which parameters of the motor file are off.

use crate::data::study::{Study, Trial};
use crate::fit::output_error::{Effort, Fit, fit, fit_near};
use crate::fit::uncertainty::coordinate_error;
use crate::model::prior::{FRICTION, Hypothesis, MAGNETIZING, N_NOMINAL, NOMINALS};
use crate::proof::accept::worse;
use motor::effect::Nominal;

/// A parameter is off when it moved by more than so many standard errors ...
pub const SIGNIFICANT: f64 = 3.0;
/// ... and by more than this share ...
pub const RELEVANT: f64 = 0.05;
/// ... or, for friction, by more than this per cent of rated torque, ...
pub const RELEVANT_FRICTION: f64 = 2.0;
/// ... where the recording leaves at most this share of the variance of the prior, ...
const LEFT_OPEN: f64 = 0.1;

/// A move beyond so many prior standard deviations is implausible, ...
const IMPLAUSIBLE: f64 = 3.0;
/// ... but copper at 150 degC has 1.51 times its resistance at 20 degC: ln 1.51 more upwards.
const HOT_COPPER: f64 = 0.41;

/// 95 % of a normal distribution lie within so many standard deviations.
const TWO_SIDED_95: f64 = 1.96;

/// Indices of the nominals that are off: moved far, known well, and with the parameter held at its prior and all others
/// refitted the data that were not fitted are explained significantly worse, or only by stranger parameters.
pub fn nominals(study: &Study, trial: &Trial) -> Vec<usize> {
    let free = |k: &usize| trial.fit.free.contains(k);
    let candidates = (0..N_NOMINAL)
        .filter(free)
        .filter(|&k| moved(study, trial, k));
    let deviations = &study.prior.deviations;
    let needed = |&k: &usize| {
        let held = held(study, trial, k);
        worse(study, &held, trial)
            || strains(&held, deviations) > strains(trial, deviations) + SIGNIFICANT.powi(2)
    };
    candidates.filter(needed).collect()
}

/// How far the nominals of a trial are from their priors: sum of squares, in prior standard deviations.
///
/// One operating point never shows all of them: held at its prior, a parameter can be replaced by others. They do not
/// explain the recording if they have to leave their priors further than the parameter itself.
pub fn strains(trial: &Trial, deviations: &[f64; N_NOMINAL]) -> f64 {
    let nominals = trial.fit.hypothesis.z.iter().zip(deviations);
    nominals.map(|(z, deviation)| (z / deviation).powi(2)).sum()
}

/// Indices of the nominals that are off so far that no such motor has them.
pub fn implausible(study: &Study, trial: &Trial) -> Vec<usize> {
    let z = &study.polished(trial).fit.hypothesis.z;
    let far = |&k: &usize| {
        let limit = IMPLAUSIBLE * study.prior.deviations[k];
        let warm = if NOMINALS[k].unit == "ohm" {
            HOT_COPPER
        } else {
            0.0
        };
        k != FRICTION && !(-limit..limit + warm).contains(&z[k])
    };
    let off = study.off(trial).iter().copied();
    off.filter(far).collect()
}

/// The trial with one nominal held at its prior and everything else refitted.
pub fn held(study: &Study, trial: &Trial, k: usize) -> Trial {
    let mut frozen = trial.fit.hypothesis.clone();
    frozen.z[k] = 0.0;
    frozen.free[k] = false;
    study.measured(fitted_near(study, &trial.fit, &frozen, k))
}

/// Fits a start that differs from a fit in coordinate `k`, which is free there and held here: the derivatives there lead near the minimum.
fn fitted_near(study: &Study, there: &Fit, start: &Hypothesis, k: usize) -> Fit {
    let (case, prior) = (&study.fitted.case, &study.prior);
    let is_alike = there.observer == Effort::FULL.observer;
    let Some(column) = there.free.iter().position(|&f| f == k).filter(|_| is_alike) else {
        return fit(case, prior, start, Effort::FULL);
    };
    let mut nearby = there.jacobian.clone();
    nearby.remove(column);
    fit_near(case, prior, start, Effort::FULL, &nearby)
}

/// Whether nominal `k` moved relevantly and significantly, and is known from the recording.
fn moved(study: &Study, trial: &Trial, k: usize) -> bool {
    let mut effects = trial.fit.hypothesis.effects.iter();
    let redefined = effects.any(|e| e.effect.redefines() == Some(Nominal::Magnetizing));
    if k == MAGNETIZING && redefined {
        return false;
    }
    let z = trial.fit.hypothesis.z[k];
    let relevant = match k {
        FRICTION => z.abs() > RELEVANT_FRICTION,
        _ => z.exp_m1().abs() > RELEVANT,
    };
    let error = coordinate_error(trial, study.covariance(trial), k);
    let known = error * error < LEFT_OPEN * study.prior.deviations[k].powi(2);
    relevant && known && z.abs() > SIGNIFICANT * error && !expected(study, k, z)
}

/// Whether the motor file holds the parameter in an interval with this value inside: learnt, not off.
fn expected(study: &Study, k: usize, z: f64) -> bool {
    let deviation = study.prior.deviations[k];
    deviation > NOMINALS[k].prior_deviation && z.abs() < TWO_SIDED_95 * deviation
}

#[cfg(test)]
mod tests;
