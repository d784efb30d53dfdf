//! Which physical effect is missing: step by step, each proven on data that was not fitted.

use crate::data::study::{Study, Trial};
use crate::fit::output_error::Effort;
use crate::laws::formula::prove::formulas;
use crate::laws::search::{LawStep, search};
use crate::model::prior::{FRICTION, LEAKAGE, N_NOMINAL, NOMINALS};
use crate::search::accept::{adequate, beats, explained, proven};
use crate::search::off;
use crate::search::refit::{Candidate, Round, combined, likely, round};
use motor::effect::Nominal;

/// Most effects that are added.
const MOST_EFFECTS: usize = 3;
/// Share of the excess that accepted effects must explain to be named without adequacy.
const NAMED_SHARE: f64 = 0.85;

/// Relative error of a fit from another start that shows the first one to have been in a local minimum.
const DEEPER: f64 = 0.98;
/// Error over noise above which nothing is named, however large the explained share.
const NAMED_ERROR: f64 = 1.25;
/// Share of the first excess that a later effect explains at least, unless it makes the model adequate.
const PATCH_SHARE: f64 = 0.03;
/// Move of the leakage (logarithm) from which a series inductance is worth naming beside it: priors are commonly
/// wrong by a tenth.
const WORTH_A_CABLE: f64 = 0.12;

/// One accepted effect.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    /// The model with it.
    pub trial: Trial,
    /// The model before it.
    pub before: Trial,
    /// What explains the recording as well.
    pub tied: Vec<String>,
}

/// Everything that was learnt.
#[derive(Clone, Debug)]
pub(crate) struct Explanation {
    /// Nothing added.
    pub baseline: Trial,
    /// First round: all effects on top of the baseline.
    pub first: Round,
    /// Accepted effects.
    pub steps: Vec<Step>,
    /// Parameters that are off, each with the effects that explain the recording as well.
    pub contests: Vec<(usize, Vec<Candidate>)>,
    /// Laws that no library holds: proven ones, or one lead.
    pub laws: Vec<LawStep>,
    /// Whether what was found may be named.
    pub nameable: bool,
}

impl Explanation {
    /// The model with everything that was found and may be named.
    pub fn last(&self) -> &Trial {
        if let Some(law) = self.laws.iter().rfind(|law| law.proven) {
            return &law.trial;
        }
        let named = self.steps.last().filter(|_| self.nameable);
        named.map_or(&self.baseline, |s| &s.trial)
    }
}

/// Explains a study. `excluded` effects are not asked about; `progress` hears what is being done.
pub(crate) fn explain(
    study: &Study,
    excluded: &[&str],
    progress: &mut dyn FnMut(&str, f64),
) -> Explanation {
    progress("refitting the parameters", 0.1);
    let mut baseline = study.trial(&study.at_prior(), Effort::FULL);
    let mut steps: Vec<Step> = Vec::new();
    let mut first = None;
    let mut base = baseline.clone();
    for number in 0..MOST_EFFECTS {
        let share = 0.15 + 0.2 * number as f64;
        let mut tell = |what: &str| progress(what, share);
        let mut found = round(study, &base, &at_prior(&base), excluded, &mut tell);
        if let Some(deeper) = lower_minimum(study, &base, &found) {
            found = round(study, &deeper, &at_prior(&deeper), excluded, &mut tell);
            base = deeper;
        }
        if steps.is_empty() {
            baseline = base.clone();
        }
        let best = found
            .candidates
            .iter()
            .find(|c| proven(study, &base, &c.trial));
        let step = best.map(|best| Step {
            trial: best.trial.clone(),
            before: base.clone(),
            tied: tied(study, &base, best, &found.candidates),
        });
        first.get_or_insert(found);
        let Some(step) = step else { break };
        base = step.trial.clone();
        steps.push(step);
        // The accuracy of a table is assumed: what little is left over is no evidence.
        let assumed = study.fitted.case.table.is_some();
        if adequate(study, &base) || assumed && explained(study, &baseline, &base) > NAMED_SHARE {
            break;
        }
    }
    drop_patches(study, &baseline, &mut steps);
    let base = steps.last().map_or(&baseline, |s| &s.trial);
    let nameable = adequate(study, base) || mostly_explained(study, &baseline, base);
    let mut explanation = Explanation {
        first: first.unwrap_or_else(Round::empty),
        contests: Vec::new(),
        laws: Vec::new(),
        baseline,
        steps,
        nameable,
    };
    if laws_are_asked(study, &explanation) {
        complete_with_law(study, &mut explanation, progress);
        progress("holding formulas against the curve", 0.78);
        for law in explanation.laws.iter_mut().filter(|law| law.proven) {
            law.formulas = formulas(study, law.as_curve());
        }
    }
    if explanation.nameable && explanation.laws.is_empty() {
        progress("contesting the parameters that moved", 0.8);
        explanation.contests = contests(study, &explanation, excluded);
    }
    explanation
}

/// Whether laws are asked about: the library leaves something, and samples over time can show where.
fn laws_are_asked(study: &Study, found: &Explanation) -> bool {
    let last = found.steps.last().map_or(&found.baseline, |s| &s.trial);
    study.fitted.case.table.is_none() && !(found.nameable && adequate(study, last))
}

/// Looks for the law that the library does not hold and completes an explanation with it.
///
/// The law competes with what the library found: on top of the bare motor it must beat the library's effects; on top of
/// them it must make the model adequate.
fn complete_with_law(study: &Study, found: &mut Explanation, progress: &mut dyn FnMut(&str, f64)) {
    let mut tell = |what: &str, share: f64| progress(what, 0.5 + 0.25 * share);
    let alone = search(study, &found.baseline, &mut tell);
    let last = found.steps.last().map(|step| step.trial.clone());
    let wins = |law: &LawStep| {
        law.proven
            && (adequate(study, &law.trial) || mostly_explained(study, &found.baseline, &law.trial))
            && last.as_ref().is_none_or(|last| beats(&law.trial, last))
    };
    if let Some(law) = alone.as_ref().filter(|law| wins(law)) {
        found.steps.clear();
        found.laws = vec![law.clone()];
        found.nameable = true;
        return;
    }
    if let Some(last) = last {
        let more = search(study, &last, &mut tell);
        if let Some(law) = more.filter(|law| law.proven && adequate(study, &law.trial)) {
            found.laws = vec![law];
            found.nameable = true;
            return;
        }
    }
    if !found.nameable {
        found.laws.extend(alone.map(|law| LawStep {
            proven: false,
            ..law
        }));
    }
}

/// The base once more from where its best candidate ended, if that is better without the candidate too: then the
/// first fit had settled in a local minimum.
fn lower_minimum(study: &Study, base: &Trial, found: &Round) -> Option<Trial> {
    let best = found.candidates.first()?;
    let error = combined(study, base);
    if best.error > DEEPER * error {
        return None;
    }
    let mut start = base.fit.hypothesis.clone();
    let nominals = &best.trial.fit.hypothesis.z[..N_NOMINAL];
    start.z[..N_NOMINAL].copy_from_slice(nominals);
    let again = study.trial(&start, Effort::FULL);
    (combined(study, &again) < DEEPER * error).then_some(again)
}

/// Whether the accepted effects may be named although something small is left over.
fn mostly_explained(study: &Study, baseline: &Trial, last: &Trial) -> bool {
    explained(study, baseline, last) > NAMED_SHARE && study.proof_error(last) < NAMED_ERROR
}

/// Takes back what only patches the form of an earlier effect: later effects that explain little of what was missing
/// at first and do not make the model adequate either.
fn drop_patches(study: &Study, baseline: &Trial, steps: &mut Vec<Step>) {
    let assumed = study.fitted.case.table.is_some();
    while steps.len() > 1 && !assumed {
        let last = &steps[steps.len() - 1];
        let share = explained(study, baseline, &last.trial);
        let gained = share - explained(study, baseline, &last.before);
        if adequate(study, &last.trial) || gained > PATCH_SHARE {
            break;
        }
        steps.pop();
    }
}

/// The effects of a trial with the nominals at their priors.
fn at_prior(trial: &Trial) -> crate::model::prior::Hypothesis {
    let mut h = trial.fit.hypothesis.clone();
    for k in (0..N_NOMINAL).filter(|&k| h.free[k]) {
        h.z[k] = 0.0;
    }
    h
}

/// Candidates over which the best has no proven advantage.
fn tied(study: &Study, base: &Trial, best: &Candidate, all: &[Candidate]) -> Vec<String> {
    let equal = |c: &&Candidate| {
        c.name != best.name && proven(study, base, &c.trial) && !beats(&best.trial, &c.trial)
    };
    all.iter()
        .filter(equal)
        .map(|c| c.name.to_owned())
        .collect()
}

/// Effects that explain the recording as well as a parameter that moved, for parameters that can stand for one.
fn contests(
    study: &Study,
    explanation: &Explanation,
    excluded: &[&str],
) -> Vec<(usize, Vec<Candidate>)> {
    let last = explanation.last();
    let moved = |k: usize| last.fit.hypothesis.z[k];
    let doubtful = |&k: &usize| k == FRICTION || k == LEAKAGE && moved(k) > WORTH_A_CABLE;
    let contest = |k: usize| (k, contest(study, last, k, excluded));
    let off = study.off(last).iter().copied();
    off.filter(doubtful).map(contest).collect()
}

fn contest(study: &Study, last: &Trial, k: usize, excluded: &[&str]) -> Vec<Candidate> {
    let base = off::held(study, last, k);
    let found = likely(study, &base, excluded);
    let equal = |c: &Candidate| proven(study, &base, &c.trial) && !beats(last, &c.trial);
    found.candidates.into_iter().filter(equal).collect()
}

/// Whether a candidate is the physics that a moved parameter may stand for: friction for every loss torque, leakage
/// for a cable or filter in series.
pub(crate) fn stands_for(k: usize, candidate: &Candidate) -> bool {
    let effects = &candidate.trial.fit.hypothesis.effects;
    let nominal = match k {
        FRICTION => Nominal::Friction,
        LEAKAGE => Nominal::Leakage,
        _ => return false,
    };
    effects
        .last()
        .is_some_and(|last| last.effect.is_taken_for(nominal))
}

/// Name of a nominal.
pub(crate) fn nominal_name(k: usize) -> &'static str {
    NOMINALS[k].name
}

#[cfg(test)]
mod tests;
