//! What is advised after an explanation, and which model is drawn.

use super::*;
use audit::Audit;
use discovery::{
    BurstsReport, FitReport, Fitted, LawCurve, LawReport, Unexplained, WindingsReport,
};
use motor::MotorFile;

/// A proven law at one phase; `bursts`: it comes and goes.
fn law(bursts: bool) -> LawReport {
    LawReport {
        place: "stator-phase-b".to_owned(),
        coordinate: "time".to_owned(),
        meaning: "change of resistance".to_owned(),
        tied_with: Vec::new(),
        curve: LawCurve::default(),
        formula: None,
        formula_parameters: Vec::new(),
        formulas: Vec::new(),
        explained_percent: 99.0,
        held_out_error_over_noise: 1.0,
        fold_error_over_noise: 1.0,
        held_out_error_over_noise_without: 6.0,
        proven: true,
        bursts: bursts.then(|| BurstsReport {
            count: 0,
            share_of_time_percent: 11.0,
            smallest: 1.0,
            median: 20.0,
            largest: 30.0,
            unit: "ohm".to_owned(),
            bursts: Vec::new(),
        }),
        entry: None,
    }
}

fn report(law: LawReport) -> ExplainReport {
    let fit = FitReport {
        held_out_error_over_noise: 1.0,
        fold_error_over_noise: 1.0,
        parameters: Vec::new(),
        windings: Vec::new(),
    };
    ExplainReport {
        stretches: Vec::new(),
        fitted: Fitted::AsGiven,
        audit: Audit {
            supported: true,
            findings: Vec::new(),
            assumptions: Vec::new(),
            unusable: Vec::new(),
        },
        verdict: Verdict::Law,
        summary: String::new(),
        channels: None,
        baseline: Some(fit.clone()),
        steps: Vec::new(),
        final_: Some(fit),
        ranking: Vec::new(),
        not_testable: Vec::new(),
        laws: vec![law],
        unexplained: None,
        speed_scale: None,
        cannot_be_concluded: Vec::new(),
        next_run: None,
    }
}

#[test]
fn a_law_is_adopted_and_what_comes_and_goes_is_mended() {
    let command = |name: &str| Some(format!("drivemon adopt {name}"));
    let smooth = Next::new(&report(law(false)), &command);
    assert_eq!(smooth.command.as_deref(), Some("drivemon adopt law"));
    let bursts = Next::new(&report(law(true)), &command);
    assert_eq!((bursts.adopt, bursts.command), (None, None));
    assert!(bursts.why.contains("mend it"), "{}", bursts.why);
}

/// Nothing is missing in either of two recordings: no third one would show more.
#[test]
fn recordings_of_a_motor_that_was_changed_are_asked_about_alone() {
    let mut apart = report(law(false));
    (apart.verdict, apart.laws) = (Verdict::Unknown, Vec::new());
    apart.unexplained = Some(Unexplained {
        description: String::new(),
        correlates_with: Vec::new(),
        best_lead: None,
        best_lead_explains_percent: 0.0,
        each_alone: Some(Vec::new()),
    });
    let next = Next::new(&apart, &|name| Some(name.to_owned()));
    assert_eq!(next.command, None);
    assert_eq!(
        next.why,
        "Record both with the same machine on the shaft, or ask about each alone."
    );
}

/// An adequate model is no end where the resistances of a recording show that the motor was changed.
#[test]
fn resistances_that_no_temperature_makes_are_followed_up() {
    let mut adequate = report(law(false));
    (adequate.verdict, adequate.laws) = (Verdict::Adequate, Vec::new());
    let why = |report: &ExplainReport| Next::new(report, &|name| Some(name.to_owned())).why;
    assert!(why(&adequate).starts_with("Nothing to do"));
    let mut windings = WindingsReport {
        proof: 1,
        stator_resistance_change_percent: 8.0,
        rotor_resistance_change_percent: 8.0,
        is_temperature: true,
    };
    let mut with = |windings: WindingsReport| {
        adequate.final_.as_mut().expect("fitted").windings = vec![windings];
        why(&adequate)
    };
    assert!(with(windings).starts_with("Nothing to do"));
    windings.is_temperature = false;
    assert!(with(windings).starts_with("Find out what was changed"));
}

/// No motor file holds it, and a curve without it would be no model of what was found.
#[test]
fn what_comes_and_goes_is_drawn_by_no_model() {
    let text = include_str!("../../../../../motors/peer-2k2.toml");
    let motor = MotorFile::parse(text, "motor").expect("shipped");
    let models = Model::of_explanation(&motor, &report(law(true)), None);
    assert_eq!(models.len(), 2, "as believed, and with parameters refitted");
}

#[test]
fn a_recording_that_proves_is_drawn_as_warm_as_the_motor_was() {
    let text = include_str!("../../../../../motors/peer-2k2.toml");
    let motor = MotorFile::parse(text, "motor").expect("shipped");
    let mut warm = report(law(false));
    warm.final_.as_mut().expect("fitted").windings = vec![WindingsReport {
        proof: 2,
        stator_resistance_change_percent: 8.0,
        rotor_resistance_change_percent: -5.0,
        is_temperature: false,
    }];
    let factors = |proof: Option<usize>, k: usize| {
        let plant = &Model::of_explanation(&motor, &warm, proof)[k].plant.motor;
        (
            plant.r_s / motor.parameters.r_s,
            plant.r_r / motor.parameters.r_r,
        )
    };
    assert_eq!(factors(Some(2), 0), (1.0, 1.0), "the motor file's own");
    let (stator, rotor) = factors(Some(2), 1);
    assert!((stator - 1.08).abs() < 1e-12 && (rotor - 0.95).abs() < 1e-12);
    assert_eq!(factors(Some(1), 1), (1.0, 1.0));
    assert_eq!(factors(None, 1), (1.0, 1.0));
}
