//! Samples that are no numbers, for as long as they come, are not judged: they are no dead sensor and no fault.

mod motor_2200_watt;

use std::f32::consts::TAU;

use monitor::{self, Abc, Lamp, Monitor, MonitorState, NotJudged, Report, Sample, SpeedSample};
use motor_2200_watt::{AMPLITUDE, OMEGA_SYNC, config};

const T_SAMPLE: f32 = 1e-4;
const OMEGA: f32 = OMEGA_SYNC as f32;

fn sine(amplitude: f32, angle: f32) -> Abc {
    let phase = |turn: f32| amplitude * (angle - turn * TAU / 3.0).sin();
    Abc {
        a: phase(0.0),
        b: phase(1.0),
        c: phase(2.0),
    }
}

fn sound(k: usize) -> Sample {
    let angle = (OMEGA * T_SAMPLE * k as f32) % TAU;
    Sample {
        u_s_abc: Some(sine(AMPLITUDE as f32, angle)),
        i_s_abc: Some(sine(5.0, angle - 0.7)),
        speed: SpeedSample::RadPerSecond(152.0),
        tau_load: None,
        clipped: Default::default(),
    }
}

/// A second of sound samples, a second of damaged ones; the reports of the latter.
fn reports(damage: impl Fn(&mut Sample)) -> Vec<Report> {
    let monitor = Monitor::new(config()).expect("a valid configuration");
    let mut state = MonitorState::default();
    let mut reports = Vec::new();
    for k in 0..20_000 {
        let mut sample = sound(k);
        if k >= 10_000 {
            damage(&mut sample);
        }
        let report = monitor.update(&mut state, &sample);
        reports.extend(report.filter(|_| k >= 10_200));
    }
    assert!(reports.len() > 5, "{} reports", reports.len());
    reports
}

fn assert_not_judged(reports: &[Report], what: &str) {
    for report in reports {
        assert!(report.not_judged.is_some(), "{what}: {report:?}");
        let new = report.sensor.is_some() || report.lamps.sensor == Lamp::On;
        assert!(!new, "{what}: {report:?}");
    }
    let invalid = reports
        .iter()
        .filter(|r| r.not_judged == Some(NotJudged::Invalid));
    assert!(invalid.count() > 0, "{what}: never called what it is");
}

#[test]
fn a_channel_that_stays_no_number_is_not_judged() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let voltage = reports(|sample| {
            if let Some(u) = &mut sample.u_s_abc {
                u.b = bad;
            }
        });
        assert_not_judged(&voltage, "voltage b");
        let current = reports(|sample| {
            if let Some(i) = &mut sample.i_s_abc {
                i.c = bad;
            }
        });
        assert_not_judged(&current, "current c");
    }
}

/// A stopped encoder is a finding, but not while another channel shows no numbers.
#[test]
fn speed_is_not_doubted_in_a_window_without_numbers() {
    let stopped = |sample: &mut Sample| sample.speed = SpeedSample::RadPerSecond(0.0);
    let doubted = reports(stopped);
    assert!(doubted.iter().any(|r| r.lamps.sensor == Lamp::On));
    let silent = reports(|sample| {
        stopped(sample);
        sample.tau_load = Some(f32::MAX);
    });
    assert_not_judged(&silent, "torque");
}

#[test]
fn a_speed_beyond_every_shaft_is_no_speed() {
    for beyond in [7e28, 1e6, -1e6, f32::INFINITY, f32::NAN] {
        let reports = reports(|sample| sample.speed = SpeedSample::RadPerSecond(beyond));
        for report in &reports {
            assert_eq!(report.not_judged, Some(NotJudged::NoSpeed), "{beyond}");
            assert_eq!(report.residuals, None, "{beyond}");
        }
    }
}
