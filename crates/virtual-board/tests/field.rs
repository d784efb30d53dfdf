//! What a board goes through in the field, one thing after the other: a fault, a supply of its own that sinks, another
//! configuration, a fault again, power that fails. What it shows follows, and what it keeps tells the story.

mod common;

use board::EventCause::{self, *};
use board::modbus::{Command, Field};
use board::{Configuration, MotorImage};
use common::master::{Master, UNIT};
use common::{LAMP_TEST_S, board as board_of, logged, motor, scenario};
use monitor::MonitorConfig;
use motor::motor_file::Frame as MotorFrame;
use scenario::Fault;
use virtual_board::{Cause, VirtualBoard};

const HEALTHY: [bool; 9] = [true, false, false, false, false, false, false, false, false];
const SENSOR: usize = 5;
const FAULT: usize = 8;
/// When the stator's resistance is half as large again, and healthy again, s.
const FAULTS: [(f64, f64); 2] = [(2.0, 4.0), (13.0, 15.0)];

fn faulty_twice() -> VirtualBoard {
    let mut scenario = scenario(100.0);
    scenario.faults = FAULTS
        .iter()
        .map(|(from_s, to_s)| Fault {
            from_s: *from_s,
            to_s: *to_s,
            ..Fault::percent("Rs", 50.0, MotorFrame::RotorFlux).expect("a known fault")
        })
        .collect();
    board_of(&scenario)
}

/// Runs to a moment of the scenario, whose time begins with the first sample.
fn run_to(board: &mut VirtualBoard, at_s: f64) {
    let now_s = board.tally().conversions as f64 * 1e-4;
    assert!(now_s < at_s, "{now_s} s is past {at_s} s");
    board.run(at_s - now_s).expect("a run");
}

/// The same motor with thresholds a tenth larger.
fn less_touchy() -> Configuration {
    let mut config = MonitorConfig::of_board(&motor()).expect("shipped");
    config.thresholds = config.thresholds.map(|threshold| 1.1 * threshold);
    Configuration::of("less touchy", &MotorImage::new(&config))
}

fn configure(board: &mut VirtualBoard, configuration: &Configuration) {
    let master = Master::new(UNIT);
    master.stage(board, configuration);
    master.command(board, Command::Commit as u16);
    master.command(board, Command::Confirm as u16);
}

#[test]
fn a_board_goes_through_what_the_field_brings_and_keeps_the_story() {
    let mut board = faulty_twice();
    board.run(LAMP_TEST_S).expect("a lamp test");
    run_to(&mut board, 1.5);
    assert_eq!((board.lamps(), board.relay()), (HEALTHY, true));
    run_to(&mut board, 3.0);
    assert!(board.lamps()[FAULT] && !board.lamps()[SENSOR] && !board.relay());
    run_to(&mut board, 5.0);
    assert_eq!((board.lamps(), board.relay()), (HEALTHY, true));
    // The supply of the converters sinks: nothing is blamed on the motor.
    board.set_vdda(3_100);
    run_to(&mut board, 6.5);
    assert!(board.lamps()[FAULT] && board.lamps()[SENSOR] && !board.relay());
    board.set_vdda(3_300);
    run_to(&mut board, 8.0);
    assert_eq!((board.lamps(), board.relay()), (HEALTHY, true));
    configure(&mut board, &less_touchy());
    run_to(&mut board, 12.5);
    assert_eq!((board.lamps(), board.relay()), (HEALTHY, true));
    let identification = Master::new(UNIT).long(&mut board, Field::MotorIdentification);
    assert_eq!(identification, less_touchy().identification());
    run_to(&mut board, 14.0);
    assert!(board.lamps()[FAULT] && !board.lamps()[SENSOR]);
    assert_eq!(board.tally().resets, 0);
    board.reset(Cause::Power).expect("a reset");
    board.run(LAMP_TEST_S + 2.0).expect("a run");
    assert_eq!((board.lamps(), board.relay()), (HEALTHY, true));
    let events = logged(&mut board);
    let causes: Vec<EventCause> = events.iter().map(|event| event.cause).collect();
    // FAULT and SENSOR come and go more than once a minute; what is not written yet when the power fails is lost.
    let before = [
        Start, FaultOn, FaultOff, SensorOn, Doubt, SensorOff, Configured,
    ];
    // The fault has gone when the power comes back.
    let after = [Start];
    let told = [&before[..], &after[..]].concat();
    let mut expected = told;
    let mut found = causes.clone();
    // Lamp and doubt of one block are written in the order of their numbers.
    expected.sort_by_key(|cause| *cause as u16);
    found.sort_by_key(|cause| *cause as u16);
    assert_eq!(found, expected, "{causes:?}");
    assert_eq!(causes[..3], [Start, FaultOn, FaultOff]);
    assert_eq!(causes[6], Configured);
    assert_eq!(causes[7..], after);
    assert_eq!(events[6].values, [less_touchy().identification(), 1]);
}
