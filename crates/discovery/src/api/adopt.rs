//! Taking over what was found: the motor file with an effect, with refitted parameters, or with a law.

use crate::explain::Missing;
use crate::laws::curve::as_knots;
use crate::laws::formula::dictionary::Laws;
use crate::laws::report::law_report;
use crate::laws::search::LawStep;
use crate::report::frame;
use crate::report::present::{effect_parameters, fit_report};
use crate::report::types::{AdoptReport, ErrorReport};
use crate::search::inconclusive::{self};
use crate::search::refit::{best_of, only};
use estimation::data::given::{Fitted, Sources};
use estimation::data::question::{Error, Question};
use estimation::data::study::{Study, Trial};
use estimation::fit::output_error::Effort;
use estimation::fit::polish::with_nominals;
use estimation::model::instruments::is_unnoticed;
use estimation::proof::accept::{adequate, gained, proven};
use estimation::proof::order::{Answer, Ask, Explains, in_either_order};
use motor::MotorFile;
use motor::effect::{EffectConfig, expression, to_entry};
use motor::effects::{find, names};
use motor::motor_file::{EffectEntry, FieldCurrent, Frame};
use signal::dot;

use super::explain::{judged_frame, speed_scale_report};
use super::{LAW, PARAMETERS, Progress};

/// Adds an effect, refits, and shows the error before and after; the new motor file comes with the report.
/// The name `parameters` takes over the refitted parameters and adds nothing; what they gain is held against the
/// parameters of the motor file as they are.
///
/// # Errors
/// An unknown or already present effect, wrong effects in the motor file, or sources that cannot be judged.
pub fn adopt<'a>(
    effect: &str,
    sources: impl Into<Sources<'a>>,
    motor: &MotorFile,
    progress: &mut Progress<'_>,
) -> Result<(AdoptReport, MotorFile), Error> {
    adopt_with(effect, sources, motor, Laws::default(), progress)
}

/// As [`adopt`], with shapes of formulas of the user's own; of a law a formula instead of the curve.
///
/// # Errors
/// As [`adopt`], and a formula of another effect or one that there is not.
pub fn adopt_with<'a>(
    effect: &str,
    sources: impl Into<Sources<'a>>,
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
    match effect {
        LAW => adopted_law(sources.into(), motor, laws, progress),
        frame::NAME => adopted_frame(sources.into(), motor, progress),
        _ => adopted_effect(effect, sources.into(), motor, progress),
    }
}

/// An effect of the library, or the refitted parameters alone: the model without and with it.
struct Named<'a>(&'a str);

impl Ask for Named<'_> {
    type Found = Result<(Trial, Trial), Error>;

    fn ask(&self, study: &Study, refitted: Trial, progress: &mut Progress<'_>) -> Self::Found {
        if self.0 == PARAMETERS {
            return Ok((as_believed(study), study.at_one_temperature(refitted)));
        }
        progress("fitting the effect", 0.5);
        fitted(study, &refitted, self.0).map(|after| (refitted, after))
    }

    fn is_of_instruments(&self) -> bool {
        find(self.0, "").is_some_and(is_unnoticed)
    }

    fn explains(&self, study: &Study, found: &Self::Found) -> Explains {
        match found {
            Ok((_, after)) if adequate(study, after) => Explains::All,
            Ok(_) => Explains::Part,
            Err(_) => Explains::Nothing,
        }
    }
}

fn adopted_effect(
    effect: &str,
    sources: Sources<'_>,
    motor: &MotorFile,
    progress: &mut Progress<'_>,
) -> Result<(AdoptReport, MotorFile), Error> {
    let is_new = effect != PARAMETERS;
    let answer = in_either_order(&Named(effect), sources, motor, progress)?;
    let (question, (before, after)) = (answer.question, answer.found?);
    let study = &question.study;
    progress("done", 1.0);
    let nominals = fit_report(study, &after).parameters;
    let report = AdoptReport {
        audit: question.audit.clone(),
        stretches: question.stretches.clone(),
        fitted: answer.fitted,
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
    study.at_one_temperature(study.trial(&priors, Effort::NONE))
}

/// Everything that was found, if a law is part of it.
fn adopted_law(
    sources: Sources<'_>,
    motor: &MotorFile,
    laws: Laws,
    progress: &mut Progress<'_>,
) -> Result<(AdoptReport, MotorFile), Error> {
    let missing = Missing {
        excluded: &[],
        shapes: laws.shapes,
    };
    let Answer {
        question,
        found,
        fitted,
        ..
    } = in_either_order(&missing, sources, motor, progress)?;
    let study = &question.study;
    progress("done", 1.0);
    let Some(law) = found.laws.last() else {
        let message = "no law explains these recordings better than the library does: `drivemon explain` says what is missing";
        return Err(Error::UnknownEffect(message.to_owned()));
    };
    if !law.bursts.is_empty() {
        let message = format!(
            "what is missing at `{}` comes and goes: it is a fault to be found and mended, and no law that a model could hold",
            law.action.place.name()
        );
        return Err(Error::UnknownEffect(message));
    }
    let after = match laws.formula {
        Some(number) => chosen_formula(law, number)?,
        None => &law.trial,
    };
    let report = AdoptReport {
        audit: question.audit.clone(),
        stretches: question.stretches.clone(),
        fitted,
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
    sources: Sources<'_>,
    motor: &MotorFile,
    progress: &mut Progress<'_>,
) -> Result<(AdoptReport, MotorFile), Error> {
    let question = Question::new(sources, motor, progress)?;
    let study = &question.study;
    progress("refitting the parameters", 0.2);
    let trial = study.refitted();
    let Some(frame) = judged_frame(&question, motor, &trial) else {
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
        stretches: question.stretches.clone(),
        fitted: Fitted::AsGiven,
        effect: frame::NAME.to_owned(),
        before: errors(frame.fitted_before, frame.held_out_before),
        after: errors(frame.fitted_after, frame.held_out_after),
        proven: frame.proven,
        parameters: Vec::new(),
        nominals: Vec::new(),
        motor_file: String::new(),
        frame: Some(frame),
        laws: Vec::new(),
        speed_scale: speed_scale_report(study, &trial),
        cannot_be_concluded: inconclusive::list(study, &trial, &[]),
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
