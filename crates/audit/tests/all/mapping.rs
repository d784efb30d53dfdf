//! Columns that are not what they are taken for: wiring, units, pole pairs. Each is named, not guessed.

use crate::synthetic::{Noise, Signals, assert_codes, assert_one, audited, each, expectation};
use audit::{Code, audit};
use std::f64::consts::TAU;

#[test]
fn two_currents_exchanged() {
    for (a, b, pair) in [
        (0, 1, "ia and ib"),
        (1, 2, "ib and ic"),
        (0, 2, "ia and ic"),
    ] {
        let audit = audited(|s| s.i.swap(a, b));
        assert_one(&audit, Code::SwappedPhases, "ia ib ic", 1.0, 1.0, pair);
        assert!(!audit.supported);
    }
}

#[test]
fn currents_of_the_neighbouring_phases() {
    for turns in [1, 2] {
        let audit = audited(|s| s.i.rotate_left(turns));
        assert_codes(&audit, &[Code::SwappedPhases]);
        let remedy = ["--column ia=ic", "--column ia=ib"][turns - 1];
        assert!(
            audit.findings[0].detail.contains(remedy),
            "{:?}",
            audit.findings
        );
    }
}

#[test]
fn inverted_channels() {
    let one = audited(|s| s.i[1].iter_mut().for_each(|x| *x = -*x));
    assert_one(&one, Code::Polarity, "ib", 180.0, 0.0, "--scale ib=-1");
    let voltage = audited(|s| s.v[2].iter_mut().for_each(|x| *x = -*x));
    assert_one(&voltage, Code::Polarity, "vc", 180.0, 0.0, "--scale vc=-1");
    let all = audited(|s| each(&mut s.i, |x| -x));
    assert_codes(&all, &[Code::Polarity]);
    assert!(all.findings[0].detail.contains("--scale ia=-1"));
    let speed = audited(|s| s.speed.iter_mut().for_each(|x| *x = -*x));
    assert_codes(&speed, &[Code::Polarity]);
    assert_eq!(speed.findings[0].channel, "speed");
}

#[test]
fn the_order_of_the_phases() {
    let exchanged = audited(|s| {
        s.v.swap(1, 2);
        s.i.swap(1, 2);
    });
    assert_codes(&exchanged, &[Code::PhaseOrder]);
    assert!(!exchanged.supported);
    let backwards = audited(|s| {
        s.v.swap(1, 2);
        s.i.swap(1, 2);
        s.speed.iter_mut().for_each(|x| *x = -*x);
    });
    assert_codes(&backwards, &[]);
}

#[test]
fn line_voltages_for_phase_voltages() {
    let audit = audited(|s| {
        let [a, b, c] = s.v.clone();
        let less = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x - y).collect();
        s.v = [less(&a, &b), less(&b, &c), less(&c, &a)];
    });
    assert_one(
        &audit,
        Code::LineVoltages,
        "va vb vc",
        3f64.sqrt(),
        0.01,
        "--line-voltages",
    );
}

#[test]
fn effective_values() {
    let audit = audited(|s| {
        let mut noise = Noise::new(5);
        s.v.iter_mut()
            .flatten()
            .for_each(|x| *x = 230.0 + noise.draw());
        s.i.iter_mut()
            .flatten()
            .for_each(|x| *x = 4.8 + 0.05 * noise.draw());
    });
    assert_codes(&audit, &[Code::RmsValues; 2]);
    assert!(!audit.supported);
}

#[test]
fn units() {
    let rpm = audited(|s| s.speed.iter_mut().for_each(|x| *x *= 60.0 / TAU));
    assert_one(
        &rpm,
        Code::Unit,
        "speed",
        60.0 / TAU,
        1e-9,
        "--unit speed=rpm",
    );
    let turns = audited(|s| s.speed.iter_mut().for_each(|x| *x /= TAU));
    assert_one(
        &turns,
        Code::Unit,
        "speed",
        1.0 / TAU,
        1e-9,
        "--unit speed=rev/s",
    );
    let millivolt = audited(|s| {
        s.metadata.sensors = recording::Sensors::default();
        each(&mut s.v, |x| 1000.0 * x);
    });
    assert_one(
        &millivolt,
        Code::Unit,
        "va vb vc",
        1000.0,
        10.0,
        "--unit va=mV",
    );
    let kiloamp = audited(|s| each(&mut s.i, |x| 1e-3 * x));
    assert_codes(&kiloamp, &[Code::Unit]);
    assert!(kiloamp.findings[0].detail.contains("--unit ia=kA"));
    let milliseconds = audited(|s| s.t.iter_mut().for_each(|t| *t *= 1000.0));
    assert_codes(&milliseconds, &[Code::Unit]);
    assert!(
        milliseconds.findings[0].detail.contains("--unit t=ms"),
        "{milliseconds:?}"
    );
    for audit in [rpm, turns, millivolt, kiloamp, milliseconds] {
        assert!(!audit.supported);
    }
}

#[test]
fn implausible_speeds() {
    // Believed to have three pole pairs: 1500 rpm is then 1.5 times synchronous speed.
    let believed = audit::Expectation {
        pole_pairs: Some(3),
        ..expectation()
    };
    let wrong = audit(&Signals::healthy(2).recording(), &believed);
    assert_codes(&wrong, &[Code::SpeedImplausible]);
    assert!(
        wrong.findings[0]
            .detail
            .contains("2 pole pairs instead of 3"),
        "{wrong:?}"
    );
    assert!(wrong.findings[0].detail.contains("speed=unknown"));
    assert_eq!(wrong.unusable, ["speed"]);
    let volts = audited(|s| s.speed.iter_mut().for_each(|x| *x *= 0.0156));
    assert_codes(&volts, &[Code::SpeedImplausible]);
    let fast = audited(|s| s.speed.iter_mut().for_each(|x| *x *= 1.06));
    assert_codes(&fast, &[Code::SpeedImplausible]);
    assert!(fast.unusable.is_empty() && fast.supported);
}

/// Half a hundredth of the speed, backwards and with an offset: nothing about it is judged, and it is said.
#[test]
fn a_speed_of_unknown_scale_is_left_alone() {
    let mut signals = Signals::healthy(2);
    signals.speed.iter_mut().for_each(|x| *x = 0.3 - 0.005 * *x);
    let mut recording = signals.recording();
    let undeclared = audit(&recording, &expectation());
    assert!(!undeclared.findings.is_empty());
    assert!(
        undeclared.findings[0]
            .detail
            .contains("--scale speed=unknown"),
        "{undeclared:?}"
    );
    recording.unknown_speed_scale = Some(Box::new(recording::UnknownScale {
        unit: recording::UNITS[10],
        offset: None,
    }));
    let declared = audit(&recording, &expectation());
    assert_codes(&declared, &[Code::ScaleUnknown]);
    assert_eq!(declared.unusable, ["speed"]);
    assert!(declared.supported);
}

/// A clamp's volts are proposed with the evidence where the nameplate allows one, and nothing is changed.
#[test]
fn the_output_of_a_sensor_is_proposed() {
    let clamp = audited(|s| each(&mut s.i, |x| 0.1 * x));
    assert_codes(&clamp, &[Code::SensorScale]);
    let finding = &clamp.findings[0];
    for words in [
        "a clamp of 100mV/A",
        "Nothing was changed",
        "--sensor i=100mV/A",
    ] {
        assert!(finding.detail.contains(words), "{}", finding.detail);
    }
    assert!(clamp.supported);
    let probe = audited(|s| each(&mut s.v, |x| x / 100.0));
    let said: Vec<&str> = probe
        .findings
        .iter()
        .map(|finding| finding.detail.as_str())
        .collect();
    assert!(
        said.iter()
            .any(|detail| detail.contains("a probe of 100:1")),
        "{said:?}"
    );
}

#[test]
fn a_sensor_that_the_nameplate_contradicts_is_not_proposed() {
    // A fifth of the rated current is a motor without load; three times more than any clamp gives is no clamp.
    for factor in [0.5, 3.0] {
        let audit = audited(|s| each(&mut s.i, |x| factor * x));
        let codes: Vec<Code> = audit.findings.iter().map(|finding| finding.code).collect();
        assert!(!codes.contains(&Code::SensorScale), "{codes:?}");
    }
    let far = audited(|s| each(&mut s.i, |x| 1e-6 * x));
    let unit = far
        .findings
        .iter()
        .find(|finding| finding.code == Code::Unit)
        .unwrap();
    assert!(
        !unit.detail.contains("kA") && !unit.detail.contains("clamp"),
        "{}",
        unit.detail
    );
}

/// 0.0076 of the rated current would be 7.6 times it in kA, 0.76 times behind a clamp of 10 mV/A; a thousandth fits both.
#[test]
fn the_likelier_load_is_proposed_first() {
    let clamp = ["10mV/A (then 0.76 times)", "kA (then 7.6 times)"];
    let kiloampere = ["kA (then 1 times)", "1mV/A (then 1.00 times)"];
    for (factor, [first, second]) in [(0.0076, clamp), (0.001, kiloampere)] {
        let amp = factor * 5.0 * f64::sqrt(2.0);
        let audit = audited(|s| {
            for (k, x) in s.i.iter_mut().enumerate() {
                let angle = |t: f64| TAU * (50.0 * t - k as f64 / 3.0) - 0.7;
                *x = s.t.iter().map(|t| amp * angle(*t).cos()).collect();
            }
        });
        let unit = audit.findings.iter().find(|f| f.code == Code::Unit);
        let detail = &unit.expect("a unit").detail;
        let at = |words: &str| detail.find(words).unwrap_or_else(|| panic!("{detail}"));
        assert!(at(first) < at(second), "{detail}");
    }
}
