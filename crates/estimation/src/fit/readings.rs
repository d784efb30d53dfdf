//! What is read off a trial when it is asked for, once.

use crate::data::study::{Study, Trial};
use crate::fit::{polish, uncertainty};
use crate::proof::off;
use nalgebra::DMatrix;

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
}
