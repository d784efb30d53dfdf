use super::*;
use crate::report::parameter::NominalReport;
use crate::report::types::{DifferenceReport, FitReport, StepReport, Unexplained};
use crate::report::unexplained::apart;
use audit::Audit;
use estimation::data::given::Fitted;
use estimation::proof::windings::WindingsReport;

fn nominal(name: &str, off: bool, change_percent: f64) -> NominalReport {
    NominalReport {
        name: name.to_owned(),
        believed: 1.0,
        value: 1.0,
        std_error: 0.1,
        unit: "ohm".to_owned(),
        off,
        change_percent,
    }
}

fn step(effect: &str, tied: &[&str], test: &str) -> StepReport {
    StepReport {
        effect: effect.to_owned(),
        form: String::new(),
        kind: "physics".to_owned(),
        tied_with: tied.iter().map(ToString::to_string).collect(),
        separating_test: test.to_owned(),
        symptom: String::new(),
        held_out_error_over_noise: 1.0,
        fold_error_over_noise: 1.0,
        explained_percent: 100.0,
        loss_watt: None,
        parameters: Vec::new(),
        frame: None,
    }
}

fn said(verdict: Verdict, parameters: &[NominalReport], steps: &[StepReport]) -> String {
    summary(&report(verdict, parameters, steps))
}

fn report(verdict: Verdict, parameters: &[NominalReport], steps: &[StepReport]) -> ExplainReport {
    ExplainReport {
        stretches: Vec::new(),
        fitted: Fitted::AsGiven,
        audit: Audit {
            supported: true,
            findings: Vec::new(),
            assumptions: Vec::new(),
            unusable: Vec::new(),
        },
        verdict,
        summary: String::new(),
        channels: None,
        baseline: None,
        steps: steps.to_vec(),
        final_: Some(FitReport {
            held_out_error_over_noise: 1.0,
            fold_error_over_noise: 1.0,
            parameters: parameters.to_vec(),
            windings: Vec::new(),
        }),
        ranking: Vec::new(),
        not_testable: Vec::new(),
        laws: Vec::new(),
        unexplained: (verdict == Verdict::Unknown).then(|| Unexplained {
            description: "It is loud.".to_owned(),
            correlates_with: Vec::new(),
            best_lead: None,
            best_lead_explains_percent: 0.0,
            each_alone: None,
        }),
        speed_scale: None,
        cannot_be_concluded: Vec::new(),
        next_run: None,
    }
}

const OFF: &str = " Parameters that are off: r +12.3 %, l -7.0 %.";

fn moved() -> [NominalReport; 3] {
    [
        nominal("r", true, 12.34),
        nominal("quiet", false, 3.0),
        nominal("l", true, -7.0),
    ]
}

#[test]
fn an_adequate_model_is_said_to_explain_with_what_moved() {
    let plain = "The model explains the recording.";
    assert_eq!(said(Verdict::Adequate, &[], &[]), plain);
    assert_eq!(said(Verdict::Adequate, &moved()[1..2], &[]), plain);
    assert_eq!(
        said(Verdict::Adequate, &moved(), &[]),
        format!("{plain}{OFF}")
    );
}

/// What is left over counts as noise only because the noise is hardly known: that is said.
#[test]
fn a_model_that_is_adequate_for_want_of_a_known_noise_is_said_to_be_so() {
    let mut report = report(Verdict::Adequate, &moved(), &[]);
    for (folds, held_out, is_more) in [(1.019, 1.019, false), (1.0, 1.11, true), (1.11, 1.0, true)]
    {
        if let Some(last) = &mut report.final_ {
            (last.fold_error_over_noise, last.held_out_error_over_noise) = (folds, held_out);
        }
        let said = summary(&report);
        assert_eq!(
            said.contains("as far as its noise is known: the error is 1.11 x noise"),
            is_more,
            "{said}"
        );
        assert!(said.ends_with(OFF), "{said}");
    }
}

#[test]
fn effects_are_named_in_their_order() {
    let steps = [step("windage", &[], "x"), step("core-loss", &[], "y")];
    let plain = "Missing: windage; core-loss.";
    assert_eq!(said(Verdict::Effect, &[], &steps), plain);
    assert_eq!(
        said(Verdict::Effect, &moved(), &steps),
        format!("{plain}{OFF}")
    );
}

/// The test is that of the first step that something ties with.
#[test]
fn an_ambiguity_comes_with_the_test_that_ends_it() {
    let steps = [
        step("saturation", &[], "not this"),
        step("windage", &["friction", "core-loss"], "a coast-down"),
    ];
    let plain =
        "Missing: saturation; windage (or friction or core-loss). To separate: a coast-down.";
    assert_eq!(said(Verdict::Ambiguous, &[], &steps), plain);
    assert_eq!(
        said(Verdict::Ambiguous, &moved(), &steps),
        format!("{plain}{OFF}")
    );
}

#[test]
fn the_other_verdicts_have_a_sentence_each() {
    assert_eq!(
        said(Verdict::Implausible, &moved(), &[]),
        format!("Only parameters that no such motor has explain the recording.{OFF}")
    );
    assert_eq!(
        said(Verdict::Unknown, &[], &[]),
        "Something is missing that the library does not hold. It is loud."
    );
    assert_eq!(
        said(Verdict::Unsupported, &[], &[]),
        "The recording cannot be judged."
    );
}

/// An effect that leaves nothing, shown by too little of a recording to be proven: there is nothing to look for outside the library.
#[test]
fn what_few_moments_show_is_asked_for_once_more() {
    let with_lead = |percent: f64| {
        let mut report = report(Verdict::Unknown, &[], &[]);
        let rest = report.unexplained.as_mut().expect("unknown");
        rest.best_lead = Some("speed-delay".to_owned());
        rest.best_lead_explains_percent = percent;
        summary(&report)
    };
    assert_eq!(
        with_lead(96.0),
        "Something is missing, but too few moments of the recording show it to prove what: speed-delay would explain it. \
         Record more starts and more steps of load and voltage. It is loud."
    );
    assert_eq!(with_lead(60.0), said(Verdict::Unknown, &[], &[]));
}

/// Nothing is missing where two recordings ask for other parameters.
#[test]
fn recordings_that_are_explained_one_by_one_say_what_differs() {
    let told = |differences: Vec<DifferenceReport>| {
        let mut report = report(Verdict::Unknown, &[], &[]);
        report.unexplained = Some(apart(differences));
        summary(&report)
    };
    let rest = ". A motor looks so that was changed between them, or what it drives.";
    let both = "The model explains each recording alone, but not both with the same parameters";
    assert_eq!(told(Vec::new()), format!("{both}{rest}"));
    let heavier = DifferenceReport {
        name: "inertia_kg_m2".to_owned(),
        change_percent: 19.96,
    };
    assert_eq!(
        told(vec![heavier]),
        format!("{both} (inertia_kg_m2 +20.0 % from the first to the second){rest}")
    );
}

/// What is found of a motor that was warmer in the recording that proves says so; what is missing unnamed moves resistances, too.
#[test]
fn a_motor_that_was_warmer_is_told_so_where_the_model_explains_it() {
    let mut report = report(Verdict::Adequate, &[], &[]);
    let warmer = WindingsReport {
        proof: 1,
        stator_resistance_change_percent: 8.04,
        rotor_resistance_change_percent: 7.96,
        is_temperature: true,
    };
    report.final_.as_mut().expect("fitted").windings = vec![warmer];
    assert_eq!(
        summary(&report),
        "The model explains the recording. The motor was warmer in the recording that proves (stator resistance +8.0 %, rotor resistance +8.0 %)."
    );
}
