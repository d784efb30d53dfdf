//! Looks through feasible runs for the one that decides most.

use super::family::Family;
use super::goal::{Goal, Verdict};
use super::limits::Limits;
use super::plan::Plan;
use super::virtual_waveform::virtual_waveform;
use crate::explain::Explanation;
use estimation::data::study::Study;
use rayon::prelude::*;

/// Random runs.
const RANDOM: usize = 24;
/// Small changes of the best one, in rounds of this size.
const CHANGED: usize = 8;
/// Rounds.
const ROUNDS: usize = 2;

/// The run that decides most, and the best of the standard ones.
pub(crate) struct Design {
    /// The run.
    pub plan: Plan,
    pub(super) verdict: Verdict,
    /// Name, run and verdict of the best standard run.
    pub(super) standard: (&'static str, Plan, Verdict),
    pub(super) goal: Goal,
    /// How many recordings there are already.
    pub(super) recordings: usize,
}

/// Designs the next run; `None` where nothing is open or samples over time were not given.
pub(crate) fn design(
    study: &Study,
    found: &Explanation,
    limits: Limits,
    progress: &mut dyn FnMut(&str, f64),
) -> Option<Design> {
    let waveform = study.fitted.case.waveform()?;
    let goal = Goal::of(study, found)?;
    let plant = found.last().fit.hypothesis.plant(&study.prior);
    let judge = |plan: &Plan| goal.judge(study, &virtual_waveform(plan, waveform, &plant).into());
    let mut family = Family::new(limits);
    progress("designing the next experiment", 0.94);
    let judged = |plans: Vec<Plan>| -> Vec<(Plan, Verdict)> {
        let one = |plan: Plan| {
            let verdict = judge(&plan);
            (plan, verdict)
        };
        plans.into_par_iter().map(one).collect()
    };
    let named = family.standard();
    let names: Vec<&'static str> = named.iter().map(|(name, _)| *name).collect();
    let standard = judged(named.into_iter().map(|(_, plan)| plan).collect());
    let (name, best_standard) = names
        .into_iter()
        .zip(&standard)
        .max_by(|a, b| a.1.1.score.total_cmp(&b.1.1.score))?;
    let best_standard = (name, best_standard.0.clone(), best_standard.1.clone());
    let mut all = standard;
    progress("designing the next experiment", 0.96);
    all.extend(judged((0..RANDOM).map(|_| family.random()).collect()));
    for round in 0..ROUNDS {
        progress("designing the next experiment", 0.97 + 0.01 * round as f64);
        let best = best(&all)?.0.clone();
        all.extend(judged(
            (0..CHANGED).map(|_| family.changed(&best)).collect(),
        ));
    }
    let (plan, verdict) = best(&all)?.clone();
    Some(Design {
        plan: plan.simplified(),
        verdict,
        standard: best_standard,
        goal,
        recordings: 1 + study.proofs.len(),
    })
}

fn best(all: &[(Plan, Verdict)]) -> Option<&(Plan, Verdict)> {
    all.iter().max_by(|a, b| a.1.score.total_cmp(&b.1.score))
}
