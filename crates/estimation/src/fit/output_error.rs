//! Output-error fit of a hypothesis: Levenberg-Marquardt with priors.

use crate::data::case::Case;
use crate::fit::normal_equations::{self, Block, Penalty};
use crate::model::differences::{Differences, columns};
use crate::model::prediction::{SpeedObserver, outputs, residual};
use crate::model::prior::{Hypothesis, N_NOMINAL, Prior};
use nalgebra::DVector;
use std::ops::Range;

/// Limits of the inflation of the nominals' prior weight.
pub const INFLATION: [f64; 2] = [30.0, 400.0];
/// The same for a load table, whose few points cannot be correlated over thousands of samples.
const INFLATION_TABLE: [f64; 2] = [1.0, 30.0];

/// Iterations after which a hopeless fit may be given up.
const PATIENCE: usize = 2;
/// Relative gain of an iteration below which a fit has arrived.
const ARRIVED: f64 = 3e-5;
/// Damping of the first step ...
const DAMPING: f64 = 1e-4;
/// ... and most steps that are tried, each more damped: with derivatives of this place, ...
const TRIES: usize = 7;
/// ... and with those of a place nearby.
const TRIES_NEARBY: usize = 2;
/// Most steps that are taken with the same derivatives.
const CHORDS: usize = 3;
/// Relative gain of such a step below which new derivatives are worth their price.
const REFRESH: f64 = 1e-3;

/// A fitted hypothesis with everything that proofs need.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The hypothesis at its best coordinates.
    pub hypothesis: Hypothesis,
    /// Indices of the fitted coordinates.
    pub free: Vec<usize>,
    /// Residual.
    pub residual: Vec<f64>,
    /// Columns of the derivative.
    pub jacobian: Vec<Vec<f64>>,
    /// Normal equations per block.
    pub blocks: Vec<Block>,
    /// Penalty at the best coordinates.
    pub penalty: Penalty,
    /// Weighted model outputs.
    pub outputs: Vec<f64>,
    /// Inflation of the nominals' prior weight: so many rows count as one.
    pub inflation: f64,
    /// Treatment of the speed in this fit.
    pub observer: SpeedObserver,
}

/// How hard to fit.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Most iterations.
    pub iterations: usize,
    /// Treatment of the speed.
    pub observer: SpeedObserver,
    /// Give up when after a few iterations the squared error still exceeds this.
    pub abandon_above: f64,
}

impl Effort {
    /// A complete fit of a freely running model.
    pub const FULL: Effort = Effort {
        iterations: 14,
        observer: SpeedObserver::Off,
        abandon_above: f64::INFINITY,
    };

    /// Nothing is moved: the start is measured as it is.
    pub const NONE: Effort = Effort {
        iterations: 0,
        ..Effort::FULL
    };
}

impl Fit {
    /// Held-out squared error of each block.
    pub fn held_out(&self) -> Vec<f64> {
        normal_equations::held_out(&self.blocks, &self.penalty)
    }

    /// Squared residual and the pull of the priors: what a fit makes small.
    pub fn cost(&self) -> f64 {
        cost(&self.residual, &self.penalty)
    }
}

/// Weights of the priors and their pull at the present coordinates.
fn penalty(prior: &Prior, h: &Hypothesis, free: &[usize], inflation: f64) -> Penalty {
    let one = |&k: &usize| {
        let (sd, centre) = h.prior_of(k, prior);
        let factor = if h.is_prior(k) { inflation } else { 1.0 };
        (factor / (sd * sd), centre - h.z[k])
    };
    let (weight, pull): (Vec<_>, Vec<_>) = free.iter().map(one).unzip();
    Penalty {
        weight: DVector::from_vec(weight),
        pull: DVector::from_vec(pull),
    }
}

fn cost(r: &[f64], penalty: &Penalty) -> f64 {
    let pulls = penalty
        .weight
        .iter()
        .zip(&penalty.pull)
        .map(|(w, p)| w * p * p);
    let sum = signal::dot(r, r) + pulls.sum::<f64>();
    if sum.is_finite() { sum } else { f64::INFINITY }
}

/// The hypothesis moved by `step` along its free coordinates, inside its bounds.
fn moved(prior: &Prior, h: &Hypothesis, free: &[usize], step: &DVector<f64>) -> Hypothesis {
    let mut next = h.clone();
    for (&k, dz) in free.iter().zip(step.iter()) {
        let [low, high] = h.bounds(k, prior);
        let longest = h.longest_step(k);
        next.z[k] = (h.z[k] + dz.clamp(-longest, longest)).clamp(low, high);
    }
    next
}

/// Fits the free coordinates of `start` to a case.
///
/// Derivatives cost as many simulations as there are coordinates. Between two sets of them a few steps use
/// the last set, corrected by what each step has shown (Broyden, 1965, doi:10.1090/S0025-5718-1965-0198670-6).
pub fn fit(case: &Case, prior: &Prior, start: &Hypothesis, effort: Effort) -> Fit {
    Search::new(case, prior, start, effort.observer).run(effort)
}

/// As [`fit`], from a start whose derivatives are known.
pub fn fit_knowing(
    case: &Case,
    prior: &Prior,
    start: &Hypothesis,
    effort: Effort,
    jacobian: Vec<Vec<f64>>,
) -> Fit {
    let mut search = Search::new(case, prior, start, effort.observer);
    search.linearise(jacobian);
    search.inflate();
    search.run(effort)
}

/// As [`fit`], from a start near a place where the derivatives with respect to the first free coordinates are known: they lead
/// one step, after which all are taken anew.
pub fn fit_near(
    case: &Case,
    prior: &Prior,
    start: &Hypothesis,
    effort: Effort,
    nearby: &[Vec<f64>],
) -> Fit {
    let mut search = Search::new(case, prior, start, effort.observer);
    search.borrow(nearby);
    search.run(effort)
}

/// A fit on its way.
struct Search<'a> {
    case: &'a Case,
    prior: &'a Prior,
    free: Vec<usize>,
    rows: Vec<Range<usize>>,
    observer: SpeedObserver,
    limits: [f64; 2],
    hypothesis: Hypothesis,
    outputs: Vec<f64>,
    residual: Vec<f64>,
    damping: f64,
    inflation: f64,
    linear: Option<Linear>,
}

/// Derivatives, and how far the fit has moved since they were taken.
struct Linear {
    jacobian: Vec<Vec<f64>>,
    blocks: Vec<Block>,
    total: Block,
    /// Whether new derivatives are worth their price: the last step since then was, or these were taken nearby.
    stale: bool,
}

/// A better place: coordinates, outputs, cost before and after.
struct Better {
    hypothesis: Hypothesis,
    outputs: Vec<f64>,
    gain: f64,
}

impl<'a> Search<'a> {
    fn new(case: &'a Case, prior: &'a Prior, start: &Hypothesis, observer: SpeedObserver) -> Self {
        let limits = match case {
            Case::LoadTable(_) => INFLATION_TABLE,
            Case::Waveform(_) => INFLATION,
        };
        let outputs = outputs(case, prior, start, observer);
        Self {
            case,
            prior,
            free: (0..start.z.len()).filter(|&k| start.free[k]).collect(),
            rows: case.blocks(),
            observer,
            limits,
            hypothesis: start.clone(),
            residual: residual(case, &outputs),
            outputs,
            damping: DAMPING,
            inflation: limits[0],
            linear: None,
        }
    }

    fn run(mut self, effort: Effort) -> Fit {
        for iteration in 0..effort.iterations {
            if iteration > 0 || self.linear.is_none() {
                self.differentiate();
            }
            let sse = self.sse();
            let nearby = self.is_stale();
            let gain = self.step(if nearby { TRIES_NEARBY } else { TRIES });
            match gain.is_some_and(|gain| gain >= ARRIVED) {
                true => self.chords(),
                false if nearby => self.damping = DAMPING,
                false => break,
            }
            if iteration >= PATIENCE && sse > effort.abandon_above {
                break;
            }
        }
        self.finish()
    }

    fn sse(&self) -> f64 {
        signal::dot(&self.residual, &self.residual)
    }

    /// Derivatives where the fit is.
    fn differentiate(&mut self) {
        let jacobian = self.columns(&self.free);
        self.linearise(jacobian);
        self.inflate();
    }

    /// Derivatives with respect to the first free coordinates as they are nearby, those with respect to the others as they are here.
    fn borrow(&mut self, nearby: &[Vec<f64>]) {
        let own = self.columns(&self.free[nearby.len().min(self.free.len())..]);
        self.linearise([nearby, &own].concat());
        self.inflate();
        if let Some(linear) = &mut self.linear {
            linear.stale = true;
        }
    }

    fn columns(&self, coordinates: &[usize]) -> Vec<Vec<f64>> {
        let (case, prior, h) = (self.case, self.prior, &self.hypothesis);
        let differences = Differences::from(case, prior, h, &self.outputs, self.observer);
        columns(&differences, h, coordinates)
    }

    /// Takes the inflation from the present derivatives.
    fn inflate(&mut self) {
        let nominals = self.free.iter().filter(|&&k| k < N_NOMINAL).count();
        if let Some(linear) = &self.linear {
            let inflation = normal_equations::score_inflation(&linear.blocks, nominals);
            self.inflation = inflation.clamp(self.limits[0], self.limits[1]);
        }
    }

    /// Normal equations of these derivatives and the present residual.
    fn linearise(&mut self, jacobian: Vec<Vec<f64>>) {
        let blocks = normal_equations::blocks(&self.rows, &self.residual, &jacobian);
        self.linear = Some(Linear {
            total: normal_equations::total(&blocks),
            blocks,
            jacobian,
            stale: false,
        });
    }

    fn penalty(&self, h: &Hypothesis) -> Penalty {
        penalty(self.prior, h, &self.free, self.inflation)
    }

    fn is_stale(&self) -> bool {
        self.linear.as_ref().is_none_or(|linear| linear.stale)
    }

    /// A damped step: its relative gain, `None` if none of so many tries leads to anything better.
    fn step(&mut self, tries: usize) -> Option<f64> {
        let better = self.better(tries)?;
        let gain = better.gain;
        self.go(better);
        if let Some(linear) = &mut self.linear {
            linear.stale |= gain >= ARRIVED;
        }
        Some(gain)
    }

    /// Steps from corrected derivatives, as long as they are worth it.
    fn chords(&mut self) {
        for _ in 0..CHORDS {
            if self.chord().is_none_or(|gain| gain < REFRESH) {
                break;
            }
        }
    }

    /// A step from corrected derivatives: its relative gain, `None` if it leads nowhere.
    fn chord(&mut self) -> Option<f64> {
        let jacobian = self.linear.take()?.jacobian;
        self.linearise(jacobian);
        let better = self.better(1);
        if let Some(linear) = &mut self.linear {
            linear.stale = true;
        }
        let better = better?;
        let gain = better.gain;
        self.go(better);
        Some(gain)
    }

    /// Moves there and corrects the derivatives by what the move has shown.
    fn go(&mut self, better: Better) {
        let Better {
            hypothesis,
            outputs,
            ..
        } = better;
        let moves: Vec<f64> = self
            .free
            .iter()
            .map(|&k| hypothesis.z[k] - self.hypothesis.z[k])
            .collect();
        if let Some(linear) = &mut self.linear {
            correct(linear, &moves, &self.outputs, &outputs);
        }
        self.residual = residual(self.case, &outputs);
        (self.hypothesis, self.outputs) = (hypothesis, outputs);
    }

    fn finish(mut self) -> Fit {
        if self.is_stale() {
            let keep = self.inflation;
            self.differentiate();
            self.inflation = keep;
        } else if let Some(linear) = self.linear.take() {
            self.linearise(linear.jacobian);
        }
        let penalty = self.penalty(&self.hypothesis);
        let (jacobian, blocks) = self
            .linear
            .map_or_else(Default::default, |linear| (linear.jacobian, linear.blocks));
        Fit {
            penalty,
            hypothesis: self.hypothesis,
            free: self.free,
            residual: self.residual,
            jacobian,
            blocks,
            outputs: self.outputs,
            inflation: self.inflation,
            observer: self.observer,
        }
    }

    /// The damped step; coordinates that it would push out of their bounds stay, the others make up for it.
    fn inside(&self, here: &Penalty, normal: &Block) -> Option<DVector<f64>> {
        let h = &self.hypothesis;
        let mut held = here.clone();
        let mut step = held.solve(normal, self.damping)?;
        for _ in 0..3 {
            let mut again = false;
            for (i, &k) in self.free.iter().enumerate() {
                let [low, high] = h.bounds(k, self.prior);
                let outward = (h.z[k] <= low && step[i] < 0.0) || (h.z[k] >= high && step[i] > 0.0);
                if outward {
                    held.weight[i] = 1e9 * (normal.gram[(i, i)] + here.weight[i] + 1.0);
                    held.pull[i] = 0.0;
                    again = true;
                }
            }
            if !again {
                break;
            }
            step = held.solve(normal, self.damping)?;
        }
        Some(step)
    }

    /// A better hypothesis within so many tries, each more damped; `None` if there is none.
    fn better(&mut self, tries: usize) -> Option<Better> {
        let here = self.penalty(&self.hypothesis);
        let normal = self.linear.as_ref()?.total.clone();
        let before = cost(&self.residual, &here);
        for _ in 0..tries {
            if let Some(step) = self.inside(&here, &normal) {
                let next = moved(self.prior, &self.hypothesis, &self.free, &step);
                let out = outputs(self.case, self.prior, &next, self.observer);
                let after = cost(&residual(self.case, &out), &self.penalty(&next));
                if after < before {
                    self.damping = (self.damping * 0.2).max(1e-7);
                    return Some(Better {
                        hypothesis: next,
                        outputs: out,
                        gain: 1.0 - after / before,
                    });
                }
            }
            self.damping = (self.damping * 8.0).max(1e-5);
        }
        None
    }
}

/// The least change of the derivatives that makes them predict what a step did, each coordinate in its own scale.
fn correct(linear: &mut Linear, moves: &[f64], before: &[f64], after: &[f64]) {
    let scale: Vec<f64> = (0..moves.len())
        .map(|k| linear.total.gram[(k, k)].max(f64::MIN_POSITIVE))
        .collect();
    let length: f64 = moves.iter().zip(&scale).map(|(m, s)| m * m * s).sum();
    if length <= 0.0 {
        return;
    }
    let mut missed: Vec<f64> = after.iter().zip(before).map(|(a, b)| a - b).collect();
    for (column, m) in linear.jacobian.iter().zip(moves) {
        missed.iter_mut().zip(column).for_each(|(x, c)| *x -= m * c);
    }
    for ((column, m), s) in linear.jacobian.iter_mut().zip(moves).zip(&scale) {
        let share = m * s / length;
        column
            .iter_mut()
            .zip(&missed)
            .for_each(|(c, x)| *c += share * x);
    }
}

#[cfg(test)]
mod tests;
