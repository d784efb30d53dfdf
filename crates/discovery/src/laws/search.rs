//! Which law is missing: screened, refitted, proven as an effect must be.

use crate::data::study::{Study, Trial};
use crate::fit::output_error::{Effort, fit};
use crate::laws::formula::prove::{Curve, Proven};
use crate::laws::menu::menu;
use crate::laws::modes::{self, Modes};
use crate::laws::screen::{Screened, best_stiffness, screen};
use crate::model::prediction::SpeedObserver;
use crate::search::accept::{beats, explained, proven};
use crate::search::refit::combined;
use motor::effect::curve::Action;
use rayon::prelude::*;

/// Laws that are refitted.
const REFITTED: usize = 6;
/// Error over noise above which the fit may have settled in a local minimum: the measured speed leads a second screen.
const ASTRAY: f64 = 3.0;
/// Laws of the second screen that are refitted too.
const REFITTED_ASTRAY: usize = 4;
/// Rate at which the observer of the second screen draws the speed, 1/s.
const OBSERVER: f64 = 15.0;
/// Share of the best law's gain that a tied one reaches.
const TIED: f64 = 0.5;
/// First refit and the one after the stiffness was chosen anew, iterations.
const ITERATIONS: [usize; 2] = [8, 4];

/// A law that was refitted.
#[derive(Clone, Debug)]
pub(crate) struct Refitted {
    /// Where and over what.
    pub action: Action,
    /// Its refit.
    pub trial: Trial,
    /// Error over noise: geometric mean of folds and proof.
    pub error: f64,
}

/// A law that explains what the library leaves.
#[derive(Clone, Debug)]
pub(crate) struct LawStep {
    /// Where and over what.
    pub action: Action,
    /// The model with it.
    pub trial: Trial,
    /// The model before it.
    pub before: Trial,
    /// Laws that explain the recordings as well.
    pub tied: Vec<Action>,
    /// Whether it is proven on a recording that was not fitted.
    pub proven: bool,
    /// Formulas that explain the recordings as well as the curve, simplest first.
    pub formulas: Vec<Proven>,
}

impl LawStep {
    /// The models that formulas are held against.
    pub fn as_curve(&self) -> Curve<'_> {
        Curve {
            before: &self.before,
            trial: &self.trial,
        }
    }
}

/// The law on top of a model; `None` where no law explains anything.
pub(crate) fn search(
    study: &Study,
    base: &Trial,
    progress: &mut dyn FnMut(&str, f64),
) -> Option<LawStep> {
    let laws = refitted(study, base, progress);
    let best = laws.first()?;
    let is_proven = !study.proofs.is_empty() && proven(study, base, &best.trial);
    let leads = explained(study, base, &best.trial) > 0.0;
    leads.then(|| LawStep {
        action: best.action,
        trial: best.trial.clone(),
        before: base.clone(),
        tied: tied(study, base, best, &laws),
        proven: is_proven,
        formulas: Vec::new(),
    })
}

/// The best laws on top of a model, refitted, best first.
pub(crate) fn refitted(
    study: &Study,
    base: &Trial,
    progress: &mut dyn FnMut(&str, f64),
) -> Vec<Refitted> {
    let (case, prior) = (&study.fitted.case, &study.prior);
    let plant = base.fit.hypothesis.plant(prior);
    let menu = menu(case, &plant);
    progress("screening laws that no library holds", 0.0);
    let screened = screen(case, prior, &base.fit, &menu);
    let mut starts: Vec<Screened> = screened.into_iter().take(REFITTED).collect();
    if study.fold_error(&base.folds) > ASTRAY && !case.speed.is_empty() && !case.speed_is_input {
        let led = Effort {
            iterations: 8,
            observer: SpeedObserver::On(OBSERVER),
            abandon_above: f64::INFINITY,
        };
        let observed = fit(case, prior, &base.fit.hypothesis, led);
        let again = screen(case, prior, &observed, &menu);
        for law in again.into_iter().take(REFITTED_ASTRAY) {
            let known = |s: &Screened| action(s) == action(&law);
            if !starts.iter().any(known) {
                starts.push(law);
            }
        }
    }
    progress("refitting the likeliest laws", 0.4);
    let one = |law: &Screened| refit(study, base, law);
    let mut laws: Vec<Refitted> = starts.par_iter().filter_map(one).collect();
    laws.sort_by(|a, b| a.error.total_cmp(&b.error));
    laws
}

fn action(law: &Screened) -> Option<Action> {
    Modes::of(&law.config).map(|modes| modes.action)
}

/// A law with all parameters free; the stiffness is chosen once more where the fit has arrived.
fn refit(study: &Study, base: &Trial, law: &Screened) -> Option<Refitted> {
    let (case, prior) = (&study.fitted.case, &study.prior);
    let effort = |iterations| Effort {
        iterations,
        ..Effort::FULL
    };
    let start = base
        .fit
        .hypothesis
        .with(law.config.clone(), &prior.plant.rated);
    let first = fit(case, prior, &start, effort(ITERATIONS[0]));
    let modes = Modes::of(&law.config)?;
    let n = modes::count(modes.action.coordinate);
    let (stiffness, _) = best_stiffness(
        first.free.len() - n,
        &first.penalty,
        &law.config,
        &first.blocks,
    );
    let mut again = first.hypothesis.clone();
    modes::stiffen(again.effects.last_mut()?, stiffness);
    let trial = study.trial(&again, effort(ITERATIONS[1]));
    Some(Refitted {
        action: modes.action,
        error: combined(study, &trial),
        trial,
    })
}

/// Laws that the best one does not beat and that gain at least half as much.
fn tied(study: &Study, base: &Trial, best: &Refitted, all: &[Refitted]) -> Vec<Action> {
    let gain = |t: &Trial| {
        let fold = study.fold_error(&base.folds) - study.fold_error(&t.folds);
        let proof = study.proof_error(base) - study.proof_error(t);
        (fold, proof)
    };
    let most = gain(&best.trial);
    let equal = |law: &&Refitted| {
        let (fold, proof) = gain(&law.trial);
        law.action != best.action
            && fold > TIED * most.0
            && proof > TIED * most.1
            && !beats(&best.trial, &law.trial)
    };
    all.iter().filter(equal).map(|law| law.action).collect()
}
