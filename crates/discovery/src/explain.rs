//! Which physical effect is missing: step by step, each proven on data that was not fitted.

mod answered;
mod complete;
mod contests;
mod disguise;
mod pairs;
mod rebuilt;

use crate::laws::formula::dictionary::Shapes;
use crate::laws::formula::prove::{Curve, formulas};
use crate::laws::search::LawStep;
use crate::search::refit::{Candidate, Round, begin, combined};
use answered::Answered;
use complete::{complete, hidden, put_on_top};
use contests::contests;
pub(crate) use contests::stands_for;
use disguise::disguised;
use estimation::data::study::{Study, Trial};
use estimation::fit::output_error::Effort;
use estimation::model::prior::{N_NOMINAL, NOMINALS};
use estimation::proof::accept::{adequate, beats, even, explained, proven, surpasses};
use estimation::proof::off::{SIGNIFICANT, held, implausible, strains};
use estimation::proof::order::NamedCounts;
use rebuilt::effects_of;

/// Most effects that are added.
const MOST_EFFECTS: usize = 3;
/// Share of the excess that accepted effects must explain to be named without adequacy.
const NAMED_SHARE: f64 = 0.85;
/// The same, above which no pair of effects hides in what is left, and no other order of the recordings tells more.
const NEARLY_ALL: f64 = 0.97;

/// Relative error of a fit from another start that shows the first one to have been in a local minimum.
const DEEPER: f64 = 0.98;
/// Error over noise above which nothing is named, however large the explained share.
const NAMED_ERROR: f64 = 1.25;
/// Sum of squares of the nominals' distances from their priors, in standard deviations, by which an explanation is stranger
/// than one that leaves them where they are believed: three standard deviations of one of them.
const STRAINED: f64 = SIGNIFICANT * SIGNIFICANT;
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
    pub rivals: Vec<Candidate>,
}

impl Step {
    /// Names of what explains the recording as well.
    pub fn tied(&self) -> Vec<String> {
        let names = self.rivals.iter().map(|rival| rival.name.to_owned());
        names.collect()
    }
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
    /// What was asked, where it was not looked for what hides yet.
    pub open: Option<Answered>,
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

    /// How many things are named of the motor and of the instruments.
    pub fn named(&self, study: &Study) -> NamedCounts {
        NamedCounts::of(&effects_of(study, &self.steps), self.laws.len())
    }

    /// Whether what was found and may be named explains all but a few per cent of the excess.
    pub fn explains_nearly_all(&self, study: &Study) -> bool {
        explained(study, study.unexplained(&self.baseline), self.last()) > NEARLY_ALL
    }
}

/// What is missing is asked, but for effects that are not asked about; curves are held against shapes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Missing<'a> {
    /// Effects that are not asked about.
    pub excluded: &'a [&'a str],
    /// Shapes that a curve may have.
    pub shapes: Shapes,
}

/// Explains a study, from the model with its parameters refitted on; `progress` hears what is being done.
pub(crate) fn explain(
    study: &Study,
    baseline: Trial,
    asked: Missing<'_>,
    progress: &mut dyn FnMut(&str, f64),
) -> Explanation {
    let excluded = &excluded_of(study, asked.excluded);
    let mut answered = Answered::default();
    let mut explanation = library(study, &mut answered, baseline, excluded, progress);
    if !explanation.steps.is_empty()
        && let Some(law) = explanation.laws.pop()
    {
        put_on_top(study, &mut explanation, law);
    }
    prefer_plausible(study, &mut explanation);
    if laws_are_asked(study, &explanation) {
        complete(study, answered, &mut explanation, excluded, progress);
    }
    match explanation.open {
        Some(_) => explanation,
        None => finished(study, explanation, asked, progress),
    }
}

/// Effects that are not asked about: those that are excluded, and of unknown instruments what they may be off by.
fn excluded_of<'a>(study: &Study, excluded: &[&'a str]) -> Vec<&'a str> {
    [excluded, &study.unknown_effects()].concat()
}

/// Looks for what hides each other where an explanation is open.
pub(crate) fn go_on(
    study: &Study,
    mut explanation: Explanation,
    asked: Missing<'_>,
    progress: &mut dyn FnMut(&str, f64),
) -> Explanation {
    let Some(answered) = explanation.open.take() else {
        return explanation;
    };
    let excluded = &excluded_of(study, asked.excluded);
    hidden(study, answered, &mut explanation, excluded, progress);
    finished(study, explanation, asked, progress)
}

/// Formulas of the laws, and the parameters that may stand for an effect.
fn finished(
    study: &Study,
    mut explanation: Explanation,
    asked: Missing<'_>,
    progress: &mut dyn FnMut(&str, f64),
) -> Explanation {
    let proven = |law: &&mut LawStep| law.proven && law.bursts.is_empty();
    for law in explanation.laws.iter_mut().filter(proven) {
        progress("holding formulas against the curve", 0.9);
        law.formulas = formulas(
            study,
            asked.shapes,
            Curve {
                before: &law.before,
                trial: &law.trial,
            },
        );
    }
    if explanation.nameable && explanation.laws.is_empty() {
        progress("contesting the parameters that moved", 0.92);
        let excluded = &excluded_of(study, asked.excluded);
        explanation.contests = contests(study, &explanation, excluded);
    }
    explanation
}

/// Where nothing is missing: the motor without parameters that no such motor has, as long as it explains the recording too.
fn prefer_plausible(study: &Study, found: &mut Explanation) {
    if !found.steps.is_empty() || !found.laws.is_empty() || !adequate(study, &found.baseline) {
        return;
    }
    for k in implausible(study, &found.baseline) {
        let held = held(study, &found.baseline, k);
        if adequate(study, &held) {
            found.baseline = held;
        }
    }
}

/// One effect of the library after the other, each proven, until the model is adequate; a law that makes it adequate
/// where the library's best effect does not comes first.
fn library(
    study: &Study,
    answered: &mut Answered,
    mut baseline: Trial,
    excluded: &[&str],
    progress: &mut dyn FnMut(&str, f64),
) -> Explanation {
    let mut steps: Vec<Step> = Vec::new();
    let mut laws = Vec::new();
    let mut first = None;
    let mut base = baseline.clone();
    for number in 0..MOST_EFFECTS {
        let share = 0.15 + 0.15 * number as f64;
        let mut tell = |what: &str| progress(what, share);
        let mut begun = begin(study, &base, excluded, &mut tell);
        begun.lead(&at_prior(&base));
        let rival = begun.proven().map_or(&base, |c| &c.trial);
        if let Some(law) = decisive(study, answered, &base, rival, &mut tell) {
            let begun = begun.enough();
            match behind(study, &base, &law, &begun, excluded) {
                Some(effect) => steps.push(effect),
                None => laws.push(law),
            }
            first.get_or_insert(begun);
            break;
        }
        tell("refitting the likeliest");
        let mut found = begun.finish(&at_prior(&base));
        if let Some(deeper) = lower_minimum(study, &base, &found) {
            found = begin(study, &deeper, excluded, &mut tell).finish(&at_prior(&deeper));
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
            rivals: tied(study, &base, best, &found.candidates),
        });
        first.get_or_insert(found);
        let Some(step) = step else { break };
        base = step.trial.clone();
        steps.push(step);
        // The accuracy of a table is assumed: what little is left over is no evidence.
        let assumed = study.fitted.case.is_table();
        if adequate(study, &base) || assumed && explained(study, &baseline, &base) > NAMED_SHARE {
            break;
        }
    }
    if laws.is_empty() {
        drop_patches(study, &baseline, &mut steps);
    }
    let base = steps.last().map_or(&baseline, |s| &s.trial);
    let found_most = !steps.is_empty() && mostly_explained(study, &baseline, base);
    let named = adequate(study, base) || found_most;
    Explanation {
        first: first.unwrap_or_else(Round::empty),
        contests: Vec::new(),
        nameable: named || !laws.is_empty(),
        open: None,
        laws,
        baseline,
        steps,
    }
}

/// The effect of the library that a law is in disguise, as a step on `base`; none of them comes and goes.
fn behind(
    study: &Study,
    base: &Trial,
    law: &LawStep,
    begun: &Round,
    excluded: &[&str],
) -> Option<Step> {
    let effects = match law.bursts.is_empty() {
        true => disguised(study, base, law, excluded),
        false => return None,
    };
    let best = effects.first()?;
    let mut all = begun.candidates.clone();
    all.retain(|c| effects.iter().all(|effect| effect.name != c.name));
    all.extend(effects.iter().cloned());
    Some(Step {
        trial: best.trial.clone(),
        before: base.clone(),
        rivals: tied(study, base, best, &all),
    })
}

/// Whether something that is no effect may make the model adequate: `rival` does not, and samples over time and a recording
/// that was not fitted can prove it.
fn may_decide(study: &Study, rival: &Trial) -> bool {
    let over_time = !study.fitted.case.is_table();
    over_time && !study.proofs.is_empty() && !adequate(study, rival)
}

/// A law or what comes and goes on top of `base` that makes the model adequate where `rival` does not, and beats it.
fn decisive(
    study: &Study,
    answered: &mut Answered,
    base: &Trial,
    rival: &Trial,
    tell: &mut dyn FnMut(&str),
) -> Option<LawStep> {
    let wins =
        |law: &LawStep| law.proven && adequate(study, &law.trial) && beats(&law.trial, rival);
    may_decide(study, rival).then(|| answered.decisive(study, base, rival, wins, tell))?
}

/// Whether effects were accepted with parameters that are far from what is believed: another explanation may need less.
fn is_strained(study: &Study, found: &Explanation) -> bool {
    let last = found.steps.last();
    last.is_some_and(|step| strains(&step.trial, &study.prior.deviations) > STRAINED)
}

/// Whether laws are asked about: the library leaves something, and samples over time can show where.
fn laws_are_asked(study: &Study, found: &Explanation) -> bool {
    let last = found.steps.last().map_or(&found.baseline, |s| &s.trial);
    let settled =
        found.nameable && adequate(study, last) && even(study, last) && !is_strained(study, found);
    !study.fitted.case.is_table() && found.laws.is_empty() && !settled
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
    let nearby = &best.trial.fit.jacobian[..base.fit.free.len()];
    let again = study.trial_near(&start, Effort::FULL, nearby);
    (combined(study, &again) < DEEPER * error).then_some(again)
}

/// Whether the accepted effects may be named although something small is left over.
fn mostly_explained(study: &Study, baseline: &Trial, last: &Trial) -> bool {
    explained(study, study.unexplained(baseline), last) > NAMED_SHARE
        && study.proof_error(last) < NAMED_ERROR
}

/// Takes back what only patches the form of an earlier effect: later effects that explain little of what was missing
/// at first and do not make the model adequate either.
fn drop_patches(study: &Study, baseline: &Trial, steps: &mut Vec<Step>) {
    let assumed = study.fitted.case.is_table();
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
fn at_prior(trial: &Trial) -> estimation::model::prior::Hypothesis {
    let mut h = trial.fit.hypothesis.clone();
    for k in (0..N_NOMINAL).filter(|&k| h.free[k]) {
        h.z[k] = 0.0;
    }
    h
}

/// Candidates over which the best has no proven advantage.
fn tied(study: &Study, base: &Trial, best: &Candidate, all: &[Candidate]) -> Vec<Candidate> {
    let equal = |c: &&Candidate| {
        c.name != best.name
            && proven(study, base, &c.trial)
            && !surpasses(study, &best.trial, &c.trial)
    };
    all.iter().filter(equal).cloned().collect()
}

/// Name of a nominal.
pub(crate) fn nominal_name(k: usize) -> &'static str {
    NOMINALS[k].name
}

#[cfg(test)]
mod tests;
