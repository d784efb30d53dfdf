//! When an effect counts as proven, and when two cannot be told apart.

use crate::data::study::{Study, Subject, Trial};
use crate::model::prior::Hypothesis;
use crate::proof::pairs::wilcoxon;
use motor::effect::Role;

/// Least relative gain of held-out error, on one of the two kinds of evidence ...
const GAIN: f64 = 0.02;
/// ... and on the other, where friction may already have swallowed most of a loss.
const LESSER_GAIN: f64 = 0.004;
/// Largest probability of the pairs if there were no advantage.
const P_LIMIT: f64 = 0.005;
/// The same where the folds of one recording alone prove: some thirty effects are asked of the same blocks, and by chance one of them
/// passes (Bonferroni). Less than 0.7 s proves nothing then.
const LONE_P_LIMIT: f64 = P_LIMIT / 30.0;
/// Least share of the excess over the floor that must be explained.
pub const SHARE: f64 = 0.2;
/// Error over noise below which a model is adequate where the noise is known.
pub const ADEQUATE: f64 = 1.02;
/// Error over noise of a single channel from which something may be left there.
const EVEN: f64 = 1.05;
/// Share of what unknown instruments take from a squared error that is left of it because they take it to first order: with four times as
/// much a rotor that warms was taken for it ...
const CURVED: f64 = 0.004;
/// ... and the share that may be left of a lag of several milliseconds or of counts that are held for long: less than that names nothing.
/// Laws that two healthy motors of another simulator were given explained 0.4 and 1.1 %, those of true effects 3.3 % and more.
const CURVED_AT_MOST: f64 = 0.025;
/// Least size, in typical sizes.
const LEAST_SIZE: f64 = 0.05;

/// Whether squared errors fall, in most pairs of blocks and by more than their own scatter.
fn falls(before: &[f64], after: &[f64]) -> bool {
    let fall = |(b, a): (&f64, &f64)| b - a;
    let falls: Vec<f64> = before.iter().zip(after).map(fall).collect();
    let sum: f64 = falls.iter().sum();
    let mean = sum / falls.len().max(1) as f64;
    let scatter = falls.iter().map(|x| (x - mean).powi(2)).sum::<f64>().sqrt();
    sum > scatter && wilcoxon(before, after) < P_LIMIT
}

/// Relative gain of one kind of evidence if it is proven, otherwise zero.
fn gain(before: &[f64], after: &[f64]) -> f64 {
    let (sum_before, sum_after): (f64, f64) = (before.iter().sum(), after.iter().sum());
    if falls(before, after) {
        1.0 - (sum_after / sum_before).sqrt()
    } else {
        0.0
    }
}

/// Whether `better` beats `worse` by folds and on the proving recordings.
pub fn beats(better: &Trial, worse: &Trial) -> bool {
    let folds = gain(&worse.folds, &better.folds);
    if better.proof.is_empty() {
        return folds > GAIN;
    }
    let proof = gain(&worse.proof, &better.proof);
    folds.min(proof) > LESSER_GAIN && folds.max(proof) > GAIN
}

/// Share of an excess over the floor that is explained, from errors over noise.
fn share(before: f64, after: f64) -> f64 {
    let excess = before * before - 1.0;
    if excess <= 0.0 {
        // Where nothing is missing nothing can be explained.
        0.0
    } else {
        (before * before - after * after) / excess
    }
}

fn fold_share(study: &Study, before: &Trial, after: &Trial) -> f64 {
    share(
        study.fold_error(&before.folds),
        study.fold_error(&after.folds),
    )
}

/// Share of the excess over the floor that `after` explains, the lesser of folds and proof.
pub fn explained(study: &Study, before: &Trial, after: &Trial) -> f64 {
    let proof = share(study.proof_error(before), study.proof_error(after));
    fold_share(study, before, after).min(proof)
}

/// Whether a model with these held-out squared errors of the fitted recording may be adequate, or explain this share of the excess
/// over the floor, whatever the proving recordings say.
pub fn may_explain(study: &Study, before: &Trial, folds: &[f64], least: f64) -> bool {
    let explained = share(study.fold_error(&before.folds), study.fold_error(folds));
    adequate_on_folds(study, folds) || explained > least
}

/// Whether the last effect of `after` is proven over `before`.
pub fn proven(study: &Study, before: &Trial, after: &Trial) -> bool {
    if !large_enough(after)
        || may_be_chance(study, before, after)
        || may_be_curved(study, before, after)
    {
        return false;
    }
    if beats(after, before) {
        return explained(study, before, after) > SHARE;
    }
    beats_on_folds(after, before)
        && fold_share(study, before, after) > SHARE
        && study.proof_is_silent(before, after)
        && !worse_on_proof(before, after)
}

/// Whether unknown instruments do as much beyond the first order as `after` explains.
pub fn may_be_curved(study: &Study, before: &Trial, after: &Trial) -> bool {
    if study.plain.is_none() {
        return false;
    }
    let square = |trial: &Trial| study.fold_error(&trial.folds).powi(2);
    square(before) - square(after) < CURVED_AT_MOST * study.taken_by_instruments(before)
}

/// Whether one recording alone is too short to tell the last effect of `after` from the best of many that are not there.
fn may_be_chance(study: &Study, before: &Trial, after: &Trial) -> bool {
    let is_alone = study.proofs.is_empty() && !study.fitted.case.is_table();
    is_alone && wilcoxon(&before.folds, &after.folds) > LONE_P_LIMIT
}

/// Whether the data tell `better` from `worse`: it beats it, or it does so on the recordings that tell the two apart while
/// the others, in which both predict the same, say nothing.
pub fn surpasses(study: &Study, better: &Trial, worse: &Trial) -> bool {
    if beats(better, worse) {
        return true;
    }
    let folds = gain(&worse.folds, &better.folds);
    let proof = gain(&worse.proof, &better.proof);
    if folds > GAIN {
        return !worse_on_proof(worse, better) && study.proof_is_silent(better, worse);
    }
    let no_worse =
        better.folds.iter().sum::<f64>() < (1.0 + LESSER_GAIN) * worse.folds.iter().sum::<f64>();
    proof > GAIN && no_worse && study.fit_is_silent(better, worse)
}

/// Whether `better` beats `worse` on the fitted recording alone.
fn beats_on_folds(better: &Trial, worse: &Trial) -> bool {
    gain(&worse.folds, &better.folds) > GAIN
}

/// Whether the proving recordings speak against the effect.
fn worse_on_proof(before: &Trial, after: &Trial) -> bool {
    let sum = |t: &Trial| t.proof.iter().sum::<f64>();
    sum(after) > (1.0 + LESSER_GAIN) * sum(before)
}

/// Whether the data that were not fitted are explained significantly worse by `one` than by `other`. A proving recording
/// in which both predict the same says nothing.
pub fn worse(study: &Study, one: &Trial, other: &Trial) -> bool {
    falls(&one.folds, &other.folds)
        && (other.proof.is_empty()
            || falls(&one.proof, &other.proof)
            || study.proof_is_silent(one, other))
}

/// Whether `after` explains the data that were not fitted better than `before` does, by enough to be worth a new motor
/// file.
pub fn gained(before: &Trial, after: &Trial) -> bool {
    let folds = gain(&before.folds, &after.folds);
    match after.proof.is_empty() {
        true => folds > LESSER_GAIN,
        false => gain(&before.proof, &after.proof) > LESSER_GAIN,
    }
}

/// Whether the last effect's size is worth naming.
fn large_enough(trial: &Trial) -> bool {
    let h = &trial.fit.hypothesis;
    let last = h.effects.len() - 1;
    let mine = |&k: &usize| h.effect_of(k) == last;
    let mut coordinates = (crate::model::prior::N_NOMINAL..h.z.len()).filter(mine);
    let resonance = h.effects[last].effect.descriptor().is_resonance();
    resonance || coordinates.any(|k| h.parameter(k).role == Role::Size && h.z[k].abs() > LEAST_SIZE)
}

/// Whether no single channel stands out, which the error of all together would hide.
pub fn even(study: &Study, trial: &Trial) -> bool {
    let gate = EVEN * (1.0 + 2.0 * study.allowance());
    study
        .channel_errors(trial)
        .iter()
        .all(|error| *error < gate)
}

/// Whether `better` is somewhat better by folds and on the proving recordings, each time beyond chance.
pub fn helps(better: &Trial, worse: &Trial) -> bool {
    let folds = gain(&worse.folds, &better.folds);
    folds.min(gain(&worse.proof, &better.proof)) > LESSER_GAIN
}

/// Error over noise below which nothing provable is left.
fn adequacy(study: &Study) -> f64 {
    ADEQUATE * (1.0 + 2.0 * study.allowance())
}

/// Whether nothing provable is left.
pub fn adequate(study: &Study, trial: &Trial) -> bool {
    let adds_nothing = trial.fit.hypothesis.effects.len() == study.given_effects();
    let curved = if adds_nothing { CURVED } else { 0.0 };
    is_within(study, trial, curved)
}

/// Whether what a model leaves may be what unknown instruments do beyond the first order.
pub fn may_be_of_instruments(study: &Study, trial: &Trial) -> bool {
    study.plain.is_some() && is_within(study, trial, CURVED_AT_MOST)
}

/// Whether nothing provable is left beside such a share of what unknown instruments take.
fn is_within(study: &Study, trial: &Trial, curved: f64) -> bool {
    let left_by_instruments = match study.plain.is_some() && curved > 0.0 {
        true => curved * study.taken_by_instruments(trial),
        false => 0.0,
    };
    let gate = adequacy(study).hypot(left_by_instruments.sqrt());
    study.proof_error(trial) < gate && study.fold_error(&trial.folds) < gate
}

/// Whether a model leaves nothing provable of any single recording.
pub fn adequate_in_each(study: &Study, h: &Hypothesis) -> bool {
    let error = |subject: &Subject| {
        let sum = subject.errors(&study.prior, h).iter().sum();
        subject.floor.error_over_noise(sum, subject.case.judged())
    };
    let mut all = std::iter::once(&study.fitted).chain(&study.proofs);
    all.all(|subject| error(subject) < adequacy(study))
}

/// Whether nothing provable is left of the fitted recording, by the held-out squared errors of its blocks.
pub fn adequate_on_folds(study: &Study, folds: &[f64]) -> bool {
    study.fold_error(folds) < adequacy(study)
}

#[cfg(test)]
mod tests;
