//! A curve whose knots go where it bends, or that goes on where the proving recordings do.
//!
//! Ten splines at equal distances show no bump that is narrower than some of them. Where a refitted law leaves something, the model with it is linearised
//! once, and the same law is screened again with knots that crowd about one place after the other. The place that promises most is refitted.
//! Where a law is good for the fitted recording alone, its curve is continued over what the others visit: its stiffness makes it a straight line there.

use super::formula::prove::law_of;
use super::menu::{continued, elsewhere};
use super::modes::{self, Modes};
use super::screen::best_stiffness;
use super::sensitivity::Sensitivities;
use estimation::data::study::{Study, Trial};
use estimation::fit::normal_equations;
use estimation::fit::output_error::Effort;
use estimation::proof::accept::{adequate, adequate_on_folds, beats, surpasses};
use motor::effect::EffectConfig;
use rayon::prelude::*;

/// Places about which knots may crowd, at equal distances from end to end.
const PLACES: usize = 25;
/// Widths of the crowd, shares of the range.
const WIDTHS: [f64; 2] = [0.04, 0.12];
/// Share of the excess over the noise that a crowd must promise to explain of the fitted recording: a smaller one is not worth a refit.
const WORTH_IT: f64 = 0.1;
/// Iterations of the refit.
const ITERATIONS: usize = 8;

/// The law of a trial on top of `base` with knots where they are needed, or over more; `None` where it is good as it is, or that makes it no better.
pub(super) fn refined(study: &Study, base: &Trial, law: &Trial) -> Option<Trial> {
    if adequate(study, law) {
        return None;
    }
    let (_, config) = law_of(study, law)?;
    match adequate_on_folds(study, &law.folds) {
        true => {
            let trial = refitted(study, base, law, further(study, law, &config)?)?;
            surpasses(study, &trial, law).then_some(trial)
        }
        false => {
            let trial = refitted(study, base, law, best_crowd(study, law, &config)?)?;
            beats(&trial, law).then_some(trial)
        }
    }
}

/// Another law in the place of that of a trial, with all parameters free.
fn refitted(study: &Study, base: &Trial, law: &Trial, other: EffectConfig) -> Option<Trial> {
    let mut start = base.fit.hypothesis.clone();
    let there = law.fit.hypothesis.z.get(..start.z.len())?;
    start.z.copy_from_slice(there);
    let effort = Effort {
        iterations: ITERATIONS,
        ..Effort::FULL
    };
    let start = start.with(other, &study.prior.plant.rated);
    let nearby = law.fit.jacobian.get(..base.fit.free.len())?;
    Some(study.trial_near(&start, effort, nearby))
}

/// The same curve on to where the motor is in the recordings that prove; `None` where it is nowhere else.
fn further(study: &Study, trial: &Trial, config: &EffectConfig) -> Option<EffectConfig> {
    let law = Modes::of(config)?;
    let own = [config.values[0], config.values[1]];
    let range = continued(law.action, own, &elsewhere(study, trial));
    let mut further = Modes::absent(law.action, range);
    modes::stiffen(&mut further, modes::stiffness_of(config));
    law.draw(&mut further, |x| law.value(&config.values, x));
    (range != own).then_some(further)
}

/// The same curve with the crowd of knots that promises most on top of it.
fn best_crowd(study: &Study, trial: &Trial, config: &EffectConfig) -> Option<EffectConfig> {
    let (case, fit) = (&study.fitted.case, &trial.fit);
    let rows = case.blocks();
    let sensitivities = Sensitivities::of(case.waveform()?, &study.prior, fit);
    let promise = |crowd: EffectConfig| {
        let columns = sensitivities.columns(&crowd)?;
        let blocks =
            normal_equations::extended(&fit.blocks, &rows, &fit.residual, &fit.jacobian, &columns);
        let (stiffness, held_out) = best_stiffness(fit.free.len(), &fit.penalty, &crowd, &blocks);
        Some((study.fold_error(&held_out), stiffness, crowd))
    };
    let crowds = crowds(config);
    let all = crowds.into_par_iter().filter_map(promise);
    let (error, stiffness, mut crowd) = all.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let own = study.fold_error(&trial.folds);
    let excess = |error: f64| error * error - 1.0;
    if excess(error) > (1.0 - WORTH_IT) * excess(own) {
        return None;
    }
    modes::stiffen(&mut crowd, stiffness);
    let law = Modes::of(config)?;
    law.draw(&mut crowd, |x| law.value(&config.values, x));
    Some(crowd)
}

/// The law of a config without its curve, with knots about one place after the other; none of a turn, whose modes are harmonics.
fn crowds(config: &EffectConfig) -> Vec<EffectConfig> {
    let widths = |k: usize| WIDTHS.map(|width| (k as f64 / (PLACES - 1) as f64, width));
    let all = (0..PLACES).flat_map(widths);
    all.filter_map(|(place, width)| Modes::crowded_about(config, place, width))
        .collect()
}
