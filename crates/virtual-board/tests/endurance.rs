//! An hour of emulated time, or as many seconds as ENDURANCE_S says: nothing is missed, drifts or grows, and FAULT is lit
//! while there is a fault and at no other time.

mod common;

use board::{Frame, LAMP_NAMES, Message};
use common::{INHIBITED, LAMP_TEST_S, board as board_of, scenario};
use monitor::Lamp;
use motor::motor_file::Frame as MotorFrame;
use scenario::Fault;

/// Long enough for every ordinary run of the tests; an hour is asked for by ENDURANCE_S=3600.
const DEFAULT_S: f64 = 60.0;
/// The sampling clock against the supply's: frames come once per cycle of 60 Hz.
const FRAMES_PER_SECOND: f64 = 60.0;
/// The load doubles and halves, and the stator heats beyond measure, again and again: name, per cent, from and to, s.
const FAULTS: [(&str, f64, f64, f64); 2] = [("Bl", 100.0, 5.0, 9.0), ("Rs", 50.0, 12.0, 17.0)];
/// After so many seconds the faults come again.
const ROUND_S: f64 = 20.0;
/// What lamps take to light or go out at most: filling a window (5 cycles) and persistence (3), twice over.
const LAG_S: f64 = 0.27;
/// Two windows and a block: what a frame may be behind the converter.
const FRAME_LAG: u64 = 2 * 167 + 32;

#[test]
fn nothing_is_missed_drifts_or_grows() {
    let asked = std::env::var("ENDURANCE_S")
        .ok()
        .and_then(|text| text.parse().ok());
    let seconds: f64 = asked.unwrap_or(DEFAULT_S);
    let mut scenario = scenario(seconds + 1.0);
    scenario.faults = (0..(seconds / ROUND_S) as u32)
        .flat_map(faults_of)
        .collect();
    let mut board = board_of(&scenario);
    board.forget_taken();
    board.run(LAMP_TEST_S).expect("a lamp test");
    let mut reader = Reader::default();
    let mut stack_after_warm_up = 0;
    for second in 0..seconds as u32 {
        for _ in 0..10 {
            board.run(0.1).expect("a run");
            reader.take(&board.frames());
            for line in board.log() {
                println!("{second} s: {line}");
            }
        }
        reader.assert_on_time(board.tally().conversions);
        if second % 300 == 299 {
            println!("{} s of {seconds} s", second + 1);
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
    // Of 20 s the lamps are told for certain in 8.5 s with a fault and in 10 s without.
    assert!(f64::from(reader.faulty) > 0.9 * 8.5 / 20.0 * frames);
    assert!(f64::from(reader.healthy) > 0.9 * 10.0 / 20.0 * frames);
    println!(
        "{seconds} s: {frames} frames, FAULT lit in {} and dark in {}, {} conversions, {stack_after_warm_up} bytes of stack",
        reader.faulty, reader.healthy, tally.conversions
    );
}

fn faults_of(round: u32) -> Vec<Fault> {
    let begin = ROUND_S * f64::from(round);
    let fault = |(name, percent, from_s, to_s)| {
        let fault = Fault::percent(name, percent, MotorFrame::RotorFlux).expect("a known fault");
        Fault {
            from_s: begin + from_s,
            to_s: begin + to_s,
            ..fault
        }
    };
    FAULTS.into_iter().map(fault).collect()
}

/// Whether FAULT has to be lit at time `t`, s; `None` while it may change.
fn is_faulty(t: f64) -> Option<bool> {
    let t = t % ROUND_S;
    let settled = |at: f64| !(at..at + LAG_S).contains(&t);
    let begun = FAULTS
        .iter()
        .all(|(.., from, to)| settled(*from) && settled(*to));
    let faulty = FAULTS
        .iter()
        .any(|(.., from, to)| (*from..*to).contains(&t));
    begun.then_some(faulty)
}

/// Joins the bytes to frames and looks at their numbers.
#[derive(Default)]
struct Reader {
    rest: Vec<u8>,
    frames: u32,
    lost: u32,
    sample_index: u64,
    /// Frames in which FAULT had to be lit and was, had to be dark and was.
    faulty: u32,
    healthy: u32,
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
        self.judge(frame);
    }

    fn judge(&mut self, frame: &Frame) {
        let t = (frame.sample_index + INHIBITED as u64) as f64 * 1e-4;
        let lamp = LAMP_NAMES.iter().position(|name| *name == "fault");
        let lit = frame.lamp(lamp.expect("a lamp")) == Lamp::On;
        if let Some(faulty) = is_faulty(t) {
            assert_eq!(lit, faulty, "FAULT at {t} s: {frame:?}");
            self.faulty += u32::from(faulty);
            self.healthy += u32::from(!faulty);
        }
    }

    /// The latest frame's time stamp is that of an instant that the converter took just now.
    fn assert_on_time(&self, conversions: u64) {
        let told = self.sample_index + INHIBITED as u64;
        let behind = conversions.checked_sub(told);
        assert!(
            self.frames == 0 || behind.is_some_and(|behind| behind <= FRAME_LAG),
            "stamped {told} when {conversions} instants were taken"
        );
    }
}
