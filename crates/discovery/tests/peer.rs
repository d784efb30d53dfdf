//! Recordings by other people's simulators: the hidden effect is found, sized and proven on the second recording.
//!
//! Truth: `tests/data/peer/*/truth.toml`. Sizes are compared with what was hidden there, within the tolerances that
//! the product promises (5 %, dead time 15 %, parameters 2 percentage points).

use discovery::{ExplainReport, Verdict, adopt, compare, explain};
use formats::read_recording;
use motor::MotorFile;
use recording::Source;
use std::path::{Path, PathBuf};

fn folder(set: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/data/peer")
        .join(set)
}

fn motor(set: &str) -> MotorFile {
    MotorFile::read(folder(set).join("motor.toml")).unwrap()
}

/// Both recordings of a set, the one called `fit` first.
fn sources(set: &str, fit: &str) -> Vec<Source> {
    let read = |name: &str| {
        let path = folder(set).join(name);
        Source::Recording(read_recording(&path, &Default::default(), &mut |_| {}).unwrap())
    };
    let (a, b) = (read("recording.csv.gz"), read("recording_b.csv.gz"));
    if fit == "a" { vec![a, b] } else { vec![b, a] }
}

fn explained(set: &str, fit: &str) -> ExplainReport {
    let report = explain(&sources(set, fit), &motor(set), &mut |_, _| {}).unwrap();
    println!("{set}: {}", report.summary);
    report
}

fn value(report: &ExplainReport, name: &str) -> f64 {
    let all = report.steps.iter().flat_map(|s| &s.parameters);
    all.filter(|p| p.name == name)
        .map(|p| p.value)
        .next()
        .unwrap()
}

fn change(report: &ExplainReport, name: &str) -> f64 {
    let last = report.final_.as_ref().unwrap();
    let p = last.parameters.iter().find(|p| p.name == name).unwrap();
    assert!(p.off, "{name} was not found to be off");
    p.change_percent
}

/// The one effect that is named, with a final error of at most 1.04 of the noise.
fn assert_unique(report: &ExplainReport, effect: &str) {
    assert_eq!(report.verdict, Verdict::Effect);
    assert_eq!(report.steps.len(), 1);
    assert_eq!(report.steps[0].effect, effect);
    assert!(report.steps[0].tied_with.is_empty());
    assert!(report.final_.as_ref().unwrap().held_out_error_over_noise < 1.04);
}

fn assert_adequate(report: &ExplainReport) {
    assert_eq!(report.verdict, Verdict::Adequate);
    assert!(report.steps.is_empty());
    assert!(report.final_.as_ref().unwrap().held_out_error_over_noise < 1.02);
}

#[test]
fn nothing_is_found_where_nothing_is_hidden() {
    let report = explained("none", "b");
    assert_adequate(&report);
    assert!(report.final_.unwrap().parameters.iter().all(|p| !p.off));
}

#[test]
fn saturation_is_named_and_sized() {
    let report = explained("magnetizing-saturation", "b");
    assert_unique(&report, "magnetizing-saturation");
    // The plant: i = psi/L_su (1 + (beta psi)^S) with beta 0.84, S 7; relative to the nameplate's flux
    // 326.6 V / 314.16 rad/s the same curve has k = x/(1 + x), x = (0.84 * 1.0396)^7.
    let x = (0.84f64 * 326.6 / 314.16).powi(7);
    let k = x / (1.0 + x);
    assert!((value(&report, "saturation") / k - 1.0).abs() < 0.05);
    assert!((value(&report, "saturation_exponent") / 7.0 - 1.0).abs() < 0.05);
}

#[test]
fn two_masses_are_named_and_sized() {
    let report = explained("shaft-compliance", "b");
    assert_unique(&report, "shaft-compliance");
    let (j_m, j_l, stiffness) = (0.007f64, 0.008, 300.0);
    let hertz = (stiffness * (j_m + j_l) / (j_m * j_l)).sqrt() / std::f64::consts::TAU;
    assert!((value(&report, "torsional_frequency_hz") / hertz - 1.0).abs() < 0.05);
    assert!((value(&report, "motor_inertia_share") / (j_m / (j_m + j_l)) - 1.0).abs() < 0.05);
}

#[test]
fn dead_time_is_named_and_sized() {
    let report = explained("inverter-dead-time", "b");
    assert_unique(&report, "inverter-dead-time");
    // The plant hides a dead time and device drops, not this one voltage: 6.0 V is what an earlier fit of the same
    // form found in the same data, so this holds the fit and is no independent truth.
    assert!((value(&report, "dead_time_voltage_volt") / 6.0 - 1.0).abs() < 0.15);
}

#[test]
fn a_wrong_voltage_channel_is_named_and_sized() {
    let report = explained("voltage-gain-phase-c", "b");
    assert_unique(&report, "phase-voltage-gain");
    assert!((value(&report, "voltage_gain_c") - 1.02).abs() < 0.05 * 0.02);
    assert!((value(&report, "voltage_gain_a") - 1.0).abs() < 0.002);
}

#[test]
fn windage_ties_with_friction_and_a_coast_down_would_tell() {
    let report = explained("windage", "b");
    assert_eq!(report.verdict, Verdict::Ambiguous);
    let step = &report.steps[0];
    assert_eq!(step.effect, "windage");
    assert!(step.tied_with.iter().any(|t| t == "friction_nm_s"));
    assert!(step.separating_test.contains("coast-down"));
    assert!((value(&report, "windage_nm_s2") / 7.5e-5 - 1.0).abs() < 0.05);
}

#[test]
fn a_resistance_that_is_off_is_a_parameter_and_no_effect() {
    let report = explained("stator-resistance-plus-25-percent", "b");
    assert_adequate(&report);
    assert!((change(&report, "stator_resistance_ohm") - 25.0).abs() < 2.0);
}

#[test]
fn an_inertia_that_is_off_is_a_parameter_and_no_effect() {
    let report = explained("inertia-plus-40-percent", "b");
    assert_adequate(&report);
    assert!((change(&report, "inertia_kg_m2") - 40.0).abs() < 2.0);
}

#[test]
fn an_unbalanced_supply_is_an_audit_finding_and_no_effect() {
    let report = explained("supply-unbalance", "b");
    assert_adequate(&report);
    let unbalance = report
        .audit
        .findings
        .iter()
        .map(|f| serde_json::to_value(f).unwrap());
    let unbalance = unbalance.filter(|f| f["code"] == "supply-unbalance");
    let percent = unbalance
        .map(|f| f["value"].as_f64().unwrap())
        .next()
        .unwrap();
    assert!((percent - 2.0).abs() < 0.1);
}

#[test]
fn compare_says_where_the_model_fails() {
    let report = compare(
        &sources("magnetizing-saturation", "a")[..1],
        &motor("magnetizing-saturation"),
        &mut |_, _| {},
    );
    let report = report.unwrap();
    assert!(report.overall.unwrap().error_over_noise > 2.0);
    let band = |from: f64| {
        let bands = report.bands.iter();
        let voltage = bands.filter(|b| b.quantity == "voltage" && b.from_percent == from);
        voltage.map(|b| b.error_over_noise).next().unwrap()
    };
    // Saturation grows with the voltage; the factor is below what the two bands showed when this was written.
    assert!(band(105.0) > 1.5 * band(95.0));
    assert!(
        report
            .regions
            .iter()
            .any(|r| r.name == "start-up" && r.from_s == 0.0)
    );
    assert_eq!(report.signals.len(), 5);
}

#[test]
fn adopting_lowers_the_held_out_error_and_gives_a_motor_file() {
    let set = "voltage-gain-phase-c";
    let mut sources = sources(set, "b");
    let (report, file) =
        adopt("phase-voltage-gain", &sources, &motor(set), &mut |_, _| {}).unwrap();
    assert!(report.proven);
    assert!(report.before.held_out_error_over_noise > 1.7);
    assert!(report.after.held_out_error_over_noise < 1.04);
    let text = file.to_toml();
    let again = MotorFile::parse(&text, "adopted.toml").unwrap();
    sources.reverse();
    // The new file, nothing refitted, on the recording that was not fitted.
    let check = compare(&sources[..1], &again, &mut |_, _| {}).unwrap();
    assert!(check.overall.unwrap().error_over_noise < 1.04);
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let sources = &sources("none", "b")[..1];
    let json = || {
        let report = explain(sources, &motor("none"), &mut |_, _| {}).unwrap();
        serde_json::to_string(&report).unwrap()
    };
    assert_eq!(json(), json());
}

#[test]
fn a_formula_in_the_motor_file_is_found_like_any_other_effect() {
    let set = "windage";
    let text = motor(set).to_toml()
        + "\n[[effects]]\nname = \"expression\"\nformula = \"k*omega*abs(omega)\"\nadds_to = \"torque\"\nk = 0.0\nk_typical = 1e-4\n";
    let open = MotorFile::parse(&text, "formula.toml").unwrap();
    let (report, file) = adopt("expression", &sources(set, "b"), &open, &mut |_, _| {}).unwrap();
    // Friction had swallowed it: the error was small before and stays small, the size is the hidden one.
    assert!(report.after.held_out_error_over_noise < 1.02);
    assert_eq!(report.parameters[0].name, "k");
    assert!((report.parameters[0].value / 7.5e-5 - 1.0).abs() < 0.15);
    let again = MotorFile::parse(&file.to_toml(), "adopted.toml").unwrap();
    assert_eq!(again.effects.len(), 1);
}
