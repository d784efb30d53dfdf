//! The same motor in ADC codes, as the board sees it.

use super::drive::{Drive, OMEGA_SYNC, T_SAMPLE, config};
use num_complex::Complex64;

use crate::{Abc, CHANNELS, Monitor, MonitorState, RawBlock, RawSample, Report};

const SAMPLES: usize = 6_000;

fn code(value: f32, full_scale: f32) -> u16 {
    (2048.0 + value * 2048.0 / full_scale).round() as u16
}

fn raw(k: usize) -> RawSample {
    late(k, [0.0; CHANNELS])
}

/// The codes of instant `k` of channels that are late, s.
fn late(k: usize, delays: [f64; CHANNELS]) -> RawSample {
    let mut drive = Drive::healthy();
    let t = k as f64 * T_SAMPLE;
    let phasors = drive.u.iter_mut().chain(&mut drive.i);
    for (phasor, late) in phasors.zip(delays) {
        *phasor *= Complex64::from_polar(1.0, -OMEGA_SYNC * late);
    }
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
        ..RawSample::default()
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

/// us late: the documented front end, and one channel of other parts.
const LATE_US: [f64; CHANNELS] = [91.9, 90.7, 119.5, 88.1, 87.0, 85.7];

fn judged_behind_the_front_end(known: bool) -> Report {
    let late_s = LATE_US.map(|us| us * 1e-6);
    let mut config = config();
    if known {
        config.converter.chain.delay = late_s.map(|late| late as f32);
    }
    let monitor = Monitor::new(config).expect("valid");
    let mut state = MonitorState::default();
    let reports = (0..SAMPLES).filter_map(|k| monitor.update_raw(&mut state, &late(k, late_s)));
    reports
        .filter(|report| report.is_judged())
        .last()
        .expect("judged")
}

/// 30 us of one channel are 0.5 degrees of 50 Hz: enough for FAULT when nobody told the monitor.
#[test]
fn delays_that_are_known_are_undone() {
    let healthy = one_by_one().last().copied().expect("reports");
    let (ignorant, told) = (
        judged_behind_the_front_end(false),
        judged_behind_the_front_end(true),
    );
    assert!(!ignorant.lamps.is_quiet(), "{:?}", ignorant.normalised);
    assert!(told.lamps.is_quiet(), "{:?}", told.normalised);
    let [of_told, of_healthy] = [told, healthy].map(|r| r.normalised.expect("judged"));
    for (told, healthy) in of_told.iter().zip(of_healthy) {
        // Without noise the codes' rounding is the same in every cycle, and another one at other angles.
        assert!((told - healthy).abs() < 0.25, "{of_told:?} {of_healthy:?}");
    }
}

/// Samples in SI units come from another recorder, whose delays its own sidecar tells.
#[test]
fn delays_of_the_board_leave_samples_in_si_units_alone() {
    let reports = |late: f32| {
        let mut config = config();
        config.converter.chain.delay = [late; CHANNELS];
        let mut bench = super::drive::Bench::new(config);
        bench.run(0.3, |t| Drive::healthy().sample(t))
    };
    assert_eq!(
        format!("{:?}", reports(1e-4)),
        format!("{:?}", reports(0.0))
    );
}

#[test]
fn a_chain_outside_its_range_is_refused() {
    let refused = |change: fn(&mut crate::MonitorConfig)| {
        let mut config = config();
        change(&mut config);
        Monitor::new(config)
            .map(|_| ())
            .expect_err("refused")
            .parameter
    };
    let delay = |c: &mut crate::MonitorConfig| c.converter.chain.delay[3] = 3e-4;
    assert_eq!(refused(delay), "converter.chain.delay");
    let none = |c: &mut crate::MonitorConfig| c.converter.chain.delay[3] = f32::NAN;
    assert_eq!(refused(none), "converter.chain.delay");
    let roll_off = |c: &mut crate::MonitorConfig| c.converter.chain.roll_off = -1e-5;
    assert_eq!(refused(roll_off), "converter.chain.roll_off");
}

fn window_on(share: f32, ratiometric: [bool; 2]) -> [f32; 2] {
    let mut config = config();
    config.converter.ratiometric = ratiometric;
    let monitor = Monitor::new(config).expect("valid");
    let mut state = MonitorState::default();
    state.note_converter_supply(share);
    let reports = (0..SAMPLES).filter_map(|k| monitor.update_raw(&mut state, &raw(k)));
    let window = reports.filter_map(|report| report.window).last();
    let channels = window.expect("a window").channels;
    [channels[0].phasor.norm(), channels[3].phasor.norm()]
}

/// A converter on 2 % more than its nominal supply shows 2 % too little of absolute sensors.
#[test]
fn the_converters_supply_scales_absolute_channels_and_no_others() {
    let [u, i] = window_on(1.0, [false; 2]);
    for ratiometric in [[false, false], [true, false], [false, true], [true, true]] {
        let shown = window_on(1.02, ratiometric);
        for ((shown, nominal), follows) in shown.iter().zip([u, i]).zip(ratiometric) {
            let expected = if follows { 1.0 } else { 1.02 };
            assert!(
                (shown / nominal - expected).abs() < 1e-6,
                "{ratiometric:?}: {shown}"
            );
        }
    }
}

#[test]
fn a_supply_that_cannot_be_corrects_nothing() {
    let nominal = window_on(1.0, [false; 2]);
    for share in [0.0, 0.89, 1.11, f32::NAN, f32::INFINITY] {
        assert_eq!(window_on(share, [false; 2]), nominal, "{share}");
    }
}

/// The same codes, each the sum of sixteen: the same reports but for the rounding of single precision.
#[test]
fn sums_of_codes_are_judged_like_codes() {
    let mut config = config();
    config.converter = config.converter.summed(16);
    let monitor = Monitor::new(config).expect("valid");
    let mut state = MonitorState::default();
    let summed = (0..SAMPLES).filter_map(|k| {
        let mut raw = raw(k);
        let codes = raw.voltage_codes.iter_mut().chain(&mut raw.current_codes);
        codes.for_each(|code| *code *= 16);
        monitor.update_raw(&mut state, &raw)
    });
    for (summed, single) in summed.zip(one_by_one()) {
        assert_eq!(summed.lamps, single.lamps);
        let [summed, single] = [summed, single].map(|report| report.normalised.unwrap_or_default());
        for (a, b) in summed.iter().zip(single) {
            assert!((a - b).abs() < 1e-3, "{a} {b}");
        }
    }
}

/// A single conversion at a rail, which its sum hides, spoils the windows that hold its instant, in blocks as one by one.
#[test]
fn a_marked_conversion_spoils_its_window_and_no_other() {
    let monitor = Monitor::new(config()).expect("valid");
    let all: Vec<_> = (0..SAMPLES)
        .map(|k| {
            let mut raw = raw(k);
            if k == 3_000 {
                raw.clipped.mark_current(1);
            }
            raw
        })
        .collect();
    let mut state = MonitorState::default();
    let single: Vec<_> = all
        .iter()
        .filter_map(|raw| monitor.update_raw(&mut state, raw))
        .collect();
    let clipped = |report: &&Report| report.not_judged == Some(crate::NotJudged::Clipped);
    assert_eq!(
        single.iter().filter(clipped).count(),
        config().window_cycles
    );
    let codes: Vec<[u16; CHANNELS]> = all.iter().map(RawSample::interleaved).collect();
    let counts: Vec<u16> = all.iter().map(|raw| raw.encoder_count).collect();
    let marks: Vec<_> = all.iter().map(|raw| raw.clipped).collect();
    let mut state = MonitorState::default();
    let mut reports = Vec::new();
    let blocks = codes
        .chunks(32)
        .zip(counts.chunks(32))
        .zip(marks.chunks(32));
    for ((codes, counts), marks) in blocks {
        let is_marked = marks.iter().any(|marks| marks.any());
        let mut block =
            RawBlock::new(codes, counts).with_clipped(if is_marked { marks } else { &[] });
        while !block.is_empty() {
            reports.extend(monitor.update_block(&mut state, &mut block));
        }
    }
    assert_eq!(format!("{reports:?}"), format!("{single:?}"));
}
