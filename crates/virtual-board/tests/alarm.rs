//! The samples around an alarm: from the firmware's serial line through a pseudo-terminal to a recording on the host.
#![cfg(unix)]

mod common;

use std::io::Write;
use std::time::{Duration, Instant};

use board::{CAPTURE_EVERY, CAPTURE_INSTANTS, Message};
use common::{LAMP_TEST_S, board as board_of, motor, scenario};
use live::{Collector, Decoder, Fetched, open_serial, recording};
use motor::motor_file::Frame as MotorFrame;
use scenario::Fault;
use serialport::{SerialPort, TTYPort};
use virtual_board::{Port, VirtualBoard};

const FAULT_FROM_S: f64 = 1.0;

/// A board whose motor heats, after it has handed its samples over once at least.
fn alarmed() -> VirtualBoard {
    let mut scenario = scenario(10.0);
    let fault = Fault::percent("Rs", 50.0, MotorFrame::RotorFlux).expect("a known fault");
    scenario.faults = vec![Fault {
        from_s: FAULT_FROM_S,
        ..fault
    }];
    let mut board = board_of(&scenario);
    board.run(LAMP_TEST_S + FAULT_FROM_S + 4.0).expect("a run");
    board
}

/// What the host reads at one end of a pseudo-terminal while the board's bytes go in at the other.
fn fetch(bytes: Vec<u8>) -> (Decoder, u64, Fetched) {
    let (mut wire, host) = TTYPort::pair().expect("a pseudo-terminal");
    let mut source = open_serial(&host.name().expect("a name"), 115_200).expect("a port");
    let writer = std::thread::spawn(move || {
        for piece in bytes.chunks(256) {
            wire.write_all(piece).expect("a reader");
        }
        std::thread::sleep(Duration::from_secs(2));
    });
    let (mut decoder, mut collector) = (Decoder::default(), Collector::default());
    let (mut windows, mut fetched) = (0, None);
    let patience = Instant::now() + Duration::from_secs(60);
    while !writer.is_finished() && Instant::now() < patience {
        let bytes = source.read().unwrap_or_default();
        for message in decoder.take(&bytes) {
            match message {
                Message::Window(_) => windows += 1,
                Message::Capture(piece) => fetched = fetched.or(collector.take(piece)),
            }
        }
    }
    writer.join().expect("a writer");
    (decoder, windows, fetched.expect("a whole capture"))
}

#[test]
fn they_are_the_converters_own_and_become_a_recording() {
    let mut board = alarmed();
    let sent = board.take_sent(Port::Frames);
    let (decoder, windows, fetched) = fetch(sent.iter().map(|sent| sent.byte).collect());
    assert_eq!((decoder.damaged, decoder.lost), (0, 0));
    assert!(windows > 270, "{windows} windows of 5 s at 60 Hz");
    assert_eq!(fetched.samples.len(), CAPTURE_INSTANTS);
    let taken: Vec<_> = board
        .taken()
        .iter()
        .step_by(CAPTURE_EVERY)
        .copied()
        .collect();
    let begin = taken
        .windows(CAPTURE_INSTANTS)
        .position(|window| window == fetched.samples)
        .expect("the samples that the converter took, bit for bit");
    let begin_s = (begin * CAPTURE_EVERY) as f64 * 1e-4;
    // It begins half its length, 0.128 s, before the alarm, which comes within 0.2 s of the fault.
    let expected = FAULT_FROM_S - 0.128..FAULT_FROM_S + 0.072;
    assert!(expected.contains(&begin_s), "{begin_s}");
    let recording = recording(&fetched, &motor()).expect("this motor's constants");
    assert_eq!(recording.len(), CAPTURE_INSTANTS);
    let speed = recording.speed().expect("a speed");
    let mean = speed.iter().sum::<f64>() / speed.len() as f64;
    // Close to the 183 rad/s at which this motor runs with its load.
    assert!((mean - 183.0).abs() < 2.0, "{mean}");
}
