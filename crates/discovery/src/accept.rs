//! When an effect counts as proven, and when two cannot be told apart.

use crate::proof::wilcoxon;
use crate::study::{Study, Trial};
use motor::effects::Role;

/// Least relative gain of held-out error.
const GAIN: f64 = 0.02;
/// Largest probability of the pairs if there were no advantage.
const P_LIMIT: f64 = 0.005;
/// Least share of the excess over the floor that must be explained.
const SHARE: f64 = 0.2;
/// Least size, in typical sizes.
const LEAST_SIZE: f64 = 0.05;

/// An advantage of one trial over another on one kind of evidence.
fn advantage(before: &[f64], after: &[f64], gain: f64) -> bool {
    let (sum_before, sum_after): (f64, f64) = (before.iter().sum(), after.iter().sum());
    let relative = 1.0 - (sum_after / sum_before).sqrt();
    relative > gain && wilcoxon(before, after) < P_LIMIT
}

/// Whether `better` beats `worse` by folds and on the proving recordings.
pub(crate) fn beats(better: &Trial, worse: &Trial) -> bool {
    let by_folds = advantage(&worse.folds, &better.folds, GAIN);
    let by_proof = better.proof.is_empty() || advantage(&worse.proof, &better.proof, GAIN);
    by_folds && by_proof
}

/// Share of the excess over the floor that `after` explains, the lesser of folds and proof.
pub(crate) fn explained(study: &Study, before: &Trial, after: &Trial) -> f64 {
    let share = |b: f64, a: f64| {
        let excess = b * b - 1.0;
        if excess <= 0.0 {
            1.0
        } else {
            (b * b - a * a) / excess
        }
    };
    let folds = share(
        study.fold_error(&before.folds),
        study.fold_error(&after.folds),
    );
    folds.min(share(study.proof_error(before), study.proof_error(after)))
}

/// Whether the last effect of `after` is proven over `before`.
pub(crate) fn proven(study: &Study, before: &Trial, after: &Trial) -> bool {
    beats(after, before) && explained(study, before, after) > SHARE && large_enough(after)
}

/// Whether the last effect's size is worth naming.
fn large_enough(trial: &Trial) -> bool {
    let h = &trial.fit.hypothesis;
    let last = h.effects.len() - 1;
    let mine = |&k: &usize| h.effect_of(k) == last;
    let mut coordinates = (crate::belief::N_NOMINAL..h.z.len()).filter(mine);
    let resonance = h.effects[last].effect.descriptor().is_resonance();
    resonance || coordinates.any(|k| h.parameter(k).role == Role::Size && h.z[k].abs() > LEAST_SIZE)
}
