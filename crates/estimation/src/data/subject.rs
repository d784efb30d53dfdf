//! A recording with its noise floor, and the resistances that its windings had.

use crate::data::case::Case;
use crate::data::noise_floor::{Floor, floor};
use crate::fit::normal_equations;
use crate::model::prediction::{SpeedObserver, outputs, residual};
use crate::model::prior::{Hypothesis, Prior, RESISTANCES};
use crate::model::unknown_state::unknown_state;
use nalgebra::{Matrix2, Vector2};
use rayon::prelude::*;
use std::sync::OnceLock;

/// Seed of the propagated noise: the same input gives the same bytes.
const SEED: u64 = 20_220_913;

/// Standard deviation of both resistances between two recordings, logarithm: copper and aluminium change by 0.4 % per kelvin, and 25 K are
/// common ...
const BOTH: f64 = 0.1;
/// ... and of the cage's alone, as calibrations believe it.
const CAGE_ALONE: f64 = 0.05;
/// Furthest change, logarithm: some 100 K.
const FURTHEST: f64 = 0.35;
/// So many rows of a recording count as one against that prior: neighbours are not independent.
const ROWS_AS_ONE: f64 = 30.0;
/// Share of the squared error that resistances of its own must take from a recording: half a per cent of the error, which no proof resolves.
const WORTH: f64 = 0.01;
/// Most steps with the same derivatives: each leaves a tenth of what the one before left.
const STEPS: usize = 3;

/// Changes of the stator's and the rotor's resistance from those of a hypothesis, logarithms.
pub type Warmth = [f64; 2];
/// As warm as the fitted recording.
pub const AS_WARM: Warmth = [0.0; 2];

/// A recording with its noise floor.
#[derive(Clone, Debug)]
pub struct Subject {
    /// The prepared recording.
    pub case: Case,
    /// Its floor.
    pub floor: Floor,
    /// Derivatives of its weighted outputs with respect to both resistances, at the first model that was held against it: the refitted one
    /// with nothing added.
    warming: OnceLock<[Vec<f64>; 2]>,
}

/// A hypothesis seen by a recording that was not fitted.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Squared error of each block.
    pub errors: Vec<f64>,
    /// By how much the windings' resistances differ there.
    pub warmth: Warmth,
}

impl Subject {
    /// A recording with the floor of what is believed.
    pub fn new(mut case: Case, prior: &Prior) -> Self {
        if let Some(waveform) = case.waveform_mut() {
            waveform.nuisance = unknown_state(waveform, &prior.plant);
        }
        let floor = floor(&case, &prior.plant, SEED);
        Self {
            case,
            floor,
            warming: OnceLock::new(),
        }
    }

    /// Squared error of each block of a hypothesis.
    pub fn errors(&self, prior: &Prior, h: &Hypothesis) -> Vec<f64> {
        self.errors_of(&self.residual(prior, h))
    }

    /// A hypothesis with the resistances that the windings had in this recording: nobody waits between two recordings until a motor is as
    /// warm as before. A load table's few points cannot tell them.
    pub fn seen(&self, prior: &Prior, h: &Hypothesis) -> Seen {
        let (mut warmth, mut left) = (AS_WARM, self.residual(prior, h));
        if self.case.is_table() {
            return Seen {
                errors: self.errors_of(&left),
                warmth,
            };
        }
        let columns = self.warming.get_or_init(|| self.derivatives(prior, h));
        for _ in 0..STEPS {
            let Some(next) = self.next(columns, &left, warmth) else {
                break;
            };
            let there = self.residual(prior, &warmed(h, next));
            let is_better = cost(&there, next) < cost(&left, warmth);
            if !is_better {
                break;
            }
            (warmth, left) = (next, there);
        }
        Seen {
            errors: self.errors_of(&left),
            warmth,
        }
    }

    fn residual(&self, prior: &Prior, h: &Hypothesis) -> Vec<f64> {
        residual(
            &self.case,
            &outputs(&self.case, prior, h, SpeedObserver::Off),
        )
    }

    fn errors_of(&self, residual: &[f64]) -> Vec<f64> {
        let blocks = normal_equations::blocks(&self.case.blocks(), residual, &[]);
        blocks.iter().map(|b| b.sse).collect()
    }

    fn derivatives(&self, prior: &Prior, h: &Hypothesis) -> [Vec<f64>; 2] {
        let run = |h: &Hypothesis| outputs(&self.case, prior, h, SpeedObserver::Off);
        let base = run(h);
        let column = |&k: &usize| {
            let (mut moved, step) = (h.clone(), h.step(k));
            moved.z[k] += step;
            let there = run(&moved).into_iter().zip(&base);
            there.map(|(x, b)| (x - b) / step).collect()
        };
        let columns: Vec<Vec<f64>> = RESISTANCES.par_iter().map(column).collect();
        columns.try_into().unwrap_or_default()
    }

    /// Where the squared error is least by these derivatives; `None` where that is worth nothing.
    fn next(&self, columns: &[Vec<f64>; 2], left: &[f64], warmth: Warmth) -> Option<Warmth> {
        let [s, r] = columns;
        let dot = signal::dot;
        let at = Vector2::from(warmth);
        let normal = Matrix2::new(dot(s, s), dot(s, r), dot(s, r), dot(r, r));
        let weight = prior_weight();
        let score = Vector2::new(dot(s, left), dot(r, left)) - weight * at;
        let step = (normal + weight).try_inverse()? * score;
        let next = (at + step).map(|x| x.clamp(-FURTHEST, FURTHEST));
        let gain = score.dot(&(next - at));
        (gain > WORTH * dot(left, left)).then(|| next.into())
    }
}

/// Weight of the prior: the inverse covariance of both resistances, of so many rows.
fn prior_weight() -> Matrix2<f64> {
    let [both, alone] = [BOTH, CAGE_ALONE].map(|sd| ROWS_AS_ONE / sd.powi(2));
    Matrix2::new(both + alone, -alone, -alone, alone)
}

/// Squared residual and the pull of the prior.
fn cost(left: &[f64], warmth: Warmth) -> f64 {
    let at = Vector2::from(warmth);
    signal::dot(left, left) + at.dot(&(prior_weight() * at))
}

/// A hypothesis with its windings warmer.
pub fn warmed(h: &Hypothesis, warmth: Warmth) -> Hypothesis {
    let mut warm = h.clone();
    for (k, change) in RESISTANCES.into_iter().zip(warmth) {
        warm.z[k] += change;
    }
    warm
}

/// A hypothesis of a recording that proves, with windings so much warmer: nothing but their resistances is fitted.
pub fn with_free_windings(h: &Hypothesis, warmth: Warmth) -> Hypothesis {
    let mut free = warmed(h, warmth);
    free.free.fill(false);
    RESISTANCES.into_iter().for_each(|k| free.free[k] = true);
    free
}

/// By how much a hypothesis' windings are warmer than another one's; `None` beyond what a temperature makes of them.
pub fn warmth_of(h: &Hypothesis, other: &Hypothesis) -> Option<Warmth> {
    let warmth = RESISTANCES.map(|k| h.z[k] - other.z[k]);
    let is_possible = warmth.iter().all(|change| change.abs() <= FURTHEST);
    is_possible.then_some(warmth)
}

#[cfg(test)]
mod tests;
