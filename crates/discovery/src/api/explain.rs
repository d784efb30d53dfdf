//! Which effect is missing, as a report.

use crate::design::limits::NextRun;
use crate::design::report::{DesignReport, design_report};
use crate::design::search::design;
use crate::explain::{self, Explanation, Missing, Step, nominal_name, stands_for};
use crate::laws::formula::dictionary::Laws;
use crate::laws::report::law_report;
use crate::report::frame;
use crate::report::present::{
    effect_parameters, fit_report, inadequate_report, kind_word, loss_watt,
};
use crate::report::types::FrameReport;
use crate::report::types::{ExplainReport, RankReport, StepReport, Unexplained, Verdict};
use crate::report::unexplained::{self, apart};
use crate::search::inconclusive::{self, Uncertainty};
use crate::search::refit::Candidate;
use estimation::data::case::Case;
use estimation::data::given::{Fitted, Sources};
use estimation::data::question::{Error, Question};
use estimation::data::study::{Study, Trial};
use estimation::model::scale_report::SpeedScaleReport;
use estimation::proof::accept::{adequate, explained};
use estimation::proof::off::implausible;
use estimation::proof::order::{Ask, Explains, NamedCounts, in_either_order};
use motor::MotorFile;
use motor::effect::Descriptor;

use super::Progress;

/// Which effect is missing. The first source is fitted, the second proves; where that leaves something of two recordings, the other way
/// round. Of more, the first, third, ... are fitted together. With one source block folds prove.
///
/// # Errors
/// Wrong effects in the motor file or no usable set of sources. A recording that cannot be judged is a report
/// with the verdict `unsupported`, not an error.
pub fn explain<'a>(
    sources: impl Into<Sources<'a>>,
    motor: &MotorFile,
    progress: &mut Progress<'_>,
) -> Result<ExplainReport, Error> {
    explained_by(sources.into(), motor, &[], Asked::default(), progress)
}

/// What an explanation is asked for beside the missing effect.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// What laws are held against.
    pub laws: Laws,
    /// The next experiment, designed within these limits.
    pub next_run: Option<NextRun>,
}

/// As [`explain`], with shapes of formulas of the user's own, and with the next experiment.
///
/// # Errors
/// As [`explain`].
pub fn explain_with<'a>(
    sources: impl Into<Sources<'a>>,
    motor: &MotorFile,
    asked: Asked,
    progress: &mut Progress<'_>,
) -> Result<ExplainReport, Error> {
    explained_by(sources.into(), motor, &[], asked, progress)
}

/// As [`explain`], without asking about the effects in `excluded`: a way to see what a library that lacks the
/// truth would say.
///
/// # Errors
/// As [`explain`].
pub fn explain_without<'a>(
    sources: impl Into<Sources<'a>>,
    motor: &MotorFile,
    excluded: &[&str],
    progress: &mut Progress<'_>,
) -> Result<ExplainReport, Error> {
    explained_by(sources.into(), motor, excluded, Asked::default(), progress)
}

fn explained_by(
    sources: Sources<'_>,
    motor: &MotorFile,
    excluded: &[&str],
    asked: Asked,
    progress: &mut Progress<'_>,
) -> Result<ExplainReport, Error> {
    let what = Missing {
        excluded,
        shapes: asked.laws.shapes,
    };
    match in_either_order(&what, sources, motor, progress) {
        Ok(answer) => {
            let (question, found) = (&answer.question, &answer.found);
            let frame = judged_frame(question, motor, found.last());
            let next_run = asked.next_run;
            let next_run =
                next_run.and_then(|asked| designed(question, motor, found, asked, progress));
            progress("done", 1.0);
            let mut report = report(question, found, frame, answer.fitted);
            report.next_run = next_run;
            if let (Verdict::Unknown, Some(differences)) = (report.verdict, answer.each_alone) {
                report.unexplained = Some(apart(differences));
                report.laws.clear();
                report.summary = crate::report::words::summary(&report);
            }
            Ok(report)
        }
        Err(Error::Unsupported(audit, why)) => Ok(ExplainReport {
            audit: *audit,
            verdict: Verdict::Unsupported,
            summary: format!("{}; {}", why.reason, why.remedy),
            ..ExplainReport::default()
        }),
        Err(error) => Err(error),
    }
}

impl Ask for Missing<'_> {
    type Found = Explanation;

    fn ask(&self, study: &Study, baseline: Trial, progress: &mut Progress<'_>) -> Explanation {
        explain::explain(study, baseline, *self, progress)
    }

    fn go_on(&self, study: &Study, found: Explanation, progress: &mut Progress<'_>) -> Explanation {
        explain::go_on(study, found, *self, progress)
    }

    fn model<'a>(&self, found: &'a Explanation) -> Option<&'a Trial> {
        Some(found.last())
    }

    fn named(&self, study: &Study, found: &Explanation) -> NamedCounts {
        found.named(study)
    }

    fn explains(&self, study: &Study, found: &Explanation) -> Explains {
        match found.nameable && is_plausible(study, found) {
            true if adequate(study, found.last()) => Explains::All,
            true if found.explains_nearly_all(study) => Explains::Most,
            _ => Explains::Part,
        }
    }
}

/// The next experiment.
fn designed(
    question: &Question,
    motor: &MotorFile,
    found: &Explanation,
    asked: NextRun,
    progress: &mut Progress<'_>,
) -> Option<DesignReport> {
    let design = design(&question.study, found, asked.limits, progress)?;
    Some(design_report(&design, motor, &asked.motor_file))
}

/// What the frame of the monitor's model costs on the recordings of a question.
pub(super) fn judged_frame(
    question: &Question,
    motor: &MotorFile,
    trial: &Trial,
) -> Option<FrameReport> {
    let study = &question.study;
    let all = std::iter::once(&study.fitted).chain(&study.proofs);
    let cases: Vec<&Case> = all.map(|s| &s.case).collect();
    let fitted = trial.fit.hypothesis.plant(&study.prior);
    if study.speed_scale.is_none() {
        return frame::judge(motor, &study.prior, &fitted.motor, &cases);
    }
    let scaled: Vec<Case> = cases.iter().map(|case| case.as_seen_by(&fitted)).collect();
    let cases: Vec<&Case> = scaled.iter().collect();
    frame::judge(motor, &study.prior, &fitted.motor, &cases)
}

/// The scale of the speed that a trial found, where it was unknown.
pub(crate) fn speed_scale_report(study: &Study, trial: &Trial) -> Option<SpeedScaleReport> {
    let scale = study.speed_scale?;
    let uncertainty = Uncertainty::of(study, trial);
    Some(scale.report(
        &trial.fit.hypothesis,
        &study.prior,
        uncertainty.of_scale_and_source(),
    ))
}

fn report(
    question: &Question,
    found: &Explanation,
    frame: Option<FrameReport>,
    fitted: Fitted,
) -> ExplainReport {
    let study = &question.study;
    let steps = if found.nameable {
        steps(study, found)
    } else {
        Vec::new()
    };
    let last = match found.nameable {
        true => fit_report(study, found.last()),
        false => inadequate_report(study, found.last()),
    };
    let baseline = match std::ptr::eq(found.last(), &found.baseline) {
        true => last.clone(),
        false => inadequate_report(study, &found.baseline),
    };
    let verdict = verdict(study, found, &steps);
    let laws = found.laws.iter();
    let laws = laws.map(|law| law_report(study, law)).collect();
    let unexplained = (!found.nameable).then(|| unexplained(study, found));
    let mut report = ExplainReport {
        audit: question.audit.clone(),
        stretches: question.stretches.clone(),
        fitted,
        verdict,
        summary: String::new(),
        channels: study.channels(found.last(), &found.baseline),
        baseline: Some(baseline),
        steps,
        final_: Some(last),
        ranking: ranking(study, found),
        not_testable: not_testable(study, found),
        laws,
        unexplained,
        speed_scale: speed_scale_report(study, found.last()),
        cannot_be_concluded: inconclusive::list(study, found.last(), &found.first.screened),
        next_run: None,
    };
    if let Some(frame) = frame.filter(|f| f.proven) {
        add_frame(&mut report, frame);
    }
    report.summary = crate::report::words::summary(&report);
    report
}

/// Puts the frame before all physics: it is an error of the monitor's model, whatever the motor does.
fn add_frame(report: &mut ExplainReport, frame: FrameReport) {
    if report.verdict == Verdict::Adequate {
        report.verdict = Verdict::Effect;
    }
    report.steps.insert(0, frame_step(frame));
}

fn frame_step(frame: FrameReport) -> StepReport {
    let excess = |e: f64| (e * e - 1.0).max(0.0);
    let left = excess(frame.held_out_after) / excess(frame.held_out_before);
    StepReport {
        effect: frame::NAME.to_owned(),
        form: String::new(),
        kind: "model".to_owned(),
        tied_with: Vec::new(),
        separating_test: String::new(),
        symptom: "the residuals of the published model, formed with the voltage on the q axis or with a constant \
                  field current, grow with the load of a healthy motor: the frame error"
            .to_owned(),
        held_out_error_over_noise: frame.held_out_after,
        fold_error_over_noise: frame.held_out_after,
        explained_percent: 100.0 * (1.0 - left),
        loss_watt: None,
        parameters: Vec::new(),
        frame: Some(frame),
    }
}

fn verdict(study: &Study, found: &Explanation, steps: &[StepReport]) -> Verdict {
    if !found.nameable {
        return Verdict::Unknown;
    }
    if found.laws.iter().any(|law| law.proven) {
        return Verdict::Law;
    }
    if !is_plausible(study, found) {
        return Verdict::Implausible;
    }
    if steps.iter().any(|s| !s.tied_with.is_empty()) {
        return Verdict::Ambiguous;
    }
    if steps.is_empty() {
        Verdict::Adequate
    } else {
        Verdict::Effect
    }
}

/// Whether such motors have these parameters, but for those that stand for an effect.
fn is_plausible(study: &Study, found: &Explanation) -> bool {
    let tied: Vec<String> = found.steps.iter().flat_map(Step::tied).collect();
    let contested = found.contests.iter();
    let stand_ins = contested.filter_map(|(k, candidates)| stand_in(*k, candidates).map(|_| *k));
    let stand_ins: Vec<usize> = stand_ins.collect();
    let stands_for_an_effect =
        |k: &usize| stand_ins.contains(k) || tied.iter().any(|name| name == nominal_name(*k));
    implausible(study, found.last())
        .iter()
        .all(stands_for_an_effect)
}

/// The effect that a parameter which moved may stand for.
fn stand_in(k: usize, candidates: &[Candidate]) -> Option<&Candidate> {
    candidates.iter().find(|c| stands_for(k, c))
}

/// Accepted effects, and the effects that explain a moved parameter as well.
fn steps(study: &Study, found: &Explanation) -> Vec<StepReport> {
    let given = study.given_effects();
    let number = found.steps.len();
    let names: Vec<&str> = (given..given + number)
        .map(|k| descriptor(found.last(), k).name)
        .collect();
    let accepted = found.steps.iter().enumerate().map(|(k, step)| {
        let k = given + k;
        let mut report = step_report(study, &step.before, found.last(), &step.trial, k);
        report.tied_with = step.tied();
        // What was accepted beside it was no look-alike: both are there.
        report.tied_with.retain(|t| !names.contains(&t.as_str()));
        report
    });
    let contested = found.contests.iter().filter_map(|(k, candidates)| {
        let best = stand_in(*k, candidates)?;
        let index = best.trial.fit.hypothesis.effects.len() - 1;
        let before = found.last();
        let mut report = step_report(study, before, &best.trial, &best.trial, index);
        report.tied_with = vec![nominal_name(*k).to_owned()];
        let others = candidates.iter().filter(|c| c.name != best.name);
        report.tied_with.extend(others.map(|c| c.name.to_owned()));
        Some(report)
    });
    accepted.chain(contested).collect()
}

fn step_report(
    study: &Study,
    before: &Trial,
    fitted: &Trial,
    trial: &Trial,
    index: usize,
) -> StepReport {
    let descriptor = descriptor(trial, index);
    StepReport {
        effect: descriptor.name.to_owned(),
        form: descriptor.form.to_owned(),
        kind: kind_word(descriptor.kind).to_owned(),
        tied_with: Vec::new(),
        separating_test: descriptor.separating_test.to_owned(),
        symptom: descriptor.symptom.to_owned(),
        held_out_error_over_noise: study.proof_error(trial),
        fold_error_over_noise: study.fold_error(&trial.folds),
        explained_percent: 100.0 * explained(study, before, trial),
        loss_watt: loss_watt(study, fitted, index),
        parameters: effect_parameters(study, fitted, index),
        frame: None,
    }
}

fn descriptor(trial: &Trial, index: usize) -> &'static Descriptor {
    trial.fit.hypothesis.effects[index].effect.descriptor()
}

/// All effects of the first round, refitted ones with their refit; each name once.
fn ranking(study: &Study, found: &Explanation) -> Vec<RankReport> {
    let base = study.proof_error(&found.baseline);
    let base_folds = study.fold_error(&found.baseline.folds);
    let mut rows: Vec<RankReport> = Vec::new();
    for s in &found.first.screened {
        let name = s.config.effect.descriptor().name;
        if rows.iter().any(|r| r.effect == name) {
            continue;
        }
        let refit = found.first.candidates.iter().find(|c| c.name == name);
        let linear = study.fold_error(&s.held_out) / base_folds * base;
        let error = refit.map_or(linear, |c| study.proof_error(&c.trial));
        rows.push(RankReport {
            effect: name.to_owned(),
            held_out_error_over_noise: error,
            gain_percent: 100.0 * (1.0 - error / base),
            refitted: refit.is_some(),
            visibility_percent: 100.0 * study.visibility(s.visible),
        });
    }
    rows.sort_by(|a, b| {
        a.held_out_error_over_noise
            .total_cmp(&b.held_out_error_over_noise)
    });
    rows
}

/// Effects whose typical size this recording would not show.
fn not_testable(study: &Study, found: &Explanation) -> Vec<String> {
    let mut names = std::collections::BTreeMap::<&str, f64>::new();
    for s in &found.first.screened {
        let best = names.entry(s.config.effect.descriptor().name).or_default();
        *best = best.max(study.visibility(s.visible));
    }
    let hidden = names.into_iter().filter(|(_, v)| *v < Study::VISIBLE);
    hidden.map(|(name, _)| name.to_owned()).collect()
}

fn unexplained(study: &Study, found: &Explanation) -> Unexplained {
    let share = |t: &Trial| explained(study, &found.baseline, t);
    let lead = found.first.candidates.first();
    let best_lead = lead.filter(|c| share(&c.trial) > 0.0);
    unexplained::describe(
        study,
        found.last(),
        best_lead.map(|c| c.name.to_owned()),
        best_lead.map_or(0.0, |c| 100.0 * share(&c.trial)),
    )
}

#[cfg(test)]
mod tests;
