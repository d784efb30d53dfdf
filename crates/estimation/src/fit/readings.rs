//! What is read off a trial when it is asked for, once.

use crate::data::study::{Study, Trial};
use crate::fit::uncertainty::coordinate_error;
use crate::fit::{polish, uncertainty};
use crate::model::prior::{FRICTION, N_NOMINAL, NOMINALS};
use crate::proof::off;
use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::Serialize;

/// A parameter that two recordings ask for differently.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct DifferenceReport {
    /// Name of the parameter.
    pub name: String,
    /// From the first recording to the second, percent.
    pub change_percent: f64,
}

impl Study {
    /// Covariance of the fitted coordinates of a trial, in their order.
    pub fn covariance<'a>(&self, trial: &'a Trial) -> &'a DMatrix<f64> {
        let of_fit = || uncertainty::covariance(self, &trial.fit);
        trial.covariance.get_or_init(of_fit)
    }

    /// The trial from which the parameters of a motor are read: refitted beside the errors of the voltage channels.
    pub fn polished<'a>(&self, trial: &'a Trial) -> &'a Trial {
        let refit = || polish::polished(self, trial).map(Box::new);
        trial
            .polished
            .get_or_init(refit)
            .as_deref()
            .unwrap_or(trial)
    }

    /// Indices of the nominals of a trial that are off.
    pub fn off<'a>(&self, trial: &'a Trial) -> &'a [usize] {
        trial
            .off
            .get_or_init(|| off::nominals(self, self.polished(trial)))
    }

    /// The nominals but friction that two studies of one motor read differently, beyond the errors of both.
    pub fn differences(&self, here: &Trial, other: &Self, there: &Trial) -> Vec<DifferenceReport> {
        let read = |study: &Self, trial: &Trial, k: usize| {
            let error = coordinate_error(trial, study.covariance(trial), k);
            (trial.fit.hypothesis.z[k], error)
        };
        let difference = |k: usize| {
            let (from, error) = read(self, here, k);
            let (to, other_error) = read(other, there, k);
            let is_far = (to - from).abs() > off::SIGNIFICANT * error.hypot(other_error);
            is_far.then(|| DifferenceReport {
                name: NOMINALS[k].name.to_owned(),
                change_percent: 100.0 * (to - from).exp_m1(),
            })
        };
        let is_free = |&k: &usize| here.fit.free.contains(&k) && k != FRICTION;
        (0..N_NOMINAL)
            .filter(is_free)
            .filter_map(difference)
            .collect()
    }
}
