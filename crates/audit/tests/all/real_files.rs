//! The audit over recordings by other people's simulators and over real motors: what is true is found,
//! and nothing else.

use crate::common::{committed, peer, quiet, shared};
use audit::{Audit, Code, Expectation, Finding, audit};
use formats::read_recording;
use recording::Mapping;
use std::path::Path;

/// 2.2 kW, 400 V, 50 Hz, 4 poles: `motor.toml` of the sets.
const MOTOR_A: Expectation = Expectation {
    pole_pairs: Some(2),
    frequency_hz: Some(50.0),
    voltage_line_rms_volt: Some(400.0),
    current_rms_amp: Some(5.0),
    torque_nm: Some(14.6),
    circuit: None,
};
/// 1.5 kW at its 25 Hz point, 4 poles: `motor.toml` of the inverter set.
const MOTOR_C: Expectation = Expectation {
    pole_pairs: Some(2),
    frequency_hz: Some(25.0),
    voltage_line_rms_volt: Some(422.536_980_630_098_2),
    current_rms_amp: Some(5.5),
    torque_nm: Some(20.0),
    circuit: None,
};

fn audited(path: &Path, expectation: &Expectation, flags: &Mapping) -> Audit {
    let recording = read_recording(path, flags, &mut quiet()).expect("a recording");
    audit(&recording, expectation)
}

fn codes(audit: &Audit) -> Vec<(Code, &str)> {
    audit
        .findings
        .iter()
        .map(|finding| (finding.code, finding.channel.as_str()))
        .collect()
}

/// Starts, load steps, supply steps and frequency ramps give no finding.
#[test]
fn healthy_and_motor_side_sets_have_no_finding() {
    let sets = [
        ("none", MOTOR_A),
        ("magnetizing-saturation", MOTOR_A),
        ("stator-resistance-plus-25-percent", MOTOR_A),
        ("inertia-plus-40-percent", MOTOR_A),
        ("windage", MOTOR_A),
        ("shaft-compliance", MOTOR_A),
        ("inverter-dead-time", MOTOR_C),
    ];
    for (set, expectation) in sets {
        for file in ["recording", "recording_b"] {
            let path = peer(set, file);
            let audit = audited(&path, &expectation, &Mapping::default());
            assert_eq!(codes(&audit), [], "{set} {file}: {:#?}", audit.findings);
            assert!(audit.supported && audit.unusable.is_empty());
        }
    }
}

/// Truth: 2 % negative sequence.
#[test]
fn the_unbalanced_supply_is_measured() {
    for file in ["recording", "recording_b"] {
        let path = peer("supply-unbalance", file);
        let audit = audited(&path, &MOTOR_A, &Mapping::default());
        assert_eq!(codes(&audit), [(Code::SupplyUnbalance, "va vb vc")]);
        // The set asks for 0.1; noise of 0.2 % of full scale leaves less than 0.01.
        assert!(
            (audit.findings[0].value - 2.0).abs() < 0.02,
            "{:?}",
            audit.findings
        );
    }
}

/// Truth: gain 1.02 in phase c; V0/V1 is then 0.02/3 over 1 + 0.02/3.
#[test]
fn the_gain_of_phase_c_is_a_sensor_not_an_unbalance() {
    for file in ["recording", "recording_b"] {
        let path = peer("voltage-gain-phase-c", file);
        let audit = audited(&path, &MOTOR_A, &Mapping::default());
        assert_eq!(codes(&audit), [(Code::ZeroSequence, "va vb vc")]);
        assert!(
            (audit.findings[0].value - 0.662).abs() < 0.01,
            "{:?}",
            audit.findings
        );
        assert!(audit.findings[0].detail.contains("+2.0 % in vc"));
    }
}

/// The zero sequence of 9 % that three wires cannot carry, and what is not there.
#[test]
fn the_shorted_turns_recordings_are_currents_of_uncalibrated_sensors() {
    let folder = committed("itsc_075hp");
    let files = std::fs::read_dir(folder)
        .expect("test data")
        .map(|entry| entry.unwrap().path());
    let mut count = 0;
    for path in files.filter(|path| path.extension().is_some_and(|extension| extension == "gz")) {
        let audit = audited(&path, &Expectation::default(), &Mapping::default());
        let expected = [
            (Code::ZeroSequence, "ia ib ic"),
            (Code::ChannelMissing, "va vb vc"),
            (Code::ChannelMissing, "speed"),
        ];
        assert_eq!(codes(&audit), expected, "{}", path.display());
        assert!(audit.supported);
        count += 1;
    }
    assert_eq!(count, 45);
}

#[test]
fn the_healthy_one_has_nine_percent_zero_sequence() {
    let value = |k: u32| {
        let path = committed(&format!("itsc_075hp/sc_hlt_00{k}.csv.gz"));
        audited(&path, &Expectation::default(), &Mapping::default()).findings[0].value
    };
    let mean = (1..=5).map(value).sum::<f64>() / 5.0;
    // Published as 9 %, to its one digit.
    assert!((mean - 9.0).abs() < 0.5, "{mean}");
}

fn laboratory(name: &str) -> Option<std::path::PathBuf> {
    shared(&format!("measured/chalmers_lab_4kw/{name}.csv.gz"))
}

/// About 4 kW, 400 V, 50 Hz, 4 poles; the plate's current is not given.
const LABORATORY: Expectation = Expectation {
    pole_pairs: Some(2),
    frequency_hz: Some(50.0),
    voltage_line_rms_volt: Some(400.0),
    current_rms_amp: Some(8.4),
    torque_nm: None,
    circuit: None,
};

#[test]
fn the_inrush_clips_three_probes_but_not_the_fourth() {
    let Some(path) = laboratory("direct_start") else {
        return;
    };
    let audit = audited(&path, &LABORATORY, &Mapping::default());
    let clipped: Vec<&Finding> = audit
        .findings
        .iter()
        .filter(|finding| finding.code == Code::Clipping)
        .collect();
    let channels: Vec<&str> = clipped
        .iter()
        .map(|finding| finding.channel.as_str())
        .collect();
    assert_eq!(channels, ["ia", "ib", "ic"]);
    // Published: clipping at about 61 A, ic2 peaks at 89.7 A.
    assert!(
        clipped
            .iter()
            .all(|finding| (finding.value - 61.0).abs() < 3.0),
        "{clipped:?}"
    );
    assert!(clipped[2].detail.contains("--column ic=ic2"));
    // The start is at 0.037 s; the current has fallen below 55 A at 0.11 s.
    let inside = |finding: &&Finding| finding.from_s > Some(0.037) && finding.to_s < Some(0.11);
    assert!(clipped.iter().all(inside), "{clipped:?}");
    assert!(audit.supported);
}

#[test]
fn the_second_probe_and_the_tachometer_are_accepted_when_mapped() {
    let Some(path) = laboratory("direct_start") else {
        return;
    };
    let mut flags = Mapping::default();
    flags.set_column("ic=ic2").unwrap();
    flags.set_column("speed=speed_raw").unwrap();
    flags.set_scale("speed=1.0144").unwrap();
    flags.set_offset("speed=-2.11").unwrap();
    let audit = audited(&path, &LABORATORY, &flags);
    let sure = [
        (Code::Clipping, "ia"),
        (Code::Clipping, "ib"),
        (Code::Offset, "va"),
        (Code::Offset, "vb"),
        (Code::Offset, "vc"),
    ];
    // Offsets of 0.1 A are three converter steps, and ic2 reads 2.4 % more than ic: true, but small.
    let allowed = [
        (Code::Offset, "ia"),
        (Code::Offset, "ib"),
        (Code::Offset, "ic"),
        (Code::ZeroSequence, "ia ib ic"),
    ];
    let found = codes(&audit);
    assert!(
        sure.iter().all(|finding| found.contains(finding)),
        "{found:?}"
    );
    let known = sure.iter().chain(&allowed);
    assert!(
        found
            .iter()
            .all(|finding| known.clone().any(|k| k == finding)),
        "{found:?}"
    );
    assert!(audit.unusable.is_empty() && audit.supported);
    // Published: voltage offsets of -1 to -5 V.
    let offsets = audit
        .findings
        .iter()
        .filter(|finding| finding.channel.starts_with('v'));
    assert!(
        offsets
            .map(|finding| finding.value)
            .all(|volt| (-6.0..-1.0).contains(&volt))
    );
}

/// A raw tachometer voltage is no speed: 2.456 at 1497 rpm.
#[test]
fn a_raw_tachometer_is_named() {
    let Some(path) = laboratory("no_load") else {
        return;
    };
    let mut flags = Mapping::default();
    flags.set_column("speed=speed_raw").unwrap();
    let audit = audited(&path, &LABORATORY, &flags);
    assert!(
        codes(&audit).contains(&(Code::SpeedImplausible, "speed")),
        "{:?}",
        audit.findings
    );
    assert_eq!(audit.unusable, ["speed"]);
    let told = audit
        .findings
        .iter()
        .find(|f| f.code == Code::SpeedImplausible);
    assert!(told.unwrap().detail.contains("--scale speed=unknown"));
    flags.set_scale("speed=unknown").unwrap();
    let declared = audited(&path, &LABORATORY, &flags);
    assert!(codes(&declared).contains(&(Code::ScaleUnknown, "speed")));
    assert!(!codes(&declared).contains(&(Code::SpeedImplausible, "speed")));
}

/// A blocked rotor has a slip of 1 and is no implausible speed.
#[test]
fn a_locked_rotor_is_no_finding() {
    let Some(path) = laboratory("locked_rotor") else {
        return;
    };
    let mut flags = Mapping::default();
    flags.set_column("speed=speed_raw").unwrap();
    let audit = audited(&path, &LABORATORY, &flags);
    assert!(
        audit
            .findings
            .iter()
            .all(|finding| finding.code == Code::Offset),
        "{:?}",
        audit.findings
    );
}

/// Faults put into a foreign recording, start and load steps included.
#[test]
fn spoilt_foreign_recordings_are_named() {
    let path = peer("none", "recording");
    let healthy = read_recording(&path, &Mapping::default(), &mut quiet()).unwrap();
    let spoilt = |channels: &[&str], f: fn(usize, f64) -> f64| {
        let mut recording = healthy.clone();
        for name in channels {
            let channel = recording::Channel::parse(name).unwrap();
            let values = recording.channel(channel).unwrap().iter().enumerate();
            let values = values.map(|(k, x)| f(k, *x)).collect();
            recording = recording.with_channel(channel, values).unwrap();
        }
        let audit = audit(&recording, &MOTOR_A);
        audit
            .findings
            .iter()
            .map(|finding| (finding.code, finding.channel.clone()))
            .collect::<Vec<_>>()
    };
    let one = |code, channel: &str| vec![(code, channel.to_owned())];
    // The inrush of 48 A cut at half of it: an amplifier in saturation, far below the declared 60 A.
    assert_eq!(
        spoilt(&["ib"], |_, x| x.clamp(-24.0, 24.0)),
        one(Code::Clipping, "ib")
    );
    assert_eq!(spoilt(&["ic"], |_, x| -x), one(Code::Polarity, "ic"));
    assert_eq!(
        spoilt(&["ia", "ib", "ic"], |_, x| -x),
        one(Code::Polarity, "ia ib ic")
    );
    assert_eq!(spoilt(&["va"], |_, x| x + 3.0), one(Code::Offset, "va"));
    assert_eq!(spoilt(&["ia"], |_, x| x + 0.05), one(Code::Offset, "ia"));
    assert_eq!(
        spoilt(&["ib"], |_, x| 1.03 * x),
        one(Code::ZeroSequence, "ia ib ic")
    );
    assert_eq!(
        spoilt(&["vb"], |k, x| if k > 45_000 { 0.0 } else { x }),
        one(Code::Stuck, "vb")
    );
    assert_eq!(
        spoilt(&["speed"], |_, x| 9.549_297 * x),
        one(Code::Unit, "speed")
    );
    assert_eq!(spoilt(&["speed"], |_, x| -x), one(Code::Polarity, "speed"));
    assert_eq!(
        spoilt(&["speed"], |_, x| 0.5 * x),
        one(Code::SpeedImplausible, "speed")
    );
    assert_eq!(
        spoilt(&["va", "vb", "vc"], |_, x| 1.732 * x),
        one(Code::LineVoltages, "va vb vc")
    );
    assert_eq!(
        spoilt(&["torque"], |_, x| 1000.0 * x),
        one(Code::Unit, "torque")
    );
    assert_eq!(
        spoilt(&["torque"], |_, x| -x),
        one(Code::Polarity, "torque")
    );
    // The load is on the other side of the transducer, which shows its zero and its noise.
    assert_eq!(
        spoilt(&["torque"], |k, _| 1e-3 * (k % 7) as f64 - 0.02),
        Vec::new()
    );
}
