//! The same motor in ADC codes, as the board sees it.

use super::drive::{Drive, T_SAMPLE, config};
use crate::{Abc, CHANNELS, Monitor, MonitorState, RawBlock, RawSample, Report};

const SAMPLES: usize = 6_000;

fn code(value: f32, full_scale: f32) -> u16 {
    (2048.0 + value * 2048.0 / full_scale).round() as u16
}

fn raw(k: usize) -> RawSample {
    let drive = Drive::healthy();
    let t = k as f64 * T_SAMPLE;
    let sample = drive.sample(t);
    let codes = |x: Option<Abc>, full_scale| {
        x.unwrap_or_default()
            .to_array()
            .map(|x| code(x, full_scale))
    };
    let turns = drive.omega_mech * t / core::f64::consts::TAU;
    RawSample {
        voltage_codes: codes(sample.u_s_abc, 600.0),
        current_codes: codes(sample.i_s_abc, 60.0),
        encoder_count: ((turns * 4096.0) as u64 % 65_536) as u16,
    }
}

fn one_by_one() -> Vec<Report> {
    let monitor = Monitor::new(config()).expect("valid");
    let mut state = MonitorState::default();
    (0..SAMPLES)
        .filter_map(|k| monitor.update_raw(&mut state, &raw(k)))
        .collect()
}

/// One code is 0.3 V and 0.03 A: rounding moves a fundamental over a thousand samples by far less than a threshold.
#[test]
fn a_healthy_motor_in_codes_is_judged_and_lights_nothing() {
    let reports = one_by_one();
    let judged: Vec<_> = reports.iter().filter(|r| r.is_judged()).collect();
    assert!(judged.len() > 15, "{}", judged.len());
    for report in judged {
        assert!(report.lamps.is_quiet(), "{report:?}");
        assert!((report.normalised.expect("judged")[0]).abs() < 0.5);
    }
}

#[test]
fn blocks_give_what_single_instants_give() {
    let monitor = Monitor::new(config()).expect("valid");
    let mut state = MonitorState::default();
    let all: Vec<_> = (0..SAMPLES).map(raw).collect();
    let codes: Vec<[u16; CHANNELS]> = all.iter().map(RawSample::interleaved).collect();
    let counts: Vec<u16> = all.iter().map(|raw| raw.encoder_count).collect();
    let mut reports = Vec::new();
    for (codes, counts) in codes.chunks(70).zip(counts.chunks(70)) {
        let mut block = RawBlock::new(codes, counts);
        while !block.is_empty() {
            reports.extend(monitor.update_block(&mut state, &mut block));
        }
    }
    // Debug output shows every digit.
    assert_eq!(format!("{reports:?}"), format!("{:?}", one_by_one()));
}

/// A cycle that began in volts is not continued in codes.
#[test]
fn a_change_of_units_starts_the_cycle_anew() {
    let monitor = Monitor::new(config()).expect("valid");
    let mut state = MonitorState::default();
    let mut taken = Vec::new();
    for k in 0..SAMPLES {
        // In SI units up to the middle of a cycle, then in codes.
        let report = if k < 4_090 {
            monitor.update(&mut state, &Drive::healthy().sample(k as f64 * T_SAMPLE))
        } else {
            monitor.update_raw(&mut state, &raw(k))
        };
        taken.extend(report.filter(|_| k >= 4_090));
    }
    let amplitude = super::drive::AMPLITUDE as f32;
    for window in taken.iter().filter_map(|report| report.window) {
        let seen = window.channels[0].phasor.norm();
        assert!((seen / amplitude - 1.0).abs() < 2e-3, "{seen}");
    }
}
