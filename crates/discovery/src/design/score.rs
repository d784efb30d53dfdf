//! How far a run keeps explanations apart, after everything was refitted to old and new recordings together.

use estimation::data::case::Case;
use estimation::data::channels::N_CHANNELS;
use estimation::data::study::{Study, Trial};
use estimation::fit::normal_equations::{self, Block};
use estimation::model::differences::jacobian;
use estimation::model::prediction::{SpeedObserver, outputs};
use estimation::model::prior::Hypothesis;
use nalgebra::DMatrix;
use std::ops::Range;

/// What the recordings know already about the coordinates of a fit.
pub(super) fn known(trial: &Trial) -> DMatrix<f64> {
    let all = normal_equations::total(&trial.fit.blocks);
    all.gram + DMatrix::from_diagonal(&trial.fit.penalty.weight)
}

/// Refits the parameters of a model, linearised, to what it would have shown beside a further effect.
pub(super) struct Refit {
    jacobian: Vec<Vec<f64>>,
    known: DMatrix<f64>,
}

impl Refit {
    /// Of the fitted recording.
    pub fn of(study: &Study, trial: &Trial) -> Self {
        let (case, fit) = (&study.fitted.case, &trial.fit);
        let off = SpeedObserver::Off;
        Self {
            jacobian: jacobian(case, &study.prior, &fit.hypothesis, &fit.outputs, off),
            known: known(trial),
        }
    }

    /// The model of `trial` with a further effect and the parameters with which the fitted recording looks the same as
    /// without it, as far as they can: an effect that was there all the time.
    pub fn hidden(&self, study: &Study, trial: &Trial, mut with: Hypothesis) -> Hypothesis {
        let case = &study.fitted.case;
        let there = outputs(case, &study.prior, &with, SpeedObserver::Off);
        let change: Vec<f64> = trial
            .fit
            .outputs
            .iter()
            .zip(&there)
            .map(|(y, t)| y - t)
            .collect();
        let whole = 0..change.len() / N_CHANNELS;
        let blocks =
            normal_equations::blocks(std::slice::from_ref(&whole), &change, &self.jacobian);
        let Some(solver) = nalgebra::Cholesky::new(self.known.clone()) else {
            return with;
        };
        let step = solver.solve(&blocks[0].score);
        for (&k, step) in trial.fit.free.iter().zip(step.iter()) {
            let [low, high] = with.bounds(k, &study.prior);
            with.z[k] = (with.z[k] + step).clamp(low, high);
        }
        with
    }
}

/// An explanation on a run that nobody made yet.
pub(super) struct Predicted {
    outputs: Vec<f64>,
    jacobian: Vec<Vec<f64>>,
    known: DMatrix<f64>,
}

impl Predicted {
    /// Predicts a run.
    pub fn of(study: &Study, case: &Case, h: &Hypothesis, known: &DMatrix<f64>) -> Self {
        let outputs = outputs(case, &study.prior, h, SpeedObserver::Off);
        Self {
            jacobian: jacobian(case, &study.prior, h, &outputs, SpeedObserver::Off),
            known: known.clone(),
            outputs,
        }
    }

    /// All rows as one block.
    fn whole(&self) -> Range<usize> {
        0..self.outputs.len() / N_CHANNELS
    }

    /// Squared error that is left if this explains what another one is behind, its coordinates refitted to the run without
    /// forgetting what is known.
    pub fn misses(&self, truth: &[f64]) -> f64 {
        let difference: Vec<f64> = truth
            .iter()
            .zip(&self.outputs)
            .map(|(t, y)| t - y)
            .collect();
        let block = self.equations(&difference);
        let n = block.score.len();
        let step = nalgebra::Cholesky::new(&block.gram + &self.known)
            .map_or_else(|| nalgebra::DVector::zeros(n), |c| c.solve(&block.score));
        let left = block.sse - step.dot(&block.score);
        if left.is_finite() { left.max(0.0) } else { 0.0 }
    }

    /// As [`Predicted::misses`], for what another explanation predicts.
    pub fn misses_of(&self, truth: &Predicted) -> f64 {
        self.misses(&truth.outputs)
    }

    fn equations(&self, residual: &[f64]) -> Block {
        let mut blocks = normal_equations::blocks(
            std::slice::from_ref(&self.whole()),
            residual,
            &self.jacobian,
        );
        blocks.swap_remove(0)
    }

    /// Share of the variance of each coordinate that a run leaves, correlated rows counted as one `inflation`-th.
    pub fn shares_left(&self, inflation: f64) -> Vec<f64> {
        let more = self.equations(&self.outputs).gram;
        let variance = |precision: DMatrix<f64>| {
            let n = precision.nrows();
            precision
                .try_inverse()
                .unwrap_or_else(|| DMatrix::identity(n, n))
        };
        let known = &self.known / inflation;
        let before = variance(known.clone());
        let after = variance(known + more / inflation);
        (0..before.nrows())
            .map(|k| after[(k, k)] / before[(k, k)].max(f64::MIN_POSITIVE))
            .collect()
    }
}

/// Error over noise of an explanation that misses so much, over the values of old and new recordings together.
pub(super) fn error(study: &Study, case: &Case, missed: f64) -> f64 {
    let values = study.fitted.case.judged() + case.judged();
    (1.0 + missed / (values * study.fitted.floor.mean)).sqrt()
}
