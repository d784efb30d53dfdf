//! When an effect counts as proven, and when two cannot be told apart.

use crate::proof::wilcoxon;
use crate::study::{Study, Trial};
use motor::effects::Role;

/// Least relative gain of held-out error, on one of the two kinds of evidence ...
const GAIN: f64 = 0.02;
/// ... and on the other, where friction may already have swallowed most of a loss.
const LESSER_GAIN: f64 = 0.004;
/// Largest probability of the pairs if there were no advantage.
const P_LIMIT: f64 = 0.005;
/// Least share of the excess over the floor that must be explained.
const SHARE: f64 = 0.2;
/// Error over noise below which a model is adequate.
const ADEQUATE: f64 = 1.02;
/// Least size, in typical sizes.
const LEAST_SIZE: f64 = 0.05;

/// Relative gain of one kind of evidence if the pairs prove it, otherwise zero.
fn gain(before: &[f64], after: &[f64]) -> f64 {
    let (sum_before, sum_after): (f64, f64) = (before.iter().sum(), after.iter().sum());
    let proven = wilcoxon(before, after) < P_LIMIT;
    if proven {
        1.0 - (sum_after / sum_before).sqrt()
    } else {
        0.0
    }
}

/// Whether `better` beats `worse` by folds and on the proving recordings.
pub(crate) fn beats(better: &Trial, worse: &Trial) -> bool {
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
        1.0
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
pub(crate) fn explained(study: &Study, before: &Trial, after: &Trial) -> f64 {
    let proof = share(study.proof_error(before), study.proof_error(after));
    fold_share(study, before, after).min(proof)
}

/// Whether the last effect of `after` is proven over `before`.
pub(crate) fn proven(study: &Study, before: &Trial, after: &Trial) -> bool {
    if !large_enough(after) {
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

/// Whether `better` beats `worse` on the fitted recording alone.
fn beats_on_folds(better: &Trial, worse: &Trial) -> bool {
    gain(&worse.folds, &better.folds) > GAIN
}

/// Whether the proving recordings speak against the effect.
fn worse_on_proof(before: &Trial, after: &Trial) -> bool {
    let sum = |t: &Trial| t.proof.iter().sum::<f64>();
    sum(after) > (1.0 + LESSER_GAIN) * sum(before)
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

/// Whether nothing provable is left.
pub(crate) fn adequate(study: &Study, trial: &Trial) -> bool {
    let gate = ADEQUATE * (1.0 + 2.0 * study.allowance());
    study.proof_error(trial) < gate && study.fold_error(&trial.folds) < gate
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen;
    use motor::effects::{EffectConfig, find};

    /// Squared errors of 12 blocks that scatter a little, `scale` times.
    fn errors(scale: f64) -> Vec<f64> {
        (0..12)
            .map(|k| scale * (1.0 + 0.01 * f64::from(k)))
            .collect()
    }

    fn trial(folds: f64, proof: Option<f64>) -> Trial {
        let study = specimen::table_study(|_| ());
        let mut trial = specimen::trial(&study);
        trial.folds = errors(folds);
        trial.proof = proof.map_or_else(Vec::new, errors);
        trial
    }

    #[test]
    fn a_gain_is_one_less_the_ratio_of_root_mean_squares_if_it_is_proven() {
        assert!((gain(&errors(4.0), &errors(1.0)) - 0.5).abs() < 1e-12);
        assert_eq!(gain(&errors(1.0), &errors(4.0)), 0.0);
        let mut mixed = errors(1.0);
        mixed.iter_mut().step_by(2).for_each(|x| *x *= 2.0);
        mixed.iter_mut().skip(1).step_by(2).for_each(|x| *x *= 0.4);
        assert_eq!(gain(&errors(1.0), &mixed), 0.0, "better and worse by turns");
    }

    /// Two per cent on one kind of evidence, four thousandths on the other; on folds alone two per cent.
    #[test]
    fn an_advantage_must_show_on_both_kinds_of_evidence() {
        let relative = |gain: f64| (1.0 - gain) * (1.0 - gain);
        let worse = trial(1.0, Some(1.0));
        let better =
            |folds: f64, proof: f64| beats(&trial(relative(folds), Some(relative(proof))), &worse);
        assert!(better(0.021, 0.005) && better(0.005, 0.021));
        assert!(!better(0.019, 0.005) && !better(0.005, 0.019));
        assert!(!better(0.5, 0.003) && !better(0.003, 0.5));
        let alone = |folds: f64| beats(&trial(relative(folds), None), &trial(1.0, None));
        assert!(alone(0.021) && !alone(0.019));
    }

    /// From 3 to 2 times the noise: 9 - 4 of the excess 9 - 1.
    #[test]
    fn a_share_is_what_goes_of_the_excess_over_the_noise() {
        assert!((share(3.0, 2.0) - 5.0 / 8.0).abs() < 1e-12);
        assert_eq!(share(3.0, 3.0), 0.0);
        assert!((share(3.0, 1.0) - 1.0).abs() < 1e-12);
        assert!(share(3.0, 4.0) < 0.0);
        assert_eq!(share(0.9, 0.8), 1.0, "no excess is left to explain");
    }

    #[test]
    fn worse_means_by_more_than_the_lesser_gain() {
        let before = trial(1.0, Some(1.0));
        assert!(!worse_on_proof(&before, &trial(1.0, Some(1.003))));
        assert!(worse_on_proof(&before, &trial(1.0, Some(1.005))));
    }

    /// A twentieth of a typical size is not worth naming; only sizes count, and only those of the last effect.
    #[test]
    fn an_effect_must_be_large_enough_to_be_named() {
        let study = specimen::table_study(|_| ());
        let rated = study.belief.plant.rated;
        let with = |name: &str, size: f64| {
            let mut config = EffectConfig::absent(find(name, "").expect("in the library"), &rated);
            let p = &config.effect.descriptor().parameters[0];
            config.values[0] = size * p.typical * p.scale.of(&rated);
            config
        };
        let large = |sizes: &[(&str, f64)]| {
            let mut trial = specimen::trial(&study);
            for (name, size) in sizes {
                trial.fit.hypothesis = trial.fit.hypothesis.with(with(name, *size), &rated);
            }
            large_enough(&trial)
        };
        assert!(large(&[("core-loss", 0.06)]) && !large(&[("core-loss", 0.04)]));
        assert!(large(&[("current-gain", -0.06)]));
        assert!(!large(&[("windage", 1.0), ("core-loss", 0.04)]));
        assert!(large(&[("windage", 0.01), ("core-loss", 0.06)]));
    }

    #[test]
    fn a_model_is_adequate_within_two_per_cent_of_the_noise() {
        let study = specimen::table_study(|_| ());
        let judged = study.fitted.case.judged();
        let at = |error: f64| {
            let mut trial = specimen::trial(&study);
            trial.folds = vec![error * error * judged / 12.0; 12];
            adequate(&study, &trial)
        };
        assert!(at(1.0) && at(1.019) && !at(1.021));
    }

    /// Of the excess from 3 to 1 times the noise five eighths go at 2.
    #[test]
    fn explained_is_the_share_by_folds_where_nothing_else_proves() {
        let study = specimen::table_study(|_| ());
        let judged = study.fitted.case.judged();
        let at = |error: f64| {
            let mut trial = specimen::trial(&study);
            trial.folds = vec![error * error * judged / 12.0; 12];
            trial
        };
        assert!((explained(&study, &at(3.0), &at(2.0)) - 5.0 / 8.0).abs() < 1e-9);
    }
}
