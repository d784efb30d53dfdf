//! What is never at rest, on the board: a press that starts, works, and gets a fault. Lamps and frames are the host's.

mod common;

use board::{Frame, Message, Shown};
use common::{INHIBITED, LAMP_TEST_S, Program, Sensors, variant};
use monitor::{Monitor, MonitorConfig, MonitorState, MotionWord, RawSample, Report};
use motion::Companion;
use motor::motor_file::Frame as MotorFrame;
use scenario::{Fault, Interpolation, Load, Profile, Scenario, Start};
use virtual_board::VirtualBoard;

const END_S: f64 = 2.6;
const FAULT_FROM_S: f64 = 1.4;
/// Loaded and idle by turns, s: five cycles of 60 Hz, as many as a window has.
const STROKE_S: f64 = 0.08;
const RUN: usize = 0;
const SENSOR: usize = 5;
const FAULT: usize = 8;

/// From a start on, loaded in every second stroke.
fn press(program: &Program) -> Scenario {
    let mut scenario = Scenario::of(program.motor.clone(), END_S);
    scenario.seed = 5;
    scenario.start = Start::Standstill;
    scenario.supply.switch_on_s = 0.2;
    let rated = program.motor.nameplate.torque_nm;
    let strokes = (0..(END_S / STROKE_S) as usize).map(|k| {
        let torque = if k % 2 == 0 { 0.1 } else { 0.8 };
        (k as f64 * STROKE_S, torque * rated)
    });
    let profile = Profile::new(strokes.collect(), Interpolation::Step).expect("times that grow");
    scenario.load.friction_factor = 0.0;
    scenario.load.other = Load::Profile {
        profile,
        active: false,
    };
    scenario
}

struct Run {
    frames: Vec<Frame>,
    reports: Vec<Report>,
    lamps: [bool; 9],
}

/// The board's frames, and what the host says of the samples that the board took.
fn run(program: &Program, scenario: &Scenario) -> Run {
    let sensors = Sensors::new(scenario);
    let mut board = VirtualBoard::new(&program.elf, Box::new(sensors)).expect("a firmware");
    board.run(LAMP_TEST_S).expect("a lamp test");
    let mut bytes = Vec::new();
    for _ in 0..(END_S / 0.04) as usize {
        board.run(0.04).expect("a run");
        bytes.extend(board.frames());
    }
    let tally = board.tally();
    assert_eq!((tally.missed_triggers, tally.resets), (0, 0), "{tally:?}");
    let frames = bytes.split_inclusive(|byte| *byte == 0);
    let frames = frames.filter_map(|bytes| match Message::decode(bytes).expect("undamaged") {
        Message::Window(frame) => Some(frame),
        Message::Capture(_) => None,
    });
    Run {
        frames: frames.collect(),
        reports: host(program, board.taken()),
        lamps: board.lamps(),
    }
}

fn host(program: &Program, taken: &[RawSample]) -> Vec<Report> {
    let config = MonitorConfig::of_board(&program.motor).expect("effects of the library");
    let monitor = Monitor::new(config).expect("valid");
    let (mut state, mut companion) = (MonitorState::default(), Companion::new(monitor.config()));
    assert_eq!(companion.not_possible(), None);
    let judged = taken.iter().skip(INHIBITED);
    let update = |raw| monitor.update_raw_beside(&mut state, raw, &mut companion);
    judged.filter_map(update).collect()
}

impl Run {
    /// Every frame is the host's, bit for bit.
    fn assert_as_on_the_host(&self) {
        assert!(self.frames.len() > 100, "{}", self.frames.len());
        for (frame, report) in self.frames.iter().zip(&self.reports) {
            let shown = Shown::only(report.shown_lamps());
            let expected = Frame::new(report, &shown, frame.sequence, frame.vdda_millivolt);
            assert_eq!(frame, &expected);
        }
    }

    fn words(&self, from_s: f64) -> Vec<u8> {
        let frames = self.frames.iter();
        let late = frames.filter(|frame| frame.sample_index as f64 * 1e-4 > from_s);
        late.map(|frame| frame.motion).collect()
    }
}

#[test]
fn a_healthy_press_is_judged_in_motion_and_lights_nothing() {
    let program = variant("press");
    let run = run(&program, &press(&program));
    run.assert_as_on_the_host();
    let words = run.words(0.6);
    let judged = words
        .iter()
        .filter(|word| **word == MotionWord::Judged as u8);
    let moving = words
        .iter()
        .filter(|word| **word != MotionWord::AtRest as u8);
    let (judged, moving) = (judged.count(), moving.count());
    println!("{judged} of {moving} judged in motion, of {}", words.len());
    assert!(moving > words.len() / 2 && judged == moving, "{words:?}");
    assert!(run.lamps[RUN] && !run.lamps[FAULT] && !run.lamps[SENSOR]);
}

#[test]
fn a_fault_that_comes_to_a_press_is_shown_with_its_cause() {
    let program = variant("press");
    let mut scenario = press(&program);
    let mut fault = Fault::percent("ib", 6.0, MotorFrame::RotorFlux).expect("a known fault");
    fault.from_s = FAULT_FROM_S;
    scenario.faults = vec![fault];
    let run = run(&program, &scenario);
    run.assert_as_on_the_host();
    assert!(run.words(0.0).contains(&(MotionWord::Fault as u8)));
    assert!(run.lamps[FAULT] && run.lamps[SENSOR], "{:?}", run.lamps);
}
