//! Learning on the board, and its calibration in flash: used after a reset, never half of one.

mod common;

use board::{Calibration, Frame, LEARN_WINDOWS, Loaded, Shown, Store};
use common::flash_image::FlashImage;
use common::{INHIBITED, LAMP_TEST_S, board as board_of, motor, scenario};
use monitor::{Monitor, MonitorConfig, MonitorState, RawSample};
use motor::motor_file::Frame as MotorFrame;
use scenario::{Change, Fault, Scenario};
use virtual_board::{Cause, VirtualBoard};

const HEALTHY: [bool; 9] = [true, false, false, false, false, false, false, false, false];
const SENSOR: usize = 5;
/// Where src/hardware/flash_store.rs has the calibration.
const STORE: u32 = 0x0807_F000;
const STORE_BYTES: usize = 4096;
/// Until the button counts as held very long.
const HOLD_S: f64 = 8.1;
/// Learning takes one window per supply cycle of 60 Hz; the rest is what the first windows take.
const LEARNING_S: f64 = LEARN_WINDOWS as f64 / 60.0 + 0.3;
/// Words that one record takes to be programmed.
const RECORD_WORDS: u32 = 40;

/// A healthy motor whose sensors have offsets, as ageing gives them.
fn offsets() -> Scenario {
    let offset = |name: &str, offset: f64| Fault {
        change: Change::Offset(offset),
        ..Fault::percent(name, 0.0, MotorFrame::RotorFlux).expect("a known fault")
    };
    let mut scenario = scenario(60.0);
    scenario.faults = vec![offset("ic", 0.3), offset("va", -4.0)];
    scenario
}

fn faulty(name: &str, change: Change) -> Scenario {
    let mut scenario = scenario(60.0);
    let fault = Fault::percent(name, 0.0, MotorFrame::RotorFlux).expect("a known fault");
    scenario.faults = vec![Fault { change, ..fault }];
    scenario
}

fn hold_button(board: &mut VirtualBoard) {
    board.press(true);
    board.run(HOLD_S).expect("a run");
    board.press(false);
}

fn stored(board: &mut VirtualBoard) -> Loaded {
    let bytes = board.read_flash(STORE, STORE_BYTES).expect("flash");
    Store::new(FlashImage(bytes), 0).load().expect("an image")
}

/// Starts the board again and gives the frames of 0.8 s, with the samples that they come from.
fn frames_after_reset(board: &mut VirtualBoard) -> (Vec<Frame>, Vec<RawSample>) {
    board.reset(Cause::Power).expect("a reset");
    frames(board)
}

fn frames(board: &mut VirtualBoard) -> (Vec<Frame>, Vec<RawSample>) {
    let before = board.taken().len();
    board.run(LAMP_TEST_S).expect("a run");
    let mut bytes = Vec::new();
    for _ in 0..8 {
        board.run(0.1).expect("a run");
        bytes.extend(board.frames());
    }
    let frames = bytes
        .split_inclusive(|byte| *byte == 0)
        .map(|bytes| Frame::decode(bytes).expect("an undamaged frame"))
        .collect();
    (frames, board.taken()[before..].to_vec())
}

/// The frames that the host's core makes of the samples with this calibration.
fn expected(
    calibration: Option<&Calibration>,
    samples: &[RawSample],
    seen: &[Frame],
) -> Vec<Frame> {
    let mut config = MonitorConfig::of_board(&motor()).expect("shipped");
    if let Some(calibration) = calibration {
        calibration.apply(&mut config);
    }
    let monitor = Monitor::new(config).expect("a valid configuration");
    let mut state = MonitorState::default();
    let reports = samples
        .iter()
        .skip(INHIBITED)
        .filter_map(|raw| monitor.update_raw(&mut state, raw));
    reports
        .zip(seen)
        .map(|(report, frame)| {
            Frame::new(
                &report,
                &Shown::only(report.lamps),
                frame.sequence,
                frame.vdda_millivolt,
            )
        })
        .collect()
}

#[test]
fn what_was_learnt_is_used_after_a_reset() {
    let mut board = board_of(&offsets());
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    assert_eq!(board.lamps(), HEALTHY);
    assert_eq!(stored(&mut board).newest, None);
    hold_button(&mut board);
    board.run(LEARNING_S).expect("a run");
    let learnt = stored(&mut board).newest.expect("a calibration");
    let stack = board.stack_used().expect("a stack");
    println!("{stack} bytes of stack");
    // Beyond three quarters of its room the board doubts itself.
    assert!(stack < 15 * 1_024, "{stack}");
    // The converters' steps are 0.2 V and 7 mA; a mean over ten seconds is far finer, but for the truth's own offset.
    assert!((learnt.voltage.offset[0] + 4.0).abs() < 0.2, "{learnt:?}");
    assert!((learnt.current.offset[2] - 0.3).abs() < 0.007, "{learnt:?}");
    assert_eq!(learnt.healthy.windows, LEARN_WINDOWS);
    let (frames, samples) = frames_after_reset(&mut board);
    assert!(frames.len() > 30, "{} frames", frames.len());
    assert_eq!(frames, expected(Some(&learnt), &samples, &frames));
    assert_ne!(frames, expected(None, &samples, &frames));
    assert_eq!(board.lamps(), HEALTHY);
}

#[test]
fn a_faulty_motor_is_not_learnt() {
    for (name, change) in [
        ("Rs", Change::Factor(1.5)),
        ("ia", Change::Factor(0.0)),
        ("wr", Change::Factor(1.1)),
    ] {
        let mut board = board_of(&faulty(name, change));
        board.run(LAMP_TEST_S + 0.8).expect("a run");
        hold_button(&mut board);
        board.run(2.0 * LEARNING_S).expect("a run");
        assert_eq!(stored(&mut board).newest, None, "{name}");
    }
}

/// The first lesson ends at 19.2 s of the scenario, the second begins at 27.3 s.
const BETWEEN_LESSONS_S: f64 = 22.0;

/// A board with an old calibration, about to store a new one, and the old one.
fn about_to_store() -> (VirtualBoard, Calibration) {
    // The offsets go between the two lessons: what they teach can then be told apart by the frames.
    let mut scenario = offsets();
    for fault in &mut scenario.faults {
        fault.to_s = BETWEEN_LESSONS_S;
    }
    let mut board = common::board_to_restore(&scenario);
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    hold_button(&mut board);
    board.run(LEARNING_S).expect("a run");
    let old = stored(&mut board).newest.expect("a calibration");
    hold_button(&mut board);
    board.run(LEARNING_S - 0.5).expect("a run");
    assert_eq!(stored(&mut board).newest, Some(old), "not yet");
    (board, old)
}

#[test]
fn a_reset_at_any_step_of_a_write_leaves_the_old_or_the_new_calibration() {
    let (mut board, old) = about_to_store();
    let before = board.snapshot().expect("a snapshot");
    board.run(1.0).expect("a run");
    let new = stored(&mut board).newest.expect("a calibration");
    assert_ne!(old, new);
    let (mut olds, mut news) = (0, 0);
    for step in 0..=RECORD_WORDS {
        let cause = if step % 2 == 0 {
            Cause::Watchdog
        } else {
            Cause::Power
        };
        board.restore(&before).expect("a snapshot of this board");
        board.reset_within_flash_step(step, cause);
        let resets = board.tally().resets;
        while board.tally().resets == resets && stored(&mut board).newest == Some(old) {
            board.run(0.01).expect("a run");
        }
        let cut = board.tally().resets - resets;
        assert_eq!(cut, u64::from(step < RECORD_WORDS), "step {step}");
        let (frames, samples) = if cut == 1 {
            frames(&mut board)
        } else {
            frames_after_reset(&mut board)
        };
        assert_eq!(
            board.tally().resets,
            resets + 1,
            "step {step}: it starts once"
        );
        let [as_old, as_new] = [&old, &new].map(|which| expected(Some(which), &samples, &frames));
        assert_ne!(as_old, as_new, "the two cannot be told apart");
        assert!(frames == as_old || frames == as_new, "step {step}: a mix");
        assert!(!board.lamps()[SENSOR], "step {step}");
        olds += u32::from(frames == as_old);
        news += u32::from(frames == as_new);
    }
    println!("{olds} times the old calibration, {news} times the new one");
    assert!(olds >= RECORD_WORDS - 2 && news >= 1);
}
