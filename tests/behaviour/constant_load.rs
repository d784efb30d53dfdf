//! A healthy motor at constant load, where the noise of the inputs is the only thing that moves: nothing may be called off,
//! and what is off must still be found.

use crate::common::in_project;
use discovery::{ExplainReport, Verdict, adopt, compare, explain};
use motor::MotorFile;
use recording::{Channel, Recording, Source};
use scenario::Scenario;
use scenario::simulate::record;

/// Ten seconds of the 2.2 kW motor on a load profile, its torque measured, 0.2 % noise.
fn recorded(profile: &str, seed: u32) -> Recording {
    let text = format!(
        "motor = \"motors/peer-2k2.toml\"\nduration_s = 10.0\nsample_rate_hz = 5000.0\nstart = \"running\"\nseed = {seed}\n\
         [load]\nfriction_percent = 0.0\nactive = true\nprofile = [{profile}]\n\
         [sensors]\nnoise_sigma_fraction_of_full_scale = 0.002\ntorque = true\n"
    );
    let scenario = Scenario::parse(&text, "constant load", &in_project("")).expect("a scenario");
    record(&scenario, |_| {}).expect("a recording")
}

const CONSTANT: &str = "{ at_s = 0.0, torque_percent = 80.0 }";

fn motor() -> MotorFile {
    MotorFile::read(in_project("motors/peer-2k2.toml")).expect("a motor file")
}

fn off(report: &ExplainReport) -> Vec<&str> {
    let last = report.final_.as_ref().expect("fitted");
    last.parameters
        .iter()
        .filter(|p| p.off)
        .map(|p| p.name.as_str())
        .collect()
}

fn without(rec: &Recording, gone: &[Channel]) -> Recording {
    let mut metadata = rec.metadata.clone();
    metadata.load_torque = recording::LoadTorque::Free;
    let empty = Recording::new(rec.name(), rec.t().to_vec(), metadata).expect("a clock");
    let kept = rec
        .channels()
        .filter(|(channel, _)| !gone.contains(channel));
    kept.fold(empty, |rec, (channel, x)| {
        rec.with_channel(channel, x.to_vec()).expect("a channel")
    })
}

#[test]
fn a_healthy_motor_at_constant_load_is_adequate_and_nothing_is_gained() {
    let source = [Source::Recording(recorded(CONSTANT, 1))];
    let report = explain(&source, &motor(), &mut |_, _| {}).expect("explained");
    assert_eq!(report.verdict, Verdict::Adequate, "{}", report.summary);
    assert_eq!(off(&report), [""; 0]);
    let leakage = &report.final_.as_ref().expect("fitted").parameters[2];
    // The simulated motor is the believed one; the belief's own error is ten per cent.
    assert!(
        leakage.change_percent.abs() < 10.0,
        "{}",
        leakage.change_percent
    );
    let (adopted, _) = adopt("parameters", &source, &motor(), &mut |_, _| {}).expect("fitted");
    assert!(!adopted.proven);
}

#[test]
fn a_rotor_resistance_that_is_off_is_found_at_constant_load() {
    let source = [Source::Recording(recorded(CONSTANT, 2))];
    let mut believed = motor();
    believed.parameters.r_r /= 1.25;
    let report = explain(&source, &believed, &mut |_, _| {}).expect("explained");
    assert_eq!(report.verdict, Verdict::Adequate, "{}", report.summary);
    assert_eq!(off(&report), ["rotor_resistance_ohm"]);
    let found = &report.final_.as_ref().expect("fitted").parameters[1];
    // Three of its standard errors, which the instruments' class decides.
    assert!(
        (found.change_percent - 25.0).abs() < 4.0,
        "{}",
        found.change_percent
    );
    let (adopted, _) = adopt("parameters", &source, &believed, &mut |_, _| {}).expect("fitted");
    assert!(adopted.proven);
}

#[test]
fn without_speed_and_torque_nothing_is_concluded() {
    let rec = without(&recorded(CONSTANT, 3), &[Channel::SPEED, Channel::TORQUE]);
    let report = explain(&[Source::Recording(rec)], &motor(), &mut |_, _| {}).expect("answered");
    assert_eq!(report.verdict, Verdict::Unsupported);
    assert!(
        report.summary.contains("`speed`") && report.summary.contains("`torque`"),
        "{}",
        report.summary
    );
}

/// Loads of 40, 75 and 100 %: what the motor's air gap carries tells them where no torque was measured.
#[test]
fn regions_are_named_by_the_load_of_the_air_gap() {
    let profile = "{ at_s = 0.0, torque_percent = 40.0 }, { at_s = 3.0, torque_percent = 75.0 }, \
                   { at_s = 6.0, torque_percent = 100.0 }";
    let rec = without(&recorded(profile, 4), &[Channel::TORQUE]);
    let report = compare(&[Source::Recording(rec)], &motor(), &mut |_, _| {}).expect("compared");
    let named = |load: &str| report.regions.iter().any(|r| r.name.starts_with(load));
    for load in ["load 40 %", "load 75 %", "load 100 %"] {
        assert!(
            named(load),
            "{load}: {:?}",
            report.regions.iter().map(|r| &r.name).collect::<Vec<_>>()
        );
    }
}
