//! Effects of the library behind a law.
//!
//! A curve is flexible enough to be any effect that acts at its place. With the law in force the parameters are where
//! they belong; from there an effect of the library may explain the recordings as well, and then it is named.

use super::STRAINED;
use crate::laws::search::LawStep;
use crate::search::refit::{Candidate, seconds};
use estimation::data::study::{Study, Trial};
use estimation::fit::output_error::Effort;
use estimation::model::prior::N_NOMINAL;
use estimation::proof::accept::{adequate, beats, proven};
use estimation::proof::off::strains;

/// Effects that are refitted.
const ASKED: usize = 4;

/// The library's effects on top of `base` that a law does not beat, best first.
pub(super) fn disguised(
    study: &Study,
    base: &Trial,
    law: &LawStep,
    excluded: &[&str],
) -> Vec<Candidate> {
    let mut h = base.fit.hypothesis.clone();
    let nominals = &law.trial.fit.hypothesis.z[..N_NOMINAL];
    h.z[..N_NOMINAL].copy_from_slice(nominals);
    let there = study.trial(&h, Effort::NONE);
    let strain = |trial: &Trial| strains(trial, &study.prior.deviations);
    let mut effects = seconds(study, &there, excluded, ASKED, f64::INFINITY);
    effects.retain(|effect| {
        let trial = &effect.trial;
        let plain = strain(trial) <= strain(&law.trial) + STRAINED;
        plain && adequate(study, trial) && proven(study, base, trial) && !beats(&law.trial, trial)
    });
    effects
}
