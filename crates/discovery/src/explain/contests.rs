//! Parameters that moved against effects that they may stand for.

use super::{Explanation, WORTH_A_CABLE};
use crate::search::refit::{Candidate, likely};
use estimation::data::study::{Study, Trial};
use estimation::model::prior::{FRICTION, INERTIA, LEAKAGE};
use estimation::proof::accept::{beats, proven};
use estimation::proof::off;
use motor::effect::Nominal;

/// Effects that explain the recording as well as a parameter that moved, for parameters that can stand for one.
pub(super) fn contests(
    study: &Study,
    explanation: &Explanation,
    excluded: &[&str],
) -> Vec<(usize, Vec<Candidate>)> {
    let last = explanation.last();
    let moved = |k: usize| last.fit.hypothesis.z[k];
    let impossible = off::implausible(study, last);
    let doubtful = |&k: &usize| match k {
        FRICTION => true,
        LEAKAGE => moved(k) > WORTH_A_CABLE,
        INERTIA => impossible.contains(&k),
        _ => false,
    };
    let contest = |k: usize| (k, contest(study, last, k, excluded));
    let off = study.off(last).iter().copied();
    off.filter(doubtful).map(contest).collect()
}

pub(super) fn contest(study: &Study, last: &Trial, k: usize, excluded: &[&str]) -> Vec<Candidate> {
    let base = off::held(study, last, k);
    let found = likely(study, &base, excluded);
    let equal = |c: &Candidate| proven(study, &base, &c.trial) && !beats(last, &c.trial);
    found.candidates.into_iter().filter(equal).collect()
}

/// Whether a candidate is the physics that a moved parameter may stand for: friction for every loss torque, leakage
/// for a cable or filter in series, inertia for a reading that moves less than the shaft.
pub(crate) fn stands_for(k: usize, candidate: &Candidate) -> bool {
    let effects = &candidate.trial.fit.hypothesis.effects;
    let nominal = match k {
        FRICTION => Nominal::Friction,
        LEAKAGE => Nominal::Leakage,
        INERTIA => Nominal::Inertia,
        _ => return false,
    };
    effects
        .last()
        .is_some_and(|last| last.effect.is_taken_for(nominal))
}
