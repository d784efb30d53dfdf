//! The likeliest formulas, refitted in the simulator and held against the curve.

use super::dictionary::Shapes;
use super::effect::Formula;
use super::kind::Reach;
use super::propose::{Projector, Proposal, Weight, propose};
use super::quadratic::Quadratic;
use super::shape::Shape;
use crate::laws::modes::Modes;
use estimation::data::study::{Study, Trial};
use estimation::fit::output_error::Effort;
use estimation::model::prior::{Hypothesis, N_NOMINAL};
use motor::effect::EffectConfig;
use nalgebra::DVector;
use rayon::prelude::*;

/// Formulas that are refitted.
const REFITTED: usize = 5;
/// Iterations of a refit: it starts where the information of the curve puts it.
const ITERATIONS: usize = 2;
/// Share of the curve's gain that a formula may lose ...
const LOST_GAIN: f64 = 0.01;
/// ... and relative rise of error.
const LOST_ERROR: f64 = 0.005;
/// Difference of the information criterion that decides between two formulas ("very strong": Kass and Raftery, 1995,
/// doi:10.1080/01621459.1995.10476572).
const DECISIVE: f64 = 10.0;

/// A model before a law, and with its curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Curve<'t> {
    /// Without the law.
    pub before: &'t Trial,
    /// With it.
    pub trial: &'t Trial,
}

/// A formula that was refitted.
#[derive(Clone, Debug)]
pub(crate) struct Proven {
    /// The model with it instead of the curve.
    pub trial: Trial,
    /// Numbers that it holds.
    pub numbers: usize,
    /// Information criterion over the fitted and the proving recordings.
    pub bic: f64,
}

/// Formulas that explain the recordings as well as the curve of a law, simplest first.
pub(crate) fn formulas(study: &Study, shapes: Shapes, step: Curve<'_>) -> Vec<Proven> {
    let Some((index, config)) = law_of(study, step.trial) else {
        return Vec::new();
    };
    let Some(all) = proposals(study, shapes, step.trial, index, &config) else {
        return Vec::new();
    };
    let refit = |p: &Proposal| refitted(study, step, &config, p);
    let likely = &all[..REFITTED.min(all.len())];
    let mut good: Vec<Proven> = likely.par_iter().filter_map(refit).collect();
    let least = good.iter().map(|f| f.bic).fold(f64::INFINITY, f64::min);
    good.retain(|formula| is_as_good(study, step, formula, least));
    let key = |f: &Proven| (f.bic > least + DECISIVE, f.numbers);
    // Fewest numbers first among those that the data do not speak against; then the others.
    good.sort_by(|a, b| key(a).cmp(&key(b)).then(a.bic.total_cmp(&b.bic)));
    good
}

/// The law of a trial and its position among the effects.
pub(crate) fn law_of(study: &Study, trial: &Trial) -> Option<(usize, EffectConfig)> {
    let configs = trial.fit.hypothesis.configs(&study.prior.plant.rated);
    let index = configs.iter().rposition(|c| Modes::of(c).is_some())?;
    Some((index, configs[index].clone()))
}

/// Positions among the free coordinates that belong to an effect.
pub(crate) fn coordinates_of(trial: &Trial, index: usize) -> Vec<usize> {
    let h = &trial.fit.hypothesis;
    let is_mine = |k: usize| k >= N_NOMINAL && h.effect_of(k) == index;
    let free = trial.fit.free.iter().enumerate();
    free.filter(|(_, k)| is_mine(**k))
        .map(|(at, _)| at)
        .collect()
}

fn proposals(
    study: &Study,
    shapes: Shapes,
    trial: &Trial,
    index: usize,
    config: &EffectConfig,
) -> Option<Vec<Proposal>> {
    let law = Modes::of(config)?;
    let reach = [config.values[0], config.values[1]];
    let suits = |shape: &&Shape| shape.over.suits(law.action.coordinate, reach);
    let asked: Vec<_> = shapes.all().filter(suits).collect();
    let quadratic = Quadratic::of(&trial.fit, &coordinates_of(trial, index))?;
    let weight = weight(study, trial);
    Some(propose(&asked, &Projector::of(config)?, &quadratic, weight))
}

fn weight(study: &Study, trial: &Trial) -> Weight {
    let values = study.fitted.case.judged();
    let residual = &trial.fit.residual;
    Weight {
        values,
        inflation: trial.fit.inflation,
        variance: signal::dot(residual, residual) / values,
    }
}

/// A proposal with everything free, from where the information of the curve puts it.
fn refitted(study: &Study, step: Curve<'_>, config: &EffectConfig, p: &Proposal) -> Option<Proven> {
    let law = Modes::of(config)?;
    let rated = &study.prior.plant.rated;
    let quantity = law.action.place.quantity(law.action.coordinate);
    let typical = quantity.typical * quantity.scale.of(rated);
    let amplitudes: Vec<f64> = p.amplitudes.iter().map(|a| a * typical).collect();
    let reach = Reach::of([config.values[0], config.values[1]]);
    let formula = Formula::config(law.action, p.shape, &reach, &amplitudes, &p.coordinates);
    let bare = without_law(study, step, &p.modes)?;
    let effort = Effort {
        iterations: ITERATIONS,
        ..Effort::FULL
    };
    let nearby = step.trial.fit.jacobian.get(..step.before.fit.free.len())?;
    let trial = study.trial_near(&bare.with(formula, rated), effort, nearby);
    let numbers = p.shape.numbers();
    let residual = &trial.fit.residual;
    let error = signal::dot(residual, residual) + trial.proof.iter().sum::<f64>();
    Some(Proven {
        bic: weight(study, step.trial).bic(error, numbers),
        numbers,
        trial,
    })
}

/// The hypothesis before the law, its coordinates where they are best with modes `z`.
fn without_law(study: &Study, step: Curve<'_>, z: &DVector<f64>) -> Option<Hypothesis> {
    let fit = &step.trial.fit;
    let (index, _) = law_of(study, step.trial)?;
    let modes = coordinates_of(step.trial, index);
    let moves = Quadratic::of(fit, &modes)?.others(z);
    let mut bare = step.before.fit.hypothesis.clone();
    let rest = (0..fit.free.len()).filter(|at| !modes.contains(at));
    for (at, step) in rest.zip(moves.iter()) {
        let k = fit.free[at];
        if k >= bare.z.len() {
            return None;
        }
        let [low, high] = bare.bounds(k, &study.prior);
        bare.z[k] = (fit.hypothesis.z[k] + step).clamp(low, high);
    }
    Some(bare)
}

/// Whether a formula loses next to nothing against the curve, folds and proving recordings together: each alone scatters
/// by as much as a formula may lose. Of a law that gains little a hundredth is less than the scatter too: there the
/// information criterion decides, `least` being that of the best formula.
fn is_as_good(study: &Study, step: Curve<'_>, formula: &Proven, least: f64) -> bool {
    let square =
        |t: &Trial| 0.5 * (study.fold_error(&t.folds).powi(2) + study.proof_error(t).powi(2));
    let (before, curve) = (square(step.before), square(step.trial));
    let error = square(&formula.trial);
    let undecided = formula.bic <= least + DECISIVE;
    (undecided || error - curve <= LOST_GAIN * (before - curve))
        && error.sqrt() <= (1.0 + LOST_ERROR) * curve.sqrt()
}
