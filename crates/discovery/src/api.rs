//! The three questions a user asks.

use crate::data::case::Case;
use crate::data::question::{Error, Question};
use crate::data::study::{Study, Trial};
use crate::explain::{self, Explanation, nominal_name, stands_for};
use crate::fit::normal_equations::dot;
use crate::fit::output_error::Effort;
use crate::fit::polish::with_nominals;
use crate::laws::curve::as_knots;
use crate::laws::formula::dictionary::Laws;
use crate::laws::report::law_report;
use crate::laws::search::LawStep;
use crate::report::frame;
use crate::report::present::{effect_parameters, fit_report, implausible, kind_word, loss_watt};
use crate::report::types::FrameReport;
use crate::report::types::{
    AdoptReport, ErrorReport, ExplainReport, RankReport, SpeedScaleReport, StepReport, Unexplained,
    Verdict,
};
use crate::report::unexplained;
use crate::search::accept::{explained, gained, proven};
use crate::search::inconclusive::{self, Uncertainty};
use crate::search::refit::{best_of, only};
use motor::MotorFile;
use motor::effect::{Descriptor, EffectConfig, expression, to_entry};
use motor::effects::{find, names};
use motor::motor_file::{EffectEntry, FieldCurrent, Frame};
use recording::Source;

/// Hears what is being done, and how far it is (0 to 1).
pub type Progress<'a> = dyn FnMut(&str, f64) + 'a;

/// Name under which [`adopt`] takes over refitted parameters without any effect.
pub const PARAMETERS: &str = "parameters";

/// Name under which [`adopt`] takes over the laws that [`explain`] proves.
pub const LAW: &str = "law";

/// Which effect is missing. The first source is fitted, the others prove; with one source block folds prove.
///
/// # Errors
/// Wrong effects in the motor file or no usable set of sources. A recording that cannot be judged is a report
/// with the verdict `unsupported`, not an error.
pub fn explain(
    sources: &[Source],
    motor: &MotorFile,
    progress: &mut Progress<'_>,
) -> Result<ExplainReport, Error> {
    explain_with(sources, motor, Laws::default(), progress)
}

/// As [`explain`], with shapes of formulas of the user's own.
///
/// # Errors
/// As [`explain`].
pub fn explain_with(
    sources: &[Source],
    motor: &MotorFile,
    laws: Laws,
    progress: &mut Progress<'_>,
) -> Result<ExplainReport, Error> {
    explained_by(sources, motor, &[], laws, progress)
}

/// As [`explain`], without asking about the effects in `excluded`: a way to see what a library that lacks the
/// truth would say.
///
/// # Errors
/// As [`explain`].
pub fn explain_without(
    sources: &[Source],
    motor: &MotorFile,
    excluded: &[&str],
    progress: &mut Progress<'_>,
) -> Result<ExplainReport, Error> {
    explained_by(sources, motor, excluded, Laws::default(), progress)
}

fn explained_by(
    sources: &[Source],
    motor: &MotorFile,
    excluded: &[&str],
    laws: Laws,
    progress: &mut Progress<'_>,
) -> Result<ExplainReport, Error> {
    match Question::new(sources, motor, progress) {
        Ok(mut question) => {
            question.study.shapes = laws.shapes;
            let found = explain::explain(&question.study, excluded, progress);
            let frame = judged_frame(&question, motor, found.last());
            progress("done", 1.0);
            Ok(report(&question, &found, frame))
        }
        Err(Error::Unsupported(audit, why)) => Ok(ExplainReport {
            audit: *audit,
            verdict: Verdict::Unsupported,
            summary: format!("{}; {}", why.reason, why.remedy),
            baseline: None,
            steps: Vec::new(),
            final_: None,
            ranking: Vec::new(),
            not_testable: Vec::new(),
            laws: Vec::new(),
            unexplained: None,
            speed_scale: None,
            cannot_be_concluded: Vec::new(),
        }),
        Err(error) => Err(error),
    }
}

/// What the frame of the monitor's model costs on the recordings of a question.
fn judged_frame(question: &Question, motor: &MotorFile, trial: &Trial) -> Option<FrameReport> {
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

fn report(question: &Question, found: &Explanation, frame: Option<FrameReport>) -> ExplainReport {
    let study = &question.study;
    let steps = if found.nameable {
        steps(study, found)
    } else {
        Vec::new()
    };
    let mut last = fit_report(study, found.last());
    let mut baseline = fit_report(study, &found.baseline);
    if !found.nameable {
        // An inadequate model has no parameter findings.
        let all = baseline.parameters.iter_mut().chain(&mut last.parameters);
        all.for_each(|p| p.off = false);
    }
    let verdict = verdict(study, found, &steps);
    let laws = found
        .laws
        .iter()
        .map(|law| law_report(study, law))
        .collect();
    let unexplained = (!found.nameable).then(|| unexplained(study, found));
    let mut report = ExplainReport {
        audit: question.audit.clone(),
        verdict,
        summary: String::new(),
        baseline: Some(baseline),
        steps,
        final_: Some(last),
        ranking: ranking(study, found),
        not_testable: not_testable(study, found),
        laws,
        unexplained,
        speed_scale: speed_scale_report(study, found.last()),
        cannot_be_concluded: inconclusive::list(study, found.last(), &found.first.screened),
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
    if !implausible(study, found.last()).is_empty() {
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
        report.tied_with.clone_from(&step.tied);
        // What was accepted beside it was no look-alike: both are there.
        report.tied_with.retain(|t| !names.contains(&t.as_str()));
        report
    });
    let contested = found.contests.iter().filter_map(|(k, candidates)| {
        let best = candidates.iter().find(|c| stands_for(*k, c))?;
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

/// Adds an effect, refits, and shows the error before and after; the new motor file comes with the report.
/// The name `parameters` takes over the refitted parameters and adds nothing; what they gain is held against the
/// parameters of the motor file as they are.
///
/// # Errors
/// An unknown or already present effect, wrong effects in the motor file, or sources that cannot be judged.
pub fn adopt(
    effect: &str,
    sources: &[Source],
    motor: &MotorFile,
    progress: &mut Progress<'_>,
) -> Result<(AdoptReport, MotorFile), Error> {
    adopt_with(effect, sources, motor, Laws::default(), progress)
}

/// As [`adopt`], with shapes of formulas of the user's own; of a law a formula instead of the curve.
///
/// # Errors
/// As [`adopt`], and a formula of another effect or one that there is not.
pub fn adopt_with(
    effect: &str,
    sources: &[Source],
    motor: &MotorFile,
    laws: Laws,
    progress: &mut Progress<'_>,
) -> Result<(AdoptReport, MotorFile), Error> {
    check_name(effect, motor)?;
    if laws.formula.is_some() && effect != LAW {
        let message = format!(
            "`{effect}` has no formulas to choose from: leave --formula out, or adopt `{LAW}`"
        );
        return Err(Error::UnknownEffect(message));
    }
    let mut question = Question::new(sources, motor, progress)?;
    question.study.shapes = laws.shapes;
    let study = &question.study;
    progress("refitting the parameters", 0.2);
    let refitted = study.trial(&study.at_prior(), Effort::FULL);
    if effect == LAW {
        return adopted_law(&question, motor, laws.formula, progress);
    }
    if effect == frame::NAME {
        return adopted_frame(&question, motor, &refitted);
    }
    progress("fitting the effect", 0.5);
    let is_new = effect != PARAMETERS;
    let (before, after) = match is_new {
        true => {
            let after = fitted(study, &refitted, effect)?;
            (refitted, after)
        }
        false => (as_believed(study), refitted),
    };
    progress("done", 1.0);
    let nominals = fit_report(study, &after).parameters;
    let report = AdoptReport {
        audit: question.audit.clone(),
        effect: effect.to_owned(),
        before: errors(study, &before),
        after: errors(study, &after),
        proven: match is_new {
            true => proven(study, &before, &after),
            false => gained(&before, &after),
        },
        parameters: if is_new {
            effect_parameters(study, &after, study.given_effects())
        } else {
            Vec::new()
        },
        nominals,
        motor_file: String::new(),
        frame: None,
        laws: Vec::new(),
        speed_scale: speed_scale_report(study, &after),
        cannot_be_concluded: inconclusive::list(study, &after, &[]),
    };
    Ok((report, updated(study, &after, motor)))
}

/// The motor file as it is: nothing is fitted, not even on the folds.
pub(crate) fn as_believed(study: &Study) -> Trial {
    let mut priors = study.at_prior();
    priors.free.fill(false);
    study.trial(&priors, Effort::NONE)
}

/// Everything that was found, if a law is part of it.
fn adopted_law(
    question: &Question,
    motor: &MotorFile,
    formula: Option<usize>,
    progress: &mut Progress<'_>,
) -> Result<(AdoptReport, MotorFile), Error> {
    let study = &question.study;
    let found = explain::explain(study, &[], progress);
    progress("done", 1.0);
    let Some(law) = found.laws.last() else {
        let message = "no law explains these recordings better than the library does: `drivemon explain` says what is missing";
        return Err(Error::UnknownEffect(message.to_owned()));
    };
    let after = match formula {
        Some(number) => chosen_formula(law, number)?,
        None => &law.trial,
    };
    let report = AdoptReport {
        audit: question.audit.clone(),
        effect: LAW.to_owned(),
        before: errors(study, &found.baseline),
        after: errors(study, after),
        proven: law.proven,
        parameters: Vec::new(),
        nominals: fit_report(study, after).parameters,
        motor_file: String::new(),
        frame: None,
        laws: found
            .laws
            .iter()
            .map(|law| law_report(study, law))
            .collect(),
        speed_scale: speed_scale_report(study, after),
        cannot_be_concluded: inconclusive::list(study, after, &[]),
    };
    Ok((report, updated(study, after, motor)))
}

/// The model with a formula of a law, counted from 1.
fn chosen_formula(law: &LawStep, number: usize) -> Result<&Trial, Error> {
    let of_number = number.checked_sub(1).and_then(|k| law.formulas.get(k));
    let trial = of_number.map(|formula| &formula.trial);
    trial.ok_or_else(|| {
        Error::UnknownEffect(match law.formulas.len() {
            0 => "no formula explains these recordings as well as the curve does: leave --formula out".to_owned(),
            count => format!("there is no formula {number}: give --formula 1 to {count}"),
        })
    })
}

/// Changes nothing but the frame in which the monitor forms its residuals.
fn adopted_frame(
    question: &Question,
    motor: &MotorFile,
    trial: &Trial,
) -> Result<(AdoptReport, MotorFile), Error> {
    let Some(frame) = judged_frame(question, motor, trial) else {
        let message = "the motor file already asks for the rotor-flux frame with live field current, \
                       or the recordings hold less than ten windows of steady running";
        return Err(Error::UnknownEffect(message.to_owned()));
    };
    let errors = |fitted, held_out| ErrorReport {
        error_over_noise: fitted,
        held_out_error_over_noise: held_out,
    };
    let report = AdoptReport {
        audit: question.audit.clone(),
        effect: frame::NAME.to_owned(),
        before: errors(frame.fitted_before, frame.held_out_before),
        after: errors(frame.fitted_after, frame.held_out_after),
        proven: frame.proven,
        parameters: Vec::new(),
        nominals: Vec::new(),
        motor_file: String::new(),
        frame: Some(frame),
        laws: Vec::new(),
        speed_scale: speed_scale_report(&question.study, trial),
        cannot_be_concluded: inconclusive::list(&question.study, trial, &[]),
    };
    let mut file = motor.clone();
    file.monitor.frame = Frame::RotorFlux;
    file.monitor.field_current = FieldCurrent::Live;
    Ok((report, file))
}

fn check_name(effect: &str, motor: &MotorFile) -> Result<(), Error> {
    let present = motor.effects.iter().any(|e| e.name == effect);
    let formula = effect == expression::NAME;
    let message = if formula && !present {
        "write the formula into the motor file first, its parameters zero".to_owned()
    } else if !formula
        && ![PARAMETERS, LAW, frame::NAME].contains(&effect)
        && find(effect, "").is_none()
    {
        let known = names().join(", ");
        format!(
            "no effect is called `{effect}`; use one of: {known}, {formula_name}, {frame_name}, {LAW}, {PARAMETERS}",
            formula_name = expression::NAME,
            frame_name = frame::NAME
        )
    } else if !formula && present {
        format!("the motor file already holds `{effect}`; remove it there to fit it anew")
    } else {
        return Ok(());
    };
    Err(Error::UnknownEffect(message))
}

fn fitted(study: &Study, before: &Trial, effect: &str) -> Result<Trial, Error> {
    let round = only(study, before, effect);
    best_of(round)
        .ok_or_else(|| Error::UnknownEffect(format!("`{effect}` does not apply to this recording")))
}

pub(crate) fn errors(study: &Study, trial: &Trial) -> ErrorReport {
    let r = &trial.fit.residual;
    ErrorReport {
        error_over_noise: study.fold_error(&[dot(r, r)]),
        held_out_error_over_noise: study.proof_error(trial),
    }
}

/// Whether a formula still waits for its parameters.
fn is_open(entry: &EffectEntry) -> bool {
    let parameters = entry
        .parameters
        .iter()
        .filter(|p| !p.key.ends_with("_typical"));
    parameters
        .filter_map(|p| entry.number(&p.key))
        .all(|x| x == 0.0)
}

/// The motor file with the parameters and effects of a trial.
pub(crate) fn updated(study: &Study, trial: &Trial, motor: &MotorFile) -> MotorFile {
    let plant = with_nominals(trial, study.polished(trial)).plant(&study.prior);
    let mut file = motor.clone();
    file.parameters = plant.motor;
    file.mechanics = plant.mechanics;
    file.mechanics.load_friction = motor.mechanics.load_friction;
    let configs = trial.fit.hypothesis.configs(&study.prior.plant.rated);
    let in_knots = |config: EffectConfig| as_knots(&config).unwrap_or(config);
    let mut added: Vec<EffectConfig> = configs.into_iter().map(in_knots).collect();
    // The scale of a sensor belongs to the recording, not to the motor.
    let of_the_file = added.drain(..study.given_effects());
    for config in of_the_file.skip(usize::from(study.speed_scale.is_some())) {
        let fitted = to_entry(&config);
        let same = |entry: &&mut EffectEntry| entry.name == fitted.name;
        for entry in file.effects.iter_mut().filter(same) {
            entry.take_numbers(&fitted);
        }
        // Of a size of nothing, a resistance without bound: the recordings show none of it.
        let absent = fitted
            .parameters
            .iter()
            .any(|p| fitted.number(&p.key).is_some_and(|x| !x.is_finite()));
        file.effects
            .retain(|entry| !(absent && entry.name == fitted.name));
    }
    // A formula with its fitted parameters replaces the open one.
    let is_new = |text: &str| added.iter().any(|c| c.effect.descriptor().form == text);
    let fitted =
        |e: &EffectEntry| e.name == expression::NAME && e.text("formula").is_some_and(is_new);
    file.effects.retain(|e| !(fitted(e) && is_open(e)));
    file.effects.extend(added.iter().map(to_entry));
    file
}

#[cfg(test)]
mod tests;
