//! A recording with its noise floor, and the resistances that its windings had.

use crate::data::case::Case;
use crate::data::noise_floor::{Floor, floor};
use crate::fit::normal_equations;
use crate::fit::output_error::{Effort, fit};
use crate::model::instruments::{InstrumentError, responses, take_as_unknown};
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

/// A fit where they do not arrive.
const ANEW: Effort = Effort {
    iterations: 4,
    ..Effort::FULL
};

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

/// What a recording that was not fitted says of a hypothesis.
#[derive(Clone, Debug)]
pub struct Proof {
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

    /// The same with the responses of a hypothesis to what its instruments may be off by taken as unknown.
    pub fn with_unknown_instruments(
        &self,
        prior: &Prior,
        h: &Hypothesis,
        errors: &[InstrumentError],
    ) -> Self {
        let responses = responses(&self.case, prior, h, errors);
        let mut unknown = Self {
            case: self.case.clone(),
            floor: self.floor.clone(),
            warming: OnceLock::new(),
        };
        take_as_unknown(&mut unknown.case, errors, &responses);
        unknown
    }

    /// The same with its angle as the shaft had it, the measured speed being so late, s; `None` where it is in time.
    pub fn with_angle_in_time(&self, late: f64) -> Option<Self> {
        let in_time = self.case.waveform()?.with_angle_in_time(late)?;
        Some(Self {
            case: in_time.into(),
            floor: self.floor.clone(),
            warming: OnceLock::new(),
        })
    }

    /// Squared error of each block of a hypothesis.
    pub fn errors(&self, prior: &Prior, h: &Hypothesis) -> Vec<f64> {
        self.errors_of(&self.residual(prior, h))
    }

    /// A hypothesis with the resistances that the windings had in this recording: nobody waits between two recordings until a motor is as
    /// warm as before. A load table's few points cannot tell them.
    pub fn proof_of(&self, prior: &Prior, h: &Hypothesis) -> Proof {
        let as_warm = self.at(prior, h, AS_WARM);
        let there = match self.case.is_table() {
            true => as_warm,
            false => self.as_warm_as_it_was(prior, h, as_warm),
        };
        Proof {
            errors: self.errors_of(&there.left),
            warmth: there.warmth,
        }
    }

    /// Steps with the same derivatives for all hypotheses; where they do not arrive, derivatives are taken anew: a start lasts longer or
    /// shorter with other resistances.
    fn as_warm_as_it_was(&self, prior: &Prior, h: &Hypothesis, mut here: Warmed) -> Warmed {
        let columns = self.warming.get_or_init(|| self.derivatives(prior, h));
        for _ in 0..STEPS {
            let Some(next) = next(columns, &here) else {
                return here;
            };
            let there = self.at(prior, h, next);
            let is_better = there.cost() < here.cost();
            if !is_better {
                break;
            }
            here = there;
        }
        let start = with_free_windings(h, here.warmth);
        let fit = fit(&self.case, prior, &start, ANEW);
        let there = warmth_of(&fit.hypothesis, h).map(|warmth| Warmed {
            warmth,
            left: fit.residual,
        });
        match there {
            Some(there) if there.cost() < here.cost() => there,
            _ => here,
        }
    }

    fn at(&self, prior: &Prior, h: &Hypothesis, warmth: Warmth) -> Warmed {
        Warmed {
            left: self.residual(prior, &warmed(h, warmth)),
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
}

/// What a hypothesis leaves of a recording with its windings so much warmer.
struct Warmed {
    warmth: Warmth,
    left: Vec<f64>,
}

impl Warmed {
    /// Squared residual and the pull of the prior.
    fn cost(&self) -> f64 {
        let at = Vector2::from(self.warmth);
        signal::dot(&self.left, &self.left) + at.dot(&(prior_weight() * at))
    }
}

/// Where the squared error is least by these derivatives; `None` where that is worth nothing.
fn next(columns: &[Vec<f64>; 2], here: &Warmed) -> Option<Warmth> {
    let ([s, r], left) = (columns, &here.left);
    let dot = signal::dot;
    let at = Vector2::from(here.warmth);
    let normal = Matrix2::new(dot(s, s), dot(s, r), dot(s, r), dot(r, r));
    let weight = prior_weight();
    let score = Vector2::new(dot(s, left), dot(r, left)) - weight * at;
    let step = (normal + weight).try_inverse()? * score;
    let next = (at + step).map(|x| x.clamp(-FURTHEST, FURTHEST));
    let gain = score.dot(&(next - at));
    (gain > WORTH * dot(left, left)).then(|| next.into())
}

/// Weight of the prior: the inverse covariance of both resistances, of so many rows.
fn prior_weight() -> Matrix2<f64> {
    let [both, alone] = [BOTH, CAGE_ALONE].map(|sd| ROWS_AS_ONE / sd.powi(2));
    Matrix2::new(both + alone, -alone, -alone, alone)
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
