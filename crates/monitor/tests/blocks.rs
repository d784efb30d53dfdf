//! Instants one by one, in blocks of any length, and in SI units: the same measurement.

use std::f32::consts::TAU;

use monitor::{
    Abc, CHANNELS, ChannelScale, ComparatorConfig, Converter, FieldCurrent, Frame, LoadKind,
    MAX_EFFECTS, Monitor, MonitorConfig, MonitorState, NotJudged, ParameterDoubt, RawBlock,
    RawSample, Report,
};
use motor::{Mechanics, TParams};
use proptest::prelude::*;

/// 1.4 s at 10 kHz.
const INSTANTS: usize = 14_000;
/// Where the supply is away, long enough for the peaks to be forgotten (5 per second, to a twentieth).
const DARK: std::ops::Range<usize> = 3_000..10_000;

fn config() -> MonitorConfig {
    let channel = |unit_per_code, skewed: f32| ChannelScale {
        unit_per_code,
        zero_code: 2048.0,
        gain: Abc {
            a: 1.0,
            b: 1.02,
            c: 0.97,
        },
        offset: Abc {
            a: 0.0,
            b: skewed,
            c: -skewed,
        },
    };
    MonitorConfig {
        t_sample: 1e-4,
        converter: Converter {
            voltage: channel(0.15, 2.0),
            current: channel(0.01, 0.05),
            max_code: 4095,
            chain: monitor::AnalogueChain::NONE,
            ratiometric: [false; 2],
        },
        encoder_counts_per_revolution: 4096.0,
        params: TParams {
            r_s: 8.0,
            r_r: 7.0,
            l_ls: 0.028,
            l_lr: 0.028,
            l_m: 0.42,
        },
        effects: [None; MAX_EFFECTS],
        laws: Default::default(),
        channel_gain: [1.0; CHANNELS],
        mechanics: Mechanics {
            n_p: 2.0,
            inertia: 0.002,
            friction: 0.0008,
            load_friction: 0.0035,
        },
        rated_voltage: 179.6,
        rated_current: 1.9,
        rated_omega: 377.0,
        rated_torque: 1.7,
        frame: Frame::RotorFlux,
        field: FieldCurrent::Live,
        load: LoadKind::Friction,
        thresholds: [0.006, 0.03, 0.04, 0.003],
        window_cycles: 5,
        comparator: ComparatorConfig {
            persistence: 3,
            hysteresis: 0.8,
        },
        healthy: None,
        cage: monitor::Cage::UNKNOWN,
        doubt: ParameterDoubt::default(),
    }
}

/// A supply of 61.3 Hz that is away for a while; currents touch a rail for a moment.
fn instant(k: usize) -> RawSample {
    let dark = DARK.contains(&k);
    let code = |phase: usize, amplitude: f32| {
        let x = TAU * (61.3e-4 * k as f32 - phase as f32 / 3.0);
        let noise = (k * 7_919 % 5) as f32 - 2.0;
        (2048.0 + if dark { 0.0 } else { amplitude * x.sin() } + noise).clamp(0.0, 4095.0) as u16
    };
    let ampere = if (12_900..13_000).contains(&k) {
        2_100.0
    } else {
        190.0
    };
    RawSample {
        voltage_codes: [0, 1, 2].map(|phase| code(phase, 1_197.0)),
        current_codes: [0, 1, 2].map(|phase| code(phase, ampere)),
        encoder_count: (k * 117 / 10) as u16,
        ..RawSample::default()
    }
}

fn interleaved(raw: &RawSample) -> [u16; CHANNELS] {
    core::array::from_fn(|n| {
        let quantity = [&raw.voltage_codes, &raw.current_codes][n % 2];
        quantity[n / 2]
    })
}

fn in_blocks(lengths: &[usize]) -> Vec<Report> {
    let monitor = Monitor::new(config()).expect("a valid configuration");
    let mut state = MonitorState::default();
    let instants: Vec<RawSample> = (0..INSTANTS).map(instant).collect();
    let codes: Vec<_> = instants.iter().map(interleaved).collect();
    let counts: Vec<_> = instants.iter().map(|raw| raw.encoder_count).collect();
    let (mut reports, mut first) = (Vec::new(), 0);
    for &length in lengths.iter().cycle() {
        let last = INSTANTS.min(first + length);
        let mut block = RawBlock::new(&codes[first..last], &counts[first..last]);
        while !block.is_empty() {
            reports.extend(monitor.update_block(&mut state, &mut block));
        }
        first = last;
        if first == INSTANTS {
            break;
        }
    }
    reports
}

fn one_by_one(convert: bool) -> Vec<Report> {
    let monitor = Monitor::new(config()).expect("a valid configuration");
    let mut state = MonitorState::default();
    let take = |k| {
        let raw = instant(k);
        if convert {
            monitor.update(&mut state, &config().converter.convert(&raw))
        } else {
            monitor.update_raw(&mut state, &raw)
        }
    };
    (0..INSTANTS).filter_map(take).collect()
}

/// Debug output shows every digit that tells two numbers apart, and NaN too.
fn text(reports: &[Report]) -> String {
    format!("{reports:#?}")
}

#[test]
fn the_sequence_holds_what_it_should() {
    let reports = one_by_one(false);
    let has = |wanted: &dyn Fn(&Report) -> bool| reports.iter().filter(|r| wanted(r)).count();
    assert!(has(&|r| r.residuals.is_some()) > 20);
    assert!(has(&|r| matches!(r.not_judged, Some(NotJudged::Supply(_)))) > 0);
    assert!(has(&|r| r.not_judged == Some(NotJudged::Clipped)) > 0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    #[test]
    fn blocks_of_any_length_give_the_same_bits(lengths in prop::collection::vec(1_usize..100, 1..6)) {
        prop_assert_eq!(text(&in_blocks(&lengths)), text(&one_by_one(false)));
    }
}

/// Codes are summed up and converted once per cycle; SI values are converted instant by instant.
#[test]
fn codes_and_si_units_agree() {
    let (codes, si) = (one_by_one(false), one_by_one(true));
    assert_eq!(codes.len(), si.len());
    let mut compared = 0;
    for (codes, si) in codes.iter().zip(&si) {
        // The references differ by calibration, so the oscillators differ in phase and a turn ends a sample earlier.
        assert!(codes.sample_index.abs_diff(si.sample_index) <= 1);
        let (Some(codes), Some(si)) = (codes.window, si.window) else {
            continue;
        };
        let rated = |k: usize| if k < 3 { 179.6 } else { 1.9 };
        for (k, (a, b)) in codes.channels.iter().zip(&si.channels).enumerate() {
            let (a, b) = ([a.phasor.norm(), a.offset], [b.phasor.norm(), b.offset]);
            for (a, b) in a.into_iter().zip(b) {
                assert!((a - b).abs() < 2e-3 * rated(k), "channel {k}: {a} and {b}");
            }
        }
        compared += 1;
    }
    assert!(compared > 20, "{compared}");
}
