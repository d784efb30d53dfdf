//! Two things at once, of which neither explains enough alone: dead time with saturation, a contact with a pump.
//!
//! The best single ones are taken for granted, proven or not, and everything is asked once more on top of each. The pair
//! is proven as a whole, and each of the two must be needed beside the other.

use super::Step;
use super::rebuilt::refitted;
use crate::laws::modes::Modes;
use crate::laws::search::{LawSearch, LawStep, Laws};
use crate::search::refit::{Round, combined, likely_below, seconds};
use estimation::data::study::{Study, Trial};
use estimation::proof::accept::{adequate, beats, may_be_curved};
use motor::effect::EffectConfig;

/// Single ones on top of which everything is asked again.
const BEAMS: usize = 2;
/// Second ones that are refitted on each, of effects and of laws.
const SECONDS: usize = 3;

/// A proven pair: effects as steps, laws behind them.
pub(super) struct Pair {
    /// Effects of the library.
    pub steps: Vec<Step>,
    /// Laws.
    pub laws: Vec<LawStep>,
}

impl Pair {
    /// The model with both.
    pub fn last(&self) -> &Trial {
        let law = self.laws.last().map(|law| &law.trial);
        let step = || &self.steps[self.steps.len() - 1].trial;
        law.unwrap_or_else(step)
    }
}

/// The pair that makes the model adequate, if there is one.
pub(super) fn pair(
    study: &Study,
    baseline: &Trial,
    first: &Round,
    laws: &Laws,
    excluded: &[&str],
) -> Option<Pair> {
    if study.proofs.is_empty() {
        return None;
    }
    let mut singles: Vec<&Trial> = first.candidates.iter().map(|c| &c.trial).collect();
    singles.extend(laws.refitted.iter().map(|law| &law.trial));
    let error = |trial: &Trial| combined(study, trial);
    singles.sort_by(|a, b| error(a).total_cmp(&error(b)));
    let beams = singles.iter().take(BEAMS);
    let mut pairs: Vec<Trial> = beams
        .flat_map(|beam| on_top(study, beam, excluded))
        .collect();
    pairs.sort_by(|a, b| error(a).total_cmp(&error(b)));
    let best = pairs.into_iter().next()?;
    let proven =
        adequate(study, &best) && beats(&best, baseline) && !may_be_curved(study, baseline, &best);
    proven.then(|| told(study, baseline, &best))?
}

/// Everything that may make a single one adequate on top of it.
fn on_top(study: &Study, beam: &Trial, excluded: &[&str]) -> Vec<Trial> {
    let limit = likely_below(study.fold_error(&beam.folds));
    let mut trials: Vec<Trial> = seconds(study, beam, excluded, SECONDS, limit)
        .into_iter()
        .map(|candidate| candidate.trial)
        .collect();
    let quiet = &mut |_: &str| {};
    let laws = LawSearch::new(study, beam, quiet);
    let laws = laws.map_or_else(Laws::none, |laws| laws.best_refitted(SECONDS, limit));
    let held = |trial: &Trial| actions(trial).len() == actions(beam).len() + 1;
    trials.extend(laws.refitted.into_iter().map(|law| law.trial).filter(held));
    trials
}

/// The different actions of the laws of a trial.
fn actions(trial: &Trial) -> std::collections::BTreeSet<motor::effect::curve::Action> {
    let effects = trial.fit.hypothesis.effects.iter();
    effects
        .filter_map(Modes::of)
        .map(|law| law.action)
        .collect()
}

/// The pair as steps, effects first; `None` if one of the two is not needed.
fn told(study: &Study, baseline: &Trial, pair: &Trial) -> Option<Pair> {
    let given = study.given_effects();
    let configs = pair.fit.hypothesis.configs(&study.prior.plant.rated);
    let mut two: Vec<EffectConfig> = configs.get(given..)?.to_vec();
    if two.len() != 2 {
        return None;
    }
    two.sort_by_key(|config| Modes::of(config).is_some());
    let with = |configs: &[EffectConfig]| refitted(study, configs, None, pair);
    let (one, other, both) = (with(&two[..1]), with(&two[1..]), with(&two));
    if !adequate(study, &both) || !beats(&both, &one) || !beats(&both, &other) {
        return None;
    }
    let mut pair = Pair {
        steps: Vec::new(),
        laws: Vec::new(),
    };
    let mut before = baseline.clone();
    for (config, trial) in two.iter().zip([one, both]) {
        match Modes::of(config) {
            None => pair.steps.push(Step {
                trial: trial.clone(),
                before,
                rivals: Vec::new(),
            }),
            Some(law) => pair.laws.push(LawStep {
                action: law.action,
                trial: trial.clone(),
                before,
                rivals: Vec::new(),
                proven: true,
                formulas: Vec::new(),
                bursts: Vec::new(),
            }),
        }
        before = trial;
    }
    Some(pair)
}
