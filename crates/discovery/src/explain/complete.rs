//! What the library leaves: a law instead of its effects, a law on top of them, a pair of which neither is proven alone,
//! or a lead.

use super::answered::Answered;
use super::pairs::pair;
use super::rebuilt::{effects_of, refitted};
use super::{Explanation, NAMED_ERROR, STRAINED, Step, behind, mostly_explained};
use crate::laws::formula::prove::law_of;
use crate::laws::search::{LawStep, Laws};
use estimation::data::study::{Study, Trial};
use estimation::proof::accept::{adequate, beats, even, explained, helps, may_be_of_instruments};
use estimation::proof::off::strains;
use motor::effect::EffectConfig;

/// Least share of the excess that a law which is not proven explains to be worth a look.
const LEAST_LEAD: f64 = 0.1;

/// Completes an explanation of the library's with what it does not hold.
///
/// The law competes with what the library found: on top of the bare motor it must beat the library's effects; on top of
/// them it must make the model adequate.
pub(super) fn complete(
    study: &Study,
    mut answered: Answered,
    found: &mut Explanation,
    excluded: &[&str],
    progress: &mut dyn FnMut(&str, f64),
) {
    let alone = answered.laws(study, &found.baseline, &mut from(0.6, progress));
    let best = alone.best(study, &found.baseline);
    let last = found.steps.last().map(|step| step.trial.clone());
    if let Some(law) = best
        .as_ref()
        .filter(|law| replaces(study, found, law, last.as_ref()))
    {
        if !adequate(study, &law.trial) {
            // A law that leaves something may be one of two.
            progress("looking for pairs that hide each other", 0.75);
            if take_pair(study, found, &alone, excluded, Some(&law.trial)) {
                return;
            }
        }
        found.steps.clear();
        match behind(study, &found.baseline, law, &found.first, excluded) {
            Some(effect) => found.steps.push(effect),
            None => found.laws.push(law.clone()),
        }
        found.nameable = true;
        return;
    }
    if found.nameable && last.as_ref().is_some_and(|last| adequate(study, last)) {
        return;
    }
    if let Some(last) = &last {
        let more = answered.laws(study, last, &mut from(0.7, progress));
        let more = more.best(study, last);
        if let Some(law) = more.filter(|law| law.proven && adequate(study, &law.trial)) {
            put_on_top(study, found, law);
            return;
        }
    }
    if found.nameable && found.explains_nearly_all(study) {
        return;
    }
    found.open = Some(answered);
}

/// What is left where neither an effect nor a law makes the model adequate: two that hide each other, what comes and goes, or a lead.
pub(super) fn hidden(
    study: &Study,
    mut answered: Answered,
    found: &mut Explanation,
    excluded: &[&str],
    progress: &mut dyn FnMut(&str, f64),
) {
    let alone = answered.laws(study, &found.baseline, &mut from(0.7, progress));
    let last = found.steps.last().map(|step| step.trial.clone());
    progress("looking for pairs that hide each other", 0.75);
    if take_pair(study, found, &alone, excluded, last.as_ref()) || found.nameable {
        return;
    }
    let base = last.as_ref().unwrap_or(&found.baseline);
    let law = answered.bursts(study, base, &mut |what| progress(what, 0.8));
    let law = law.filter(|law| law.proven);
    found.nameable = law.is_some();
    let lead = || {
        let best = alone.best(study, &found.baseline)?;
        let leads = explained(study, &found.baseline, &best.trial) > LEAST_LEAD;
        leads.then_some(LawStep {
            proven: false,
            ..best
        })
    };
    found.laws.extend(law.or_else(lead));
    let is_small = study.proof_error(&found.baseline) < NAMED_ERROR;
    if !found.nameable && is_small && may_be_of_instruments(study, &found.baseline) {
        (found.steps, found.laws) = (Vec::new(), Vec::new());
        found.nameable = true;
    }
}

/// Progress that moves on by a little with each thing that is told.
fn from<'p>(mut share: f64, progress: &'p mut dyn FnMut(&str, f64)) -> impl FnMut(&str) + use<'p> {
    move |what| {
        progress(what, share);
        share += 0.04;
    }
}

/// Takes a pair that beats `over`, if there is one.
fn take_pair(
    study: &Study,
    found: &mut Explanation,
    alone: &Laws,
    excluded: &[&str],
    over: Option<&Trial>,
) -> bool {
    let pair = pair(study, &found.baseline, &found.first, alone, excluded);
    let Some(pair) = pair.filter(|pair| over.is_none_or(|over| beats(pair.last(), over))) else {
        return false;
    };
    (found.steps, found.laws) = (pair.steps, pair.laws);
    found.nameable = true;
    true
}

/// A law on top of the library's effects; those that are not needed beside it go.
pub(super) fn put_on_top(study: &Study, found: &mut Explanation, law: LawStep) {
    found.nameable = true;
    let Some(curve) = law_of(study, &law.trial).map(|(_, config)| config) else {
        found.laws = vec![law];
        return;
    };
    let mut effects = effects_of(study, &found.steps);
    let mut with = law.trial.clone();
    let mut k = 0;
    while k < effects.len() {
        let mut fewer = effects.clone();
        fewer.remove(k);
        let without = refitted(study, &fewer, Some(&curve), &with);
        match adequate(study, &without) && !beats(&with, &without) {
            true => (effects, with) = (fewer, without),
            false => k += 1,
        }
    }
    if effects.len() == found.steps.len() {
        found.laws = vec![law];
        return;
    }
    found.steps = steps_of(study, &found.baseline, &found.steps, &effects, &with);
    let before = found.steps.last().map_or(&found.baseline, |s| &s.trial);
    found.laws = vec![LawStep {
        before: before.clone(),
        trial: with,
        ..law
    }];
}

/// The steps that are left, refitted one after the other.
fn steps_of(
    study: &Study,
    baseline: &Trial,
    old: &[Step],
    effects: &[EffectConfig],
    from: &Trial,
) -> Vec<Step> {
    let mut before = baseline.clone();
    let mut steps = Vec::new();
    for k in 0..effects.len() {
        let trial = refitted(study, &effects[..=k], None, from);
        let name = effects[k].effect.descriptor().name;
        let same = old.iter().find(|step| named(study, step) == Some(name));
        steps.push(Step {
            trial: trial.clone(),
            before: std::mem::replace(&mut before, trial),
            rivals: same.map_or_else(Vec::new, |step| step.rivals.clone()),
        });
    }
    steps
}

/// Name of the effect that a step added.
fn named(study: &Study, step: &Step) -> Option<&'static str> {
    let effects = effects_of(study, std::slice::from_ref(step));
    effects.last().map(|config| config.effect.descriptor().name)
}

/// Whether a law on the bare motor takes the place of what the library found.
fn replaces(study: &Study, found: &Explanation, law: &LawStep, last: Option<&Trial>) -> bool {
    let fits = adequate(study, &law.trial);
    let enough = fits || mostly_explained(study, &found.baseline, &law.trial);
    let strain = |trial: &Trial| strains(trial, &study.prior.deviations);
    let plainer = |last: &Trial| {
        fits && !beats(last, &law.trial) && strain(last) > strain(&law.trial) + STRAINED
    };
    let evener =
        |last: &Trial| !even(study, last) && even(study, &law.trial) && helps(&law.trial, last);
    let better = |last: &Trial| beats(&law.trial, last) || plainer(last) || evener(last);
    law.proven && enough && last.is_none_or(better)
}
