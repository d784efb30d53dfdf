//! Refits the best candidates with free shapes.

use crate::fit::Effort;
use crate::predict::Teacher;
use crate::screen::Screened;
use crate::study::{Study, Trial};
use rayon::prelude::*;

/// A candidate effect, refitted together with everything else.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    /// Name of the effect.
    pub name: &'static str,
    /// Its refit.
    pub trial: Trial,
    /// Error over noise: geometric mean of folds and proof.
    pub error: f64,
}

/// Points of a grid that get a short refit before the best gets a full one.
const SHORT: Effort = Effort {
    iterations: 3,
    teacher: Teacher::Off,
};

/// Refits each group of screened points on top of `base`; best first.
pub(crate) fn confirm(study: &Study, base: &Trial, groups: &[Vec<Screened>]) -> Vec<Candidate> {
    let one = |group: &Vec<Screened>| candidate(study, base, group);
    let mut candidates: Vec<Candidate> = groups.par_iter().map(one).collect();
    candidates.sort_by(|a, b| a.error.total_cmp(&b.error));
    // Several forms of one effect are one answer: the best form speaks for it.
    let mut seen = std::collections::BTreeSet::new();
    candidates.retain(|c| seen.insert(c.name));
    candidates
}

fn candidate(study: &Study, base: &Trial, group: &[Screened]) -> Candidate {
    let start = |s: &Screened| {
        let rated = &study.belief.plant.rated;
        base.fit.hypothesis.with(s.config.clone(), rated)
    };
    let best_start = if group.len() == 1 {
        start(&group[0])
    } else {
        let short = |s: &Screened| study.trial(&start(s), SHORT);
        let trials = group.iter().map(short);
        let best = trials.min_by(|a, b| sum(&a.folds).total_cmp(&sum(&b.folds)));
        best.map_or_else(|| start(&group[0]), |t| t.fit.hypothesis)
    };
    let trial = study.trial(&best_start, Effort::FULL);
    Candidate {
        name: group[0].config.effect.descriptor().name,
        error: combined(study, &trial),
        trial,
    }
}

fn sum(x: &[f64]) -> f64 {
    x.iter().sum()
}

/// Geometric mean of the error by folds and by proof.
pub(crate) fn combined(study: &Study, trial: &Trial) -> f64 {
    (study.fold_error(&trial.folds) * study.proof_error(trial)).sqrt()
}
