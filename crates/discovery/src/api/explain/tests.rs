use super::*;
use crate::api::errors;
use crate::explain::Step;
use crate::search::refit::{Candidate, Round, combined};
use crate::search::screen::Screened;
use estimation::model::prior::{FRICTION, MAGNETIZING};
use estimation::specimen::{self, apparent_power, with};
use motor::effects::names;
use recording::Source;

fn question(sources: &[Source]) -> Question {
    Question::new(sources, &specimen::motor(""), &mut |_, _| {}).expect("judged")
}

/// A question about two tables of the believed machine: one is fitted, one proves.
fn tables() -> Question {
    question(&[
        specimen::table_source(|_| ()),
        specimen::table_source(|_| ()),
    ])
}

/// A trial with effects of a typical size, and these errors over noise.
fn trial(study: &Study, effects: &[&str], folds: f64, proof: f64) -> Trial {
    let effects: Vec<(&str, f64)> = effects.iter().map(|name| (*name, 1.0)).collect();
    let trial = specimen::trial_with(study, &effects);
    specimen::with_errors(study, &trial, folds, proof)
}

fn candidate(study: &Study, name: &'static str, error: f64) -> Candidate {
    let trial = trial(study, &[name], error, error);
    let error = combined(study, &trial);
    Candidate { name, trial, error }
}

/// What was found: nothing beyond the parameters.
fn nothing(study: &Study, error: f64) -> Explanation {
    Explanation {
        baseline: trial(study, &[], error, error),
        first: Round::empty(),
        steps: Vec::new(),
        laws: Vec::new(),
        contests: Vec::new(),
        nameable: true,
        open: None,
    }
}

/// One effect after the other, from each error over noise to the next; each tied with `tied`.
fn stepwise(study: &Study, effects: &[&str], errors: &[f64], tied: &[&'static str]) -> Explanation {
    let one = |k: usize| Step {
        before: trial(study, &effects[..k], errors[k], errors[k]),
        trial: trial(study, &effects[..=k], errors[k + 1], errors[k + 1]),
        rivals: tied
            .iter()
            .map(|name| candidate(study, name, errors[k + 1]))
            .collect(),
    };
    Explanation {
        steps: (0..effects.len()).map(one).collect(),
        ..nothing(study, errors[0])
    }
}

/// An effect as if a screen had left this error over noise, and had seen this share of it.
fn screened(study: &Study, name: &str, error: f64, visibility: f64) -> Screened {
    let expected = study.fitted.floor.mean * study.fitted.case.judged();
    Screened {
        config: specimen::effect(name, 1.0),
        held_out: trial(study, &[], error, 1.0).folds,
        possible: true,
        visible: ((1.0 + visibility) * (1.0 + visibility) - 1.0) * expected,
        visible_with_known_scale: None,
    }
}

fn frame(proven: bool) -> FrameReport {
    FrameReport {
        windows: 12,
        held_out_before: 3.0,
        held_out_after: 1.5,
        fitted_before: 4.0,
        fitted_after: 2.0,
        proven,
        by_load: Vec::new(),
    }
}

/// A table of a machine whose core takes 4 % of the rated apparent power, beside the prior that it takes none.
#[test]
fn a_loss_that_the_model_misses_is_named_and_sized() {
    let mut told = Vec::new();
    let sources = [specimen::table_source(with("core-loss", 2.0))];
    let report = explain(&sources, &specimen::motor(""), &mut |what, share| {
        told.push((what.to_owned(), share));
    });
    let report = report.expect("judged");
    assert_eq!(report.verdict, Verdict::Effect);
    assert!(
        report.summary.starts_with("Missing: core-loss."),
        "{}",
        report.summary
    );
    let [step] = &report.steps[..] else {
        panic!("one step: {:?}", report.steps);
    };
    assert_eq!(
        (step.effect.as_str(), step.kind.as_str()),
        ("core-loss", "physics")
    );
    assert!(step.separating_test.contains("no-load") && step.symptom.contains("no load"));
    let expected = 0.04 * apparent_power();
    let watt = step.loss_watt.expect("a loss");
    assert!((watt / expected - 1.0).abs() < 0.02, "{watt} {expected}");
    // The same as a resistance: three phases at 220 V between lines.
    let ohm = step.parameters[0].value;
    assert!((ohm * watt / 220.0f64.powi(2) - 1.0).abs() < 1e-6, "{ohm}");
    let [before, after] = [&report.baseline, &report.final_]
        .map(|fit| fit.as_ref().expect("fitted").held_out_error_over_noise);
    assert!(before > 2.0 && after < 0.1);
    assert!(report.unexplained.is_none() && report.speed_scale.is_none());
    assert_eq!(report.ranking[0].effect, "core-loss");
    assert!(report.not_testable.contains(&"load-pulsation".to_owned()));
    assert!(!report.not_testable.contains(&"windage".to_owned()));
    let shares: Vec<f64> = told.iter().map(|t| t.1).collect();
    assert!(shares[1..].is_sorted(), "{told:?}");
    assert_eq!(told.last(), Some(&("done".to_owned(), 1.0)));
    let nothing = explain_without(&sources, &specimen::motor(""), &[], &mut |_, _| {});
    assert_eq!(nothing.expect("judged"), report);
}

/// Without the truth the library holds nothing that explains the table: nothing is named, no parameter is called off.
#[test]
fn without_the_truth_nothing_is_named() {
    let sources = [specimen::table_source(with("core-loss", 4.0))];
    let mut known = names();
    known.retain(|name| !["current-gain", "voltage-gain", "magnetizing-saturation"].contains(name));
    let report = explain_without(&sources, &specimen::motor(""), &known, &mut |_, _| {});
    let report = report.expect("judged");
    assert_eq!(report.verdict, Verdict::Unknown);
    assert!(report.steps.is_empty() && report.unexplained.is_some());
    assert!(report.summary.contains("the library does not hold"));
    let fits = [report.baseline, report.final_].map(|fit| fit.expect("fitted"));
    assert!(fits.iter().flat_map(|f| &f.parameters).all(|p| !p.off));
    let mut moved = fits[0].parameters.iter().map(|p| p.change_percent.abs());
    assert!(
        moved.any(|percent| percent > 20.0),
        "the fit bent the parameters"
    );
}

#[test]
fn what_cannot_be_judged_is_a_verdict_and_a_wrong_question_an_error() {
    let short = [Source::Recording(specimen::recording(0.19, |_| 1.0))];
    let report = explain(&short, &specimen::motor(""), &mut |_, _| {}).expect("a report");
    assert_eq!(report.verdict, Verdict::Unsupported);
    assert_eq!(
        report.summary,
        "the recording is shorter than five blocks of 40 ms; record at least one second"
    );
    assert!(report.baseline.is_none() && report.final_.is_none());
    let error = explain(&[], &specimen::motor(""), &mut |_, _| {}).err();
    assert!(matches!(error, Some(Error::Recordings(_))));
}

#[test]
fn a_verdict_is_the_gravest_that_applies() {
    let question = tables();
    let study = &question.study;
    let of = |found: &Explanation| verdict(study, found, &steps(study, found));
    assert_eq!(of(&nothing(study, 1.0)), Verdict::Adequate);
    let mut found = stepwise(study, &["core-loss"], &[3.0, 1.0], &[]);
    assert_eq!(of(&found), Verdict::Effect);
    found.steps[0].rivals.push(candidate(study, "windage", 1.0));
    assert_eq!(of(&found), Verdict::Ambiguous);
    found.steps[0].trial.off = std::sync::OnceLock::new();
    found.steps[0].trial.fit.hypothesis.z[MAGNETIZING] = 1.0;
    assert_eq!(
        of(&found),
        Verdict::Ambiguous,
        "far, but not shown to be off"
    );
    found.steps[0].trial.off = std::sync::OnceLock::from(vec![MAGNETIZING]);
    assert_eq!(of(&found), Verdict::Implausible);
    found.nameable = false;
    assert_eq!(verdict(study, &found, &[]), Verdict::Unknown);
}

/// What is not proven is not reported: neither its effect nor the parameters that it would ask for.
#[test]
fn the_parameters_of_an_unknown_are_those_of_the_baseline() {
    let question = tables();
    let mut found = stepwise(&question.study, &["core-loss"], &[3.0, 2.0], &[]);
    found.steps[0].trial.fit.hypothesis.z[0] = 0.3;
    found.nameable = false;
    let report = report(&question, &found, None, Fitted::AsGiven);
    assert_eq!(report.verdict, Verdict::Unknown);
    let values = |fit: &Option<crate::report::types::FitReport>| {
        let parameters = &fit.as_ref().expect("fitted").parameters;
        parameters.iter().map(|p| p.value).collect::<Vec<f64>>()
    };
    assert_eq!(values(&report.final_), values(&report.baseline));
}

/// From 3 to 2 times the noise five eighths of the excess go, from 2 to 1 all of it.
#[test]
fn steps_tell_what_each_effect_brought_and_what_ties_with_it() {
    let question = tables();
    let study = &question.study;
    let effects = ["core-loss", "windage"];
    let tied = ["windage", "current-gain", "core-loss"];
    let found = stepwise(study, &effects, &[3.0, 2.0, 1.0], &tied);
    let steps = steps(study, &found);
    let names: Vec<&str> = steps.iter().map(|s| s.effect.as_str()).collect();
    assert_eq!(names, effects);
    for (step, [error, percent]) in steps.iter().zip([[2.0, 62.5], [1.0, 100.0]]) {
        assert!((step.fold_error_over_noise - error).abs() < 1e-9);
        assert!((step.held_out_error_over_noise - error).abs() < 1e-9);
        assert!((step.explained_percent - percent).abs() < 1e-9);
        // What was accepted beside it is no look-alike.
        assert_eq!(step.tied_with, ["current-gain"]);
        assert_eq!(step.parameters.len(), 1);
    }
    let watt = steps[0].loss_watt.expect("a loss");
    assert!((watt / (0.02 * apparent_power()) - 1.0).abs() < 1e-9);
    let windage = 0.1 * 1.7 * 60.0 * std::f64::consts::PI;
    let watt = steps[1].loss_watt.expect("a loss");
    assert!((watt / windage - 1.0).abs() < 1e-9);
}

/// A friction that moved may be any loss torque; a sensor it cannot be.
#[test]
fn a_moved_parameter_that_an_effect_explains_as_well_is_a_step_of_both() {
    let question = tables();
    let study = &question.study;
    let all = ["current-gain", "windage", "coulomb-friction"];
    let all = all.map(|name| candidate(study, name, 1.0));
    let mut found = nothing(study, 1.0);
    found.contests = vec![
        (FRICTION, all.to_vec()),
        (FRICTION, all[..1].to_vec()),
        (0, all.to_vec()),
    ];
    let steps = steps(study, &found);
    assert_eq!(steps.len(), 1);
    assert_eq!(steps[0].effect, "windage");
    let others = ["friction_nm_s", "current-gain", "coulomb-friction"];
    assert_eq!(steps[0].tied_with, others);
    assert_eq!(verdict(study, &found, &steps), Verdict::Ambiguous);
}

/// Folds at 4, proof at 2: what a screen leaves of the folds is taken as the same share of the proof.
#[test]
fn effects_are_ranked_by_their_held_out_error() {
    let question = tables();
    let study = &question.study;
    let mut found = nothing(study, 1.0);
    found.baseline = trial(study, &[], 4.0, 2.0);
    found.first.screened = vec![
        screened(study, "windage", 3.0, 0.3),
        screened(study, "core-loss", 3.9, 0.1),
        screened(study, "windage", 1.0, 0.9),
        screened(study, "current-gain", 5.0, 0.2),
    ];
    found.first.candidates = vec![candidate(study, "core-loss", 0.5)];
    let rows = ranking(study, &found);
    let names: Vec<&str> = rows.iter().map(|r| r.effect.as_str()).collect();
    assert_eq!(names, ["core-loss", "windage", "current-gain"]);
    let expected = [[0.5, 75.0, 10.0], [1.5, 25.0, 30.0], [2.5, -25.0, 20.0]];
    for (row, [error, gain, visibility]) in rows.iter().zip(expected) {
        assert!(
            (row.held_out_error_over_noise - error).abs() < 1e-9,
            "{row:?}"
        );
        assert!((row.gain_percent - gain).abs() < 1e-9, "{row:?}");
        assert!(
            (row.visibility_percent - visibility).abs() < 1e-9,
            "{row:?}"
        );
        assert_eq!(row.refitted, row.effect == "core-loss");
    }
}

/// Two per cent of the noise can be seen; the best point of an effect's grid speaks for it.
#[test]
fn not_testable_is_what_no_point_of_its_grid_would_show() {
    let question = tables();
    let study = &question.study;
    let mut found = nothing(study, 1.0);
    found.first.screened = vec![
        screened(study, "windage", 1.0, 0.021),
        screened(study, "windage", 1.0, 0.001),
        screened(study, "core-loss", 1.0, 0.001),
        screened(study, "core-loss", 1.0, 0.019),
    ];
    assert_eq!(not_testable(study, &found), ["core-loss"]);
}

/// From 3 to 2 times the noise: five eighths.
#[test]
fn the_best_lead_is_named_if_it_explains_anything() {
    let question = tables();
    let study = &question.study;
    let lead = |error: Option<f64>| {
        let mut found = nothing(study, 3.0);
        let candidates = error.map(|error| candidate(study, "windage", error));
        found.first.candidates = candidates.into_iter().collect();
        let told = unexplained(study, &found);
        (told.best_lead, told.best_lead_explains_percent)
    };
    let (name, percent) = lead(Some(2.0));
    assert_eq!(name.as_deref(), Some("windage"));
    assert!((percent - 62.5).abs() < 1e-9);
    assert_eq!(lead(Some(3.0)), (None, 0.0));
    assert_eq!(lead(Some(3.5)), (None, 0.0));
    assert_eq!(lead(None), (None, 0.0));
}

/// `r1` falls from 3 to 1.5 times its noise: of an excess of 8 remain 1.25.
#[test]
fn a_wrong_frame_comes_before_all_physics() {
    let question = tables();
    let study = &question.study;
    let mut found = stepwise(study, &["core-loss"], &[3.0, 1.0], &[]);
    found.steps[0].trial.fit.hypothesis.z[0] = 0.2;
    found.steps[0].trial = specimen::known_to(&found.steps[0].trial, &[0.01; 5]);
    found.steps[0].trial.off = std::sync::OnceLock::from(vec![0]);
    let plain = report(&question, &found, None, Fitted::AsGiven);
    assert_eq!((plain.verdict, plain.steps.len()), (Verdict::Effect, 1));
    assert!(plain.unexplained.is_none());
    let off = |fit: &Option<crate::report::types::FitReport>| {
        let parameters = &fit.as_ref().expect("fitted").parameters;
        parameters.iter().filter(|p| p.off).count()
    };
    assert_eq!((off(&plain.baseline), off(&plain.final_)), (0, 1));
    assert_eq!(
        report(&question, &found, Some(frame(false)), Fitted::AsGiven),
        plain,
        "not proven"
    );
    let framed = report(&question, &found, Some(frame(true)), Fitted::AsGiven);
    assert_eq!(framed.verdict, Verdict::Effect);
    assert!(
        framed
            .summary
            .starts_with("Missing: rotor-flux-frame; core-loss.")
    );
    assert_eq!(framed.steps[1..], plain.steps);
    let step = &framed.steps[0];
    assert_eq!(
        (step.effect.as_str(), step.kind.as_str()),
        ("rotor-flux-frame", "model")
    );
    assert!((step.explained_percent - 100.0 * (1.0 - 1.25 / 8.0)).abs() < 1e-9);
    assert_eq!(
        (step.held_out_error_over_noise, step.fold_error_over_noise),
        (1.5, 1.5)
    );
    assert_eq!(step.frame, Some(frame(true)));
    let below = FrameReport {
        held_out_after: 0.9,
        ..frame(true)
    };
    assert_eq!(
        frame_step(below).explained_percent,
        100.0,
        "nothing is left over the noise"
    );

    let adequate = report(
        &question,
        &nothing(study, 1.0),
        Some(frame(true)),
        Fitted::AsGiven,
    );
    assert_eq!(
        adequate.verdict,
        Verdict::Effect,
        "the monitor's model is wrong"
    );
    found.nameable = false;
    let unknown = report(&question, &found, Some(frame(true)), Fitted::AsGiven);
    assert_eq!(
        (unknown.verdict, unknown.steps.len()),
        (Verdict::Unknown, 1)
    );
    assert!(unknown.unexplained.is_some());
    assert_eq!((off(&unknown.baseline), off(&unknown.final_)), (0, 0));
}

/// Residuals of two noises are an error of two, whatever the folds say.
#[test]
fn errors_are_those_of_the_fit_and_of_what_was_held_out() {
    let study = specimen::proven_table_study(|_| ());
    let mut trial = trial(&study, &[], 5.0, 3.0);
    trial.fit.residual = vec![2.0; 47];
    let got = errors(&study, &trial);
    assert!((got.error_over_noise - 2.0).abs() < 1e-12);
    assert!((got.held_out_error_over_noise - 3.0).abs() < 1e-12);
}
