//! An hour of emulated time, or as many seconds as ENDURANCE_S says: nothing is missed, drifts or grows.

mod common;

use board::{Frame, Message};
use common::{LAMP_TEST_S, board as board_of, scenario};
use motor::motor_file::Frame as MotorFrame;
use sim_host::scenario::Fault;

/// Long enough for every ordinary run of the tests; an hour is asked for by ENDURANCE_S=3600.
const DEFAULT_S: f64 = 60.0;
/// The sampling clock against the supply's: frames come once per cycle of 60 Hz.
const FRAMES_PER_SECOND: f64 = 60.0;

#[test]
fn nothing_is_missed_drifts_or_grows() {
    let asked = std::env::var("ENDURANCE_S")
        .ok()
        .and_then(|text| text.parse().ok());
    let seconds: f64 = asked.unwrap_or(DEFAULT_S);
    let mut scenario = scenario(seconds + 1.0);
    let fault = |name, percent, from_s: f64, to_s: f64| {
        let fault = Fault::percent(name, percent, MotorFrame::RotorFlux).expect("a known fault");
        Fault {
            from_s,
            to_s,
            ..fault
        }
    };
    // The load doubles and halves, and the stator heats beyond measure, again and again.
    scenario.faults = (0..(seconds / 20.0) as u32)
        .map(f64::from)
        .flat_map(|k| {
            [
                fault("Bl", 100.0, 20.0 * k + 5.0, 20.0 * k + 9.0),
                fault("Rs", 50.0, 20.0 * k + 12.0, 20.0 * k + 17.0),
            ]
        })
        .collect();
    let mut board = board_of(&scenario);
    board.forget_taken();
    board.run(LAMP_TEST_S).expect("a lamp test");
    let mut reader = Reader::default();
    let mut stack_after_warm_up = 0;
    for second in 0..seconds as u32 {
        for _ in 0..10 {
            board.run(0.1).expect("a run");
            reader.take(&board.drain_rtt(1).expect("a channel for frames"));
            for line in board.log() {
                println!("{second} s: {line}");
            }
        }
        if second == 30.min(seconds as u32 / 2) {
            stack_after_warm_up = board.stack_used().expect("a stack");
        }
    }
    let tally = board.tally();
    assert_eq!((tally.missed_triggers, tally.resets), (0, 0), "{tally:?}");
    // The lamp test shifts the end of the last block by less than two of them.
    let expected = seconds * 1e4;
    assert!(
        (tally.conversions as f64 - expected).abs() < 200.0,
        "{tally:?}"
    );
    assert_eq!(reader.lost, 0, "frames were lost");
    let frames = f64::from(reader.frames);
    assert!(
        (frames - FRAMES_PER_SECOND * seconds).abs() < 20.0,
        "{frames} frames"
    );
    assert_eq!(
        board.stack_used().expect("a stack"),
        stack_after_warm_up,
        "the stack grows"
    );
    println!(
        "{seconds} s: {frames} frames, {} conversions, {stack_after_warm_up} bytes of stack",
        tally.conversions
    );
}

/// Joins the bytes to frames and looks at their numbers.
#[derive(Default)]
struct Reader {
    rest: Vec<u8>,
    frames: u32,
    lost: u32,
    sample_index: u64,
}

impl Reader {
    fn take(&mut self, bytes: &[u8]) {
        self.rest.extend(bytes);
        while let Some(end) = self.rest.iter().position(|byte| *byte == 0) {
            let frame: Vec<u8> = self.rest.drain(..=end).collect();
            if let Message::Window(frame) = Message::decode(&frame).expect("an undamaged frame") {
                self.frame(&frame);
            }
        }
    }

    fn frame(&mut self, frame: &Frame) {
        self.lost += frame.sequence - self.frames;
        self.frames = frame.sequence + 1;
        let samples = frame.sample_index - self.sample_index;
        // A cycle of 60 Hz is 166.7 samples; the first frames come before the supply is found.
        let searching = self.frames < 10;
        assert!(
            searching || (160..=174).contains(&samples),
            "{samples} samples in a window: {frame:?}"
        );
        self.sample_index = frame.sample_index;
    }
}
