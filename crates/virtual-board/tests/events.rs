//! The event log in flash: what happened is there after any reset, and writing it costs no sample.

mod common;

use board::{EVENT_BYTES, Event, EventCause, LOG_EVENTS};
use common::master::{CHARACTER_S, Master, UNIT, bytes, good, sealed};
use common::{EVENT_LOG, LAMP_TEST_S, board as board_of, logged, scenario};
use motor::motor_file::Frame as MotorFrame;
use scenario::Fault;
use virtual_board::{Cause, Port, VirtualBoard};

const HEALTHY: [bool; 9] = [true, false, false, false, false, false, false, false, false];
/// Events of a page: what is forgotten at once.
const PAGE_EVENTS: u32 = LOG_EVENTS / 8;

fn causes(events: &[Event]) -> Vec<EventCause> {
    events.iter().map(|event| event.cause).collect()
}

/// A board whose log is full, so that the next event enters a page that has to be erased.
fn with_full_log() -> VirtualBoard {
    let mut board = board_of(&scenario(60.0));
    for number in 1..=LOG_EVENTS {
        let event = Event {
            number,
            uptime_s: 1,
            cause: EventCause::SamplesMissing,
            times: 1,
            values: [1, 0],
        };
        let at = EVENT_LOG + (number - 1) * EVENT_BYTES as u32;
        board.flash(at, &event.to_bytes()).expect("flash");
    }
    board
}

#[test]
fn what_happened_is_there_after_a_reset_with_its_cause_and_in_its_order() {
    use EventCause::*;
    let mut scenario = scenario(60.0);
    let mut fault = Fault::percent("Rs", 50.0, MotorFrame::RotorFlux).expect("a known fault");
    (fault.from_s, fault.to_s) = (0.8, 1.6);
    scenario.faults = vec![fault];
    let mut board = board_of(&scenario);
    board.run(LAMP_TEST_S + 2.4).expect("a run");
    assert_eq!(board.lamps(), HEALTHY);
    let events = logged(&mut board);
    assert_eq!(causes(&events), [Start, FaultOn, FaultOff]);
    let [start, on, _] = events[..] else {
        panic!("{events:?}")
    };
    // Power; the program's checksum as it was sealed.
    let checksum = Master::new(UNIT).long(&mut board, board::modbus::Field::ProgramChecksum);
    assert_eq!(start.values, [1, checksum]);
    assert!(on.uptime_s == 2 && on.times == 1, "{on:?}");
    assert!(on.values[1] > 0 && on.values[1] <= 1_000, "{on:?}");
    Master::new(UNIT).command(&mut board, 1);
    board.reset(Cause::Watchdog).expect("a reset");
    board.run(LAMP_TEST_S + 0.4).expect("a run");
    let events = logged(&mut board);
    assert_eq!(
        causes(&events)[3..],
        [Acknowledged, Crash, Start],
        "{events:?}"
    );
    let numbers: Vec<u32> = events.iter().map(|event| event.number).collect();
    assert_eq!(numbers, [1, 2, 3, 4, 5, 6]);
}

#[test]
fn a_page_is_erased_and_written_while_every_sample_is_taken() {
    let mut board = with_full_log();
    board.run(LAMP_TEST_S).expect("a lamp test");
    board.log();
    let before = board.taken().len();
    board.run(1.0).expect("a run");
    let events = logged(&mut board);
    let (first, last) = (events.first(), events.last());
    assert_eq!(first.map(|event| event.number), Some(PAGE_EVENTS + 1));
    assert_eq!(last.map(|event| event.cause), Some(EventCause::Start));
    assert_eq!(last.map(|event| event.number), Some(LOG_EVENTS + 1));
    let told = board.log();
    assert!(
        told.iter().all(|line| !line.contains("missing")),
        "{told:?}"
    );
    let taken = board.taken().len() - before;
    assert!(taken.abs_diff(10_000) <= 32, "{taken}");
    assert_eq!((board.lamps(), board.tally().resets), (HEALTHY, 0));
}

/// A page erased and eight words programmed.
const STEPS: u32 = 9;

#[test]
fn power_that_fails_at_any_step_of_an_event_loses_no_other() {
    for step in 0..=STEPS {
        let mut board = with_full_log();
        let cause = [Cause::Watchdog, Cause::Power][step as usize % 2];
        board.reset_within_flash_step(step, cause);
        board.run(LAMP_TEST_S + 0.4).expect("a run");
        let cut = board.tally().resets;
        assert_eq!(cut, u64::from(step < STEPS), "step {step}");
        board.run(LAMP_TEST_S + 0.4).expect("a run");
        assert_eq!((board.lamps(), board.tally().resets), (HEALTHY, cut));
        let events = logged(&mut board);
        let old = events.iter().filter(|event| event.number <= LOG_EVENTS);
        assert_eq!(old.count() as u32, LOG_EVENTS - PAGE_EVENTS, "step {step}");
        let new: Vec<&Event> = events
            .iter()
            .filter(|event| event.number > LOG_EVENTS)
            .collect();
        let last = new.last().expect("an event after the cut");
        assert_eq!(last.cause, EventCause::Start, "step {step}: {new:?}");
    }
}

#[test]
fn a_log_whose_page_is_being_erased_is_busy_and_costs_no_sample() {
    let mut board = with_full_log();
    // Before the first block is judged nothing is written; the erasure takes 22 ms.
    let request = sealed(&[1, 20, 7, 6, 0, 1, 0, 0, 0, 1]);
    let (mut busy, mut answered) = (0, 0);
    board.run(LAMP_TEST_S - 0.1).expect("a run");
    // The answer has 9 characters; with silence and request a round is shorter than the erasure.
    for _ in 0..60 {
        board.take_sent(Port::Modbus);
        board.deliver(Port::Modbus, &good(&request));
        board
            .run(CHARACTER_S * (request.len() + 10) as f64 + 0.003)
            .expect("a run");
        match bytes(&board.take_sent(Port::Modbus)).get(1) {
            Some(0x94) => busy += 1,
            Some(0x14) => answered += 1,
            _ => {}
        }
    }
    assert!(
        busy >= 1 && answered > 10,
        "{busy} busy, {answered} answered"
    );
    assert_eq!(board.tally().resets, 0);
}
