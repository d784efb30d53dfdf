//! Formulas on the information of a refitted curve: amplitudes by linear algebra, shape parameters by a grid and a search.

use super::kind::Reach;
use super::quadratic::Quadratic;
use super::shape::Shape;
use crate::laws::modes::Modes;
use motor::effect::EffectConfig;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Points at which a term is turned into modes.
const POINTS: usize = 240;
/// Rounds of the search from the best point of a grid; each that finds nothing halves the step.
const ROUNDS: usize = 24;
/// Singular values of the modes below this share of the largest count as nothing.
const CUT: f64 = 1e-8;

/// A formula that was fitted on the information.
#[derive(Clone, Debug)]
pub(crate) struct Proposal {
    /// The shape.
    pub shape: &'static Shape,
    /// Coordinates of its parameters.
    pub coordinates: Vec<f64>,
    /// Amplitudes, typical sizes.
    pub amplitudes: Vec<f64>,
    /// Modes that come closest to it.
    pub modes: DVector<f64>,
    /// Squared error.
    pub error: f64,
    /// Bayesian information criterion.
    pub bic: f64,
}

/// How many independent values a squared error has, and the variance of one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weight {
    /// Values of the residual.
    pub values: f64,
    /// So many values count as one.
    pub inflation: f64,
    /// Mean square of one with the curve.
    pub variance: f64,
}

impl Weight {
    /// Criterion of a squared error with so many numbers (Schwarz, 1978, doi:10.1214/aos/1176344136).
    pub fn bic(&self, error: f64, numbers: usize) -> f64 {
        let independent = (self.values / self.inflation).max(2.0);
        error / (self.variance * self.inflation) + numbers as f64 * independent.ln()
    }
}

/// Turns terms into modes.
pub(crate) struct Projector {
    points: Vec<f64>,
    inverse: DMatrix<f64>,
    reach: Reach,
}

impl Projector {
    /// Of the law behind a configuration.
    pub fn of(config: &EffectConfig) -> Option<Self> {
        let law = Modes::of(config)?;
        let p = &config.values;
        let points: Vec<f64> = (0..POINTS)
            .map(|k| law.along(p, (k as f64 + 0.5) / POINTS as f64))
            .collect();
        let rows: Vec<_> = points
            .iter()
            .map(|&x| nalgebra::RowDVector::from_vec(law.shares(p, x)))
            .collect();
        let shares = DMatrix::from_rows(&rows);
        let largest = shares.norm();
        Some(Self {
            inverse: shares.pseudo_inverse(CUT * largest).ok()?,
            points,
            reach: Reach::of([p[0], p[1]]),
        })
    }

    /// Terms of a shape as columns of modes.
    fn terms(&self, shape: &Shape, coordinates: &[f64]) -> DMatrix<f64> {
        let n = shape.amplitudes.len();
        let mut values = DMatrix::zeros(self.points.len(), n);
        for (row, &x) in self.points.iter().enumerate() {
            let terms = shape.terms(coordinates, &self.reach, x);
            for (column, term) in terms.into_iter().enumerate() {
                values[(row, column)] = term;
            }
        }
        &self.inverse * values
    }
}

/// All shapes, the likeliest first.
pub(crate) fn propose(
    shapes: &[&'static Shape],
    projector: &Projector,
    quadratic: &Quadratic,
    weight: Weight,
) -> Vec<Proposal> {
    let one = |shape: &&'static Shape| fitted(shape, projector, quadratic, weight);
    let mut all: Vec<Proposal> = shapes.par_iter().filter_map(one).collect();
    all.sort_by(|a, b| a.bic.total_cmp(&b.bic));
    all
}

/// The best point of the grid, moved downhill.
fn fitted(
    shape: &'static Shape,
    projector: &Projector,
    quadratic: &Quadratic,
    weight: Weight,
) -> Option<Proposal> {
    let at = |coordinates: Vec<f64>| {
        let terms = projector.terms(shape, &coordinates);
        let (sizes, error) = quadratic.best(&terms)?;
        Some(Proposal {
            shape,
            coordinates,
            modes: terms * &sizes,
            amplitudes: sizes.as_slice().to_vec(),
            error,
            bic: weight.bic(error, shape.numbers()),
        })
    };
    let least = |a: &Proposal, b: &Proposal| a.error.total_cmp(&b.error);
    let mut best = shape.grid().into_iter().filter_map(at).min_by(least)?;
    let kinds = || shape.parameters.iter().map(|p| p.1);
    let mut share = 1.0;
    for _ in 0..ROUNDS {
        let near = kinds().enumerate().filter(|(_, kind)| kind.step() > 0.0);
        let moved = near.flat_map(|(k, kind)| {
            let [low, high] = kind.bounds();
            [-1.0, 1.0].map(|sign| {
                let mut there = best.coordinates.clone();
                there[k] = (there[k] + sign * share * kind.step()).clamp(low, high);
                there
            })
        });
        let next = moved.filter_map(at).min_by(least);
        match next.filter(|next| next.error < best.error) {
            Some(next) => best = next,
            None => share *= 0.5,
        }
    }
    Some(best)
}
