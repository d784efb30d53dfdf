//! Motion beside the windows, from codes of a converter to what the lamps show.

use monitor::{
    AnalogueChain, CHANNELS, Cause, ClippedChannels, Converter, InMotion, Lamp, Monitor,
    MonitorConfig, MonitorState, MovingCause, Phase, RawBlock, Reason, Report,
};
use motor::MotorFile;

use super::MotionSample;
use super::plant::{Plant, T_SAMPLE, press_torque};
use super::rows::INSTRUMENT;
use crate::{Companion, NoMotion};

/// Instants in a block of the board.
const BLOCK: usize = 32;
/// A fault comes at this sample.
const FAULT: usize = 12_000;

fn config() -> MonitorConfig {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../motors/peer-2k2-calibrated.toml"
    );
    let file = MotorFile::read(path).expect("a shipped motor file");
    MonitorConfig {
        // Sixteen bits: what the codes lose is less than the plant's own steps of twelve.
        converter: Converter::bipolar(600.0, 60.0, 16),
        encoder_counts_per_revolution: INSTRUMENT.counts as f32,
        ..MonitorConfig::from_motor_file(&file, T_SAMPLE).expect("effects of the library")
    }
}

fn press() -> Plant {
    Plant {
        load: press_torque,
        ..INSTRUMENT
    }
}

/// The press with whatever happens to its samples.
fn samples(mut change: impl FnMut(usize, &mut MotionSample)) -> Vec<MotionSample> {
    let run = press().run(2.4, 8).into_iter().enumerate();
    run.map(|(k, (mut sample, _))| {
        change(k, &mut sample);
        sample
    })
    .collect()
}

struct Codes {
    codes: Vec<[u16; CHANNELS]>,
    counts: Vec<u16>,
    clipped: Vec<ClippedChannels>,
}

fn coded(samples: &[MotionSample]) -> Codes {
    let code = |x: f32, full: f32| (32_768.0 * (1.0 + x / full)).round() as u16;
    let of = |sample: &MotionSample| {
        let (u, i) = (
            sample.sample.u_s_abc.expect("there"),
            sample.sample.i_s_abc.expect("there"),
        );
        let [v_a, v_b, v_c] = u.to_array().map(|u| code(u, 600.0));
        let [i_a, i_b, i_c] = i.to_array().map(|i| code(i, 60.0));
        [v_a, i_a, v_b, i_b, v_c, i_c]
    };
    let count = |sample: &MotionSample| match sample.sample.speed {
        monitor::SpeedSample::Count(count) => count,
        _ => unreachable!("the plant has an encoder"),
    };
    Codes {
        codes: samples.iter().map(of).collect(),
        counts: samples.iter().map(count).collect(),
        clipped: samples.iter().map(|sample| sample.sample.clipped).collect(),
    }
}

/// Reports in blocks of the board.
fn reports(config: MonitorConfig, samples: &[MotionSample]) -> Vec<Report> {
    let monitor = Monitor::new(config).expect("valid");
    let (mut state, mut companion) = (MonitorState::default(), Companion::new(&config));
    let coded = coded(samples);
    let blocks = coded.codes.chunks(BLOCK).zip(coded.counts.chunks(BLOCK));
    let mut reports = Vec::new();
    for ((codes, counts), clipped) in blocks.zip(coded.clipped.chunks(BLOCK)) {
        let mut block = RawBlock::new(codes, counts).with_clipped(clipped);
        while !block.is_empty() {
            reports.extend(monitor.update_block_beside(&mut state, &mut block, &mut companion));
        }
    }
    reports
}

fn lit(reports: &[Report]) -> Option<&Report> {
    reports
        .iter()
        .find(|report| report.shown_lamps().fault == Lamp::On)
}

#[test]
fn a_healthy_press_is_judged_in_motion_and_run_stays_on() {
    let reports = reports(config(), &samples(|_, _| {}));
    let moving: Vec<_> = reports
        .iter()
        .filter(|r| r.sample_index > 6_000 && !r.is_judged())
        .collect();
    assert!(
        moving.len() > 50,
        "a press is never steady: {}",
        moving.len()
    );
    assert!(
        moving
            .iter()
            .all(|report| report.shown_lamps().run == Lamp::On)
    );
    assert!(
        moving.iter().all(|report| report.lamps.run == Lamp::Blink),
        "at rest nothing is judged"
    );
    assert!(lit(&reports).is_none());
}

#[test]
fn a_gain_that_jumps_in_a_press_lights_fault_and_sensor_and_is_named() {
    let reports = reports(
        config(),
        &samples(|k, sample| {
            if k >= FAULT {
                sample.sample.i_s_abc.as_mut().expect("there").b *= 1.05;
            }
        }),
    );
    let first = lit(&reports).expect("found");
    // Found within 0.15 s, named 20 cycles later.
    let delay = first.sample_index as f64 * T_SAMPLE - FAULT as f64 * T_SAMPLE;
    assert!((0.4..0.6).contains(&delay), "{delay}");
    assert_eq!(first.shown_lamps().sensor, Lamp::On);
    let fault = first.moving.and_then(|moving| moving.fault).expect("named");
    assert_eq!(
        fault.cause,
        MovingCause::Departure(Cause::CurrentChannel(Phase::B))
    );
    assert!(fault.probability > 0.9, "{}", fault.probability);
    let mut told = Vec::new();
    monitor::likely(first, &[], &mut |suspicion| told.push(suspicion.suspect));
    assert_eq!(
        told,
        [monitor::Suspect::Cause(Cause::CurrentChannel(Phase::B))]
    );
}

/// Of a motor that was never seen in motion what departs may be what its file lacks: RUN blinks, no FAULT.
#[test]
fn a_motor_never_seen_in_motion_lights_no_fault_there() {
    let mut config = config();
    config.healthy.as_mut().expect("calibrated").in_motion = InMotion::Unseen;
    let faulty = samples(|k, sample| {
        if k >= FAULT {
            sample.sample.i_s_abc.as_mut().expect("there").b *= 1.05;
        }
    });
    let reports = reports(config, &faulty);
    assert!(lit(&reports).is_none());
    let doubts = reports
        .iter()
        .filter(|r| r.moving.is_some_and(|moving| moving.is_unexplained));
    assert!(doubts.clone().count() > 10);
    assert!(doubts.clone().all(|r| r.shown_lamps().run == Lamp::Blink));
    assert!(
        doubts
            .clone()
            .all(|r| r.reason() == Some(Reason::DoesNotFit))
    );
    config.healthy.as_mut().expect("calibrated").in_motion = InMotion::Differs;
    assert_eq!(
        Companion::new(&config).not_possible(),
        Some(NoMotion::Differs)
    );
}

/// Currents that come a whole sample late raise an alarm where nobody says so, and none where the motor file does.
#[test]
fn channels_that_are_late_by_known_times_are_brought_to_one_instant() {
    let mut before = None;
    let late = samples(|_, sample| {
        let now = sample.sample.i_s_abc;
        sample.sample.i_s_abc = before.replace(now).unwrap_or(now);
    });
    let departs = |config: MonitorConfig| {
        let reports = reports(config, &late);
        reports.iter().any(|r| {
            r.moving
                .is_some_and(|moving| moving.fault.is_some() || moving.is_unexplained)
        })
    };
    let mut known = config();
    known.converter.chain = AnalogueChain {
        delay: [0.0, 0.0, 0.0, 1e-4, 1e-4, 1e-4],
        roll_off: 0.0,
    };
    assert!(!departs(known));
    assert!(departs(config()));
    known.converter.chain.delay = [-5e-5, 0.0, 0.0, 1e-4, 1e-4, 1e-4];
    assert_eq!(
        Companion::new(&known).not_possible(),
        Some(NoMotion::ChannelsApart)
    );
}

/// In blocks of any length the same comes out, bit for bit.
#[test]
fn the_length_of_blocks_changes_no_bit() {
    let config = config();
    let monitor = Monitor::new(config).expect("valid");
    let coded = coded(&samples(|_, _| {})[..9_000]);
    let run = |length: usize| {
        let (mut state, mut companion) = (MonitorState::default(), Companion::new(&config));
        let blocks = coded.codes.chunks(length).zip(coded.counts.chunks(length));
        for (codes, counts) in blocks {
            let mut block = RawBlock::new(codes, counts);
            while !block.is_empty() {
                monitor.update_block_beside(&mut state, &mut block, &mut companion);
            }
        }
        companion
    };
    assert_eq!(run(32), run(1));
    assert_eq!(run(32), run(7));
}
