//! Recordings by other people's simulators whose speed is given up to a factor and an offset: what is hidden is still
//! found, and the factor with it. Truth: `tests/data/peer/*/truth.toml`, and the sidecars' own scale.

use discovery::{AtRest, ExplainReport, Verdict, adopt, compare, explain};
use formats::read_recording;
use motor::MotorFile;
use recording::{Channel, Mapping, Recording, Source, UNITS, UnknownScale};
use std::path::{Path, PathBuf};

/// What the tachometer shows: an odd factor on the speed, and not zero at rest.
const GAIN: f64 = -9.7;
const AT_REST: f64 = 31.0;

fn folder(set: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/data/peer")
        .join(set)
}

fn motor(set: &str) -> MotorFile {
    MotorFile::read(folder(set).join("motor.toml")).unwrap()
}

/// The recording with a tachometer of unknown scale; without the torque nothing but the speed tells the load.
fn with_tachometer(recording: &Recording, torque: bool) -> Source {
    let t = recording.t().to_vec();
    let mut changed = Recording::new(recording.name(), t, recording.metadata.clone()).unwrap();
    for (channel, values) in recording.channels() {
        let shown = match channel {
            Channel::SPEED => values.iter().map(|x| GAIN * x + AT_REST).collect(),
            Channel::TORQUE if !torque => continue,
            _ => values.to_vec(),
        };
        changed = changed.with_channel(channel, shown).unwrap();
    }
    if !torque {
        changed.metadata.load_torque = recording::LoadTorque::Free;
    }
    changed.unknown_speed_scale = Some(Box::new(UnknownScale {
        unit: *UNITS.iter().find(|unit| unit.name == "rad/s").unwrap(),
        offset: None,
    }));
    Source::Recording(changed)
}

/// Both recordings of a set, the second one to be fitted.
fn sources(set: &str, torque: bool) -> Vec<Source> {
    let read = |name: &str| {
        let path = folder(set).join(name);
        let recording = read_recording(&path, &Mapping::default(), &mut |_| {}).unwrap();
        with_tachometer(&recording, torque)
    };
    vec![read("recording_b.csv.gz"), read("recording.csv.gz")]
}

fn explained(set: &str) -> ExplainReport {
    let report = explain(&sources(set, true), &motor(set), &mut |_, _| {}).unwrap();
    let scale = report.speed_scale.as_ref().unwrap();
    println!("{set}: {} {scale:?}", report.summary);
    for one in &report.cannot_be_concluded {
        println!("  {}: {}", one.name, one.why);
    }
    report
}

/// The factor is the hidden one, within half a per cent and within four of its standard errors.
fn assert_factor(report: &ExplainReport) {
    let scale = report.speed_scale.as_ref().unwrap();
    let off = scale.factor - 1.0 / GAIN;
    assert!((off * GAIN).abs() < 0.005, "{scale:?}");
    assert!(off.abs() < 4.0 * scale.std_error, "{scale:?}");
    assert_eq!(scale.offset_is, AtRest::Measured);
    // The noise of the speed is 0.4 rad/s; five samples are averaged.
    let noise = 0.4 * GAIN.abs() / 5f64.sqrt();
    assert!(
        (scale.offset_std_error / noise - 1.0).abs() < 0.1,
        "{scale:?}"
    );
    assert!((scale.offset - AT_REST).abs() < 4.0 * noise, "{scale:?}");
}

fn assert_unique(report: &ExplainReport, effect: &str) {
    assert_eq!(report.verdict, Verdict::Effect, "{}", report.summary);
    assert_eq!(report.steps.len(), 1);
    assert_eq!(report.steps[0].effect, effect);
    assert!(report.steps[0].tied_with.is_empty());
}

#[test]
fn saturation_is_found_beside_an_unknown_scale() {
    let report = explained("magnetizing-saturation");
    assert_unique(&report, "magnetizing-saturation");
    assert_factor(&report);
    // The hidden curve at the nameplate's flux: tests/peer.rs.
    let x = (0.84f64 * 326.6 / 314.16).powi(7);
    let found = report.steps[0].parameters[0].value;
    assert!((found / (x / (1.0 + x)) - 1.0).abs() < 0.05, "{found}");
}

#[test]
fn two_masses_are_found_beside_an_unknown_scale() {
    let report = explained("shaft-compliance");
    assert_unique(&report, "shaft-compliance");
    assert_factor(&report);
}

#[test]
fn nothing_is_found_where_only_the_scale_is_unknown() {
    let report = explained("none");
    assert_eq!(report.verdict, Verdict::Adequate, "{}", report.summary);
    assert!(report.steps.is_empty());
    assert_factor(&report);
    // The sensor itself is always among what cannot be judged.
    let open: Vec<&str> = report
        .cannot_be_concluded
        .iter()
        .map(|one| one.name.as_str())
        .collect();
    assert!(open.contains(&"speed-scale"), "{open:?}");
    assert!(report.ranking.iter().all(|row| row.effect != "speed-scale"));
}

#[test]
fn at_one_load_slip_and_rotor_resistance_cannot_be_told_from_the_scale() {
    let Source::Recording(whole) = sources("none", false).swap_remove(1) else {
        unreachable!()
    };
    // Rated torque from 2 s to 2.5 s: one load, one voltage, a speed that is an input because the torque is not recorded.
    let mut part = whole.slice(21_000..24_800).unwrap();
    part.metadata.starts_from = recording::StartsFrom::Running;
    let source = [Source::Recording(part)];
    let report = compare(&source, &motor("none"), &mut |_, _| {}).unwrap();
    let scale = report.speed_scale.unwrap();
    assert_eq!(scale.offset_is, AtRest::Assumed);
    let resistance = report
        .cannot_be_concluded
        .iter()
        .find(|one| one.name == "rotor_resistance_ohm")
        .expect("it shares its pattern with the scale");
    println!("{scale:?} {resistance:?}");
    assert!(resistance.correlation_with_scale.unwrap().abs() > 0.9);
    let [free, known] = [
        resistance.std_error_percent.unwrap(),
        resistance.std_error_with_known_scale_percent.unwrap(),
    ];
    assert!(free > 2.0 * known, "{free} {known}");
    let open = report.cannot_be_concluded.iter();
    assert!(open.clone().any(|one| one.name == "slip"));
    assert!(open.clone().all(|one| one.name != "stator_resistance_ohm"));
}

#[test]
fn the_scale_of_the_recording_is_not_adopted_into_the_motor_file() {
    let set = "magnetizing-saturation";
    let sources = sources(set, true);
    let (report, file) = adopt(set, &sources, &motor(set), &mut |_, _| {}).unwrap();
    assert!(report.proven);
    assert_eq!(report.parameters[0].name, "saturation");
    let names: Vec<&str> = file.effects.iter().map(|e| e.name.as_str()).collect();
    assert_eq!(names, [set]);
    // The new file, nothing refitted but the scale, on the recording that was not fitted.
    let check = compare(&sources[1..], &file, &mut |_, _| {}).unwrap();
    assert!(check.overall.unwrap().error_over_noise < 1.06);
}

#[test]
fn with_a_known_scale_nothing_is_said_about_it() {
    let set = "none";
    let path = folder(set).join("recording_b.csv.gz");
    let known = read_recording(&path, &Mapping::default(), &mut |_| {}).unwrap();
    let known = [Source::Recording(known)];
    let report = compare(&known, &motor(set), &mut |_, _| {}).unwrap();
    let json = serde_json::to_string(&report).unwrap();
    assert!(!json.contains("speed_scale") && !json.contains("cannot_be_concluded"));
}

#[test]
fn known_and_unknown_scales_are_not_one_question() {
    let set = "none";
    let path = folder(set).join("recording.csv.gz");
    let known = read_recording(&path, &Mapping::default(), &mut |_| {}).unwrap();
    let mut both = sources(set, true);
    both[1] = Source::Recording(known);
    let refused = explain(&both, &motor(set), &mut |_, _| {}).unwrap_err();
    assert!(refused.to_string().contains("known in others"), "{refused}");
}
