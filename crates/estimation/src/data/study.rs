//! The recordings of one question: the first is fitted, the others prove.

use crate::data::case::Case;
use crate::data::joined::together;
use crate::data::noise_floor::{by_channel, judged_of};
pub use crate::data::subject::Subject;
use crate::data::subject::{AS_WARM, Warmth, warmed};
use crate::fit::output_error::{Effort, Fit, fit, fit_near};
use crate::model::free_scale::{self, FreeScale};
use crate::model::instruments::InstrumentError;
use crate::model::late_speed::Lateness;
use crate::model::prediction::{SpeedObserver, outputs};
use crate::model::prior::{Hypothesis, Prior};
use nalgebra::DMatrix;
use std::sync::OnceLock;

/// Mean squared difference of two predictions, in units of the floor, that no proof can resolve: a hundredth moves the
/// error by half a per cent.
const SILENT: f64 = 0.01;

/// Everything that stays the same while hypotheses come and go.
#[derive(Clone, Debug)]
pub struct Study {
    /// What the user believes.
    pub prior: Prior,
    /// Recording that is fitted.
    pub fitted: Subject,
    /// Recordings that prove.
    pub proofs: Vec<Subject>,
    /// How the speed channel becomes a speed, where its scale is a free parameter.
    pub speed_scale: Option<FreeScale>,
    /// The same with the instruments taken as they are, where this study takes what they are off by as unknown.
    pub plain: Option<Box<Plain>>,
}

/// A study that takes the instruments as they are.
#[derive(Clone, Debug)]
pub struct Plain {
    /// The study.
    pub study: Study,
    /// Its refitted model.
    pub refitted: Trial,
    /// What instruments may be off by, each one standard deviation large.
    pub errors: Vec<InstrumentError>,
}

/// A hypothesis, fitted and measured on data that was not fitted.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The fit.
    pub fit: Fit,
    /// Held-out squared error of each block of the fitted recording (folds).
    pub folds: Vec<f64>,
    /// Squared error of each block of the proving recordings, one after the other.
    pub proof: Vec<f64>,
    /// By how much the windings' resistances differ in each proving recording.
    pub warmth: Vec<Warmth>,
    /// Covariance of the fitted coordinates, once it was asked for.
    pub covariance: OnceLock<DMatrix<f64>>,
    /// Nominals that are off, once they were asked for.
    pub off: OnceLock<Vec<usize>>,
    /// The same beside the errors of the voltage channels, once it was asked for.
    pub polished: OnceLock<Option<Box<Trial>>>,
    /// Squared error over noise that unknown instruments take from it, once it was asked for.
    pub taken_by_instruments: OnceLock<f64>,
}

impl Study {
    /// Prepares the floors.
    pub fn new(
        prior: Prior,
        fitted: Case,
        proofs: Vec<Case>,
        speed_scale: Option<FreeScale>,
    ) -> Self {
        let subject = |case| Subject::new(case, &prior);
        Self {
            fitted: subject(fitted),
            proofs: proofs.into_iter().map(subject).collect(),
            prior,
            speed_scale,
            plain: None,
        }
    }

    /// All recordings fitted together, so that none proves; `None` where they do not suit.
    pub fn together(&self) -> Option<Self> {
        let all = std::iter::once(&self.fitted).chain(&self.proofs);
        let cases = all.map(|subject| subject.case.clone());
        let (prior, scale) = (self.prior.clone(), self.speed_scale);
        together(cases).map(|fitted| Self::new(prior, fitted, Vec::new(), scale))
    }

    /// The same with the angles as the shaft had them, by a hypothesis; `None` where the measured speeds are in time.
    pub fn with_angles_in_time(&self, h: &Hypothesis) -> Option<Self> {
        let plant = h.plant(&self.prior);
        let all = std::iter::once(&self.fitted).chain(&self.proofs);
        let waveforms = all.filter_map(|subject| subject.case.waveform());
        let lateness: Vec<Lateness> = waveforms.filter_map(|one| one.lateness(&plant)).collect();
        // One for all: a turn that begins elsewhere in each recording would be a law of its own.
        let late = Lateness::of_all(&lateness);
        let in_time = |subject: &Subject| subject.with_angle_in_time(late);
        let fitted = in_time(&self.fitted);
        let proofs: Vec<_> = self.proofs.iter().map(in_time).collect();
        let is_any = fitted.is_some() || proofs.iter().any(Option::is_some);
        let or_as_is =
            |(one, as_is): (Option<Subject>, &Subject)| one.unwrap_or_else(|| as_is.clone());
        is_any.then(|| Self {
            fitted: or_as_is((fitted, &self.fitted)),
            proofs: proofs.into_iter().zip(&self.proofs).map(or_as_is).collect(),
            ..self.clone()
        })
    }

    /// Nothing added, priors as they are; an unknown scale of the speed is free from the start.
    pub fn at_prior(&self) -> Hypothesis {
        let priors = match &self.fitted.case {
            Case::LoadTable(_) => Hypothesis::at_prior_of_table(),
            Case::Waveform(waveform) => Hypothesis::at_prior(waveform.speed_is_input),
        };
        let priors = match self.speed_scale {
            Some(_) => free_scale::free(&priors, &self.prior),
            None => priors,
        };
        priors.with_uncertain(&self.prior)
    }

    /// Effects that every hypothesis holds: they are no finding.
    pub fn given_effects(&self) -> usize {
        usize::from(self.speed_scale.is_some()) + self.prior.uncertain.len()
    }

    /// Fits a hypothesis and measures it.
    pub fn trial(&self, start: &Hypothesis, effort: Effort) -> Trial {
        self.measured(fit(&self.fitted.case, &self.prior, start, effort))
    }

    /// As [`Study::trial`], from a start near a fit with these derivatives with respect to the first free coordinates.
    pub fn trial_near(&self, start: &Hypothesis, effort: Effort, nearby: &[Vec<f64>]) -> Trial {
        let (case, prior) = (&self.fitted.case, &self.prior);
        self.measured(fit_near(case, prior, start, effort, nearby))
    }

    /// The model with its parameters refitted and nothing added.
    pub fn refitted(&self) -> Trial {
        self.trial(&self.at_prior(), Effort::FULL)
    }

    /// Measures a fit on what it has not seen.
    pub fn measured(&self, fit: Fit) -> Trial {
        let proofs = self
            .proofs
            .iter()
            .map(|s| s.proof_of(&self.prior, &fit.hypothesis));
        let (proof, warmth): (Vec<_>, _) = proofs.map(|proof| (proof.errors, proof.warmth)).unzip();
        Trial {
            folds: fit.held_out(),
            proof: proof.concat(),
            warmth,
            covariance: OnceLock::new(),
            off: OnceLock::new(),
            polished: OnceLock::new(),
            taken_by_instruments: OnceLock::new(),
            fit,
        }
    }

    /// The trial as a motor file has it, which holds one resistance for each winding: the fitted ones prove, too.
    pub fn at_one_temperature(&self, trial: Trial) -> Trial {
        let errors = |s: &Subject| s.errors(&self.prior, &trial.fit.hypothesis);
        Trial {
            proof: self.proofs.iter().flat_map(errors).collect(),
            warmth: vec![AS_WARM; self.proofs.len()],
            ..trial
        }
    }

    /// Error over noise by the folds of the fitted recording.
    pub fn fold_error(&self, sse: &[f64]) -> f64 {
        let total: f64 = sse.iter().sum();
        self.fitted
            .floor
            .error_over_noise(total, self.fitted.case.judged())
    }

    /// Error over noise on the proving recordings; by folds if there are none.
    pub fn proof_error(&self, trial: &Trial) -> f64 {
        if self.proofs.is_empty() {
            return self.fold_error(&trial.folds);
        }
        let floor = |s: &Subject| s.floor.mean * s.case.judged();
        let expected: f64 = self.proofs.iter().map(floor).sum();
        (trial.proof.iter().sum::<f64>() / expected).sqrt()
    }

    /// Whether the proving recordings cannot tell two trials apart: their predictions there differ by too little.
    pub fn proof_is_silent(&self, one: &Trial, other: &Trial) -> bool {
        let difference = |(k, s): (usize, &Subject)| {
            let run = |t: &Trial| {
                let there = warmed(&t.fit.hypothesis, t.warmth[k]);
                outputs(&s.case, &self.prior, &there, SpeedObserver::Off)
            };
            let squares = run(one)
                .into_iter()
                .zip(run(other))
                .map(|(a, b)| (a - b).powi(2));
            squares.sum::<f64>() / (s.floor.mean * s.case.judged())
        };
        !self.proofs.is_empty()
            && self
                .proofs
                .iter()
                .enumerate()
                .all(|one| difference(one) < SILENT)
    }

    /// Squared error of a fit over the floor of the fitted recording.
    pub fn excess(&self, fit: &Fit) -> f64 {
        let floor = self.fitted.floor.mean * self.fitted.case.judged();
        signal::dot(&fit.residual, &fit.residual) - floor
    }

    /// Error over noise of each current and of the speed in the fitted recording; zero where nothing is judged.
    pub fn channel_errors(&self, trial: &Trial) -> [f64; 4] {
        let (case, floor) = (&self.fitted.case, &self.fitted.floor);
        let sums = by_channel(&trial.fit.residual);
        let one = |k: usize| (sums[k] / judged_of(case, k).max(1.0) / floor.channel[k]).sqrt();
        core::array::from_fn(one)
    }

    /// Whether the fitted recording cannot tell two trials apart.
    pub fn fit_is_silent(&self, one: &Trial, other: &Trial) -> bool {
        let outputs = one.fit.outputs.iter().zip(&other.fit.outputs);
        let squares: f64 = outputs.map(|(a, b)| (a - b).powi(2)).sum();
        squares < SILENT * self.fitted.floor.mean * self.fitted.case.judged()
    }

    /// Share of the floor below which a typical effect cannot be seen in a recording.
    pub const VISIBLE: f64 = 0.02;

    /// By how much of the floor the error would rise if a signature of this size were missing.
    pub fn visibility(&self, visible: f64) -> f64 {
        let expected = self.fitted.floor.mean * self.fitted.case.judged();
        (1.0 + (visible / expected).max(0.0)).sqrt() - 1.0
    }

    /// Relative allowance of the gate for the uncertainty of the floor.
    pub fn allowance(&self) -> f64 {
        let all = std::iter::once(&self.fitted).chain(&self.proofs);
        all.map(|s| s.floor.allowance()).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests;
