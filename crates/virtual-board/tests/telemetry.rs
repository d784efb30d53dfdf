//! The frames that the firmware sends hold, bit for bit, the residuals that the host computes from the same samples; its seconds are their
//! means.

mod common;

use board::modbus::{Field, SECONDS_FILE};
use board::{Frame, LAMP_NAMES, Message, SECOND_BYTES, Second, Shown, place_of_second};
use common::master::{Master, UNIT, ask, bytes, sealed};
use common::{INHIBITED, LAMP_TEST_S, board as board_of, motor, scenario};
use monitor::{Monitor, MonitorConfig, MonitorState, Report};
use motor::motor_file::Frame as MotorFrame;
use scenario::{Fault, Start};
use virtual_board::{Cause, VirtualBoard};

fn host_reports(taken: &[monitor::RawSample]) -> Vec<Report> {
    let config = MonitorConfig::of_board(&motor()).expect("shipped");
    let monitor = Monitor::new(config).expect("a valid configuration");
    let mut state = MonitorState::default();
    let judged = taken.iter().skip(INHIBITED);
    judged
        .filter_map(|raw| monitor.update_raw(&mut state, raw))
        .collect()
}

#[test]
fn every_frame_is_the_hosts_report_bit_for_bit() {
    let mut scenario = scenario(4.0);
    scenario.start = Start::Standstill;
    let mut fault = Fault::percent("Rs", 50.0, MotorFrame::RotorFlux).expect("a known fault");
    (fault.from_s, fault.to_s) = (2.0, 3.0);
    scenario.faults = vec![fault];
    let mut board = board_of(&scenario);
    board.run(LAMP_TEST_S).expect("a lamp test");
    let mut bytes = Vec::new();
    for _ in 0..100 {
        board.run(0.04).expect("a run");
        bytes.extend(board.frames());
    }
    let frames: Vec<Frame> = bytes
        .split_inclusive(|byte| *byte == 0)
        .filter_map(
            |bytes| match Message::decode(bytes).expect("an undamaged frame") {
                Message::Window(frame) => Some(frame),
                Message::Capture(_) => None,
            },
        )
        .collect();
    let reports = host_reports(board.taken());
    assert!(frames.len() > 200, "{} frames", frames.len());
    assert!(
        reports.len() - frames.len() <= 1,
        "{} reports",
        reports.len()
    );
    let mut with_residuals = 0;
    for (frame, report) in frames.iter().zip(&reports) {
        let expected = Frame::new(
            report,
            &Shown::only(report.lamps),
            frame.sequence,
            frame.vdda_millivolt,
        );
        assert_eq!(
            bits(frame),
            bits(&expected),
            "{frame:?} instead of {expected:?}"
        );
        assert_eq!(frame, &expected);
        with_residuals += usize::from(frame.residuals.is_some());
    }
    let sequence: Vec<u32> = frames.iter().map(|frame| frame.sequence).collect();
    assert!(
        sequence.windows(2).all(|pair| pair[1] == pair[0] + 1),
        "frames were lost"
    );
    assert!(with_residuals > 150, "{with_residuals}");
    let fault = LAMP_NAMES
        .iter()
        .position(|name| *name == "fault")
        .expect("a lamp");
    assert!(
        frames
            .iter()
            .any(|frame| frame.lamp(fault) == monitor::Lamp::On)
    );
}

/// `==` takes 0 and -0 for the same.
fn bits(frame: &Frame) -> Option<[u32; 4]> {
    frame.residuals.map(|r| r.map(f32::to_bits))
}

/// Seconds from `first` on, as a master reads them.
fn read_seconds(board: &mut VirtualBoard, first: u32, count: u32) -> Vec<Second> {
    let words = SECOND_BYTES as u16 / 2;
    let at = place_of_second(first) as u16 * words;
    let parts = [SECONDS_FILE, at, count as u16 * words].map(u16::to_be_bytes);
    let request = sealed(&[&[UNIT, 20, 7, 6], parts.as_flattened()].concat());
    let answer = bytes(&ask(board, &request));
    let records = answer.get(5..).unwrap_or_default();
    let whole = records.as_chunks::<SECOND_BYTES>().0.iter();
    whole.filter_map(Second::from_bytes).collect()
}

/// FAULT is the last of the lamps.
fn fault_is_on(second: &Second) -> bool {
    second.lamps >> (2 * (LAMP_NAMES.len() - 1)) & 3 == 1
}

#[test]
fn a_master_that_was_away_reads_the_seconds_that_it_has_missed() {
    let mut scenario = scenario(60.0);
    let mut fault = Fault::percent("Rs", 50.0, MotorFrame::RotorFlux).expect("a known fault");
    (fault.from_s, fault.to_s) = (1.5, 3.5);
    scenario.faults = vec![fault];
    let mut board = board_of(&scenario);
    board.run(LAMP_TEST_S + 6.2).expect("a run");
    let newest = Master::new(UNIT).long(&mut board, Field::LastSecond);
    assert!((6..=7).contains(&newest), "{newest}");
    let seconds = read_seconds(&mut board, 1, 6);
    let numbers: Vec<u32> = seconds.iter().map(|second| second.number).collect();
    assert_eq!(numbers, [1, 2, 3, 4, 5, 6]);
    let lit: Vec<bool> = seconds.iter().map(fault_is_on).collect();
    assert_eq!(lit, [false, true, true, true, false, false]);
    // The last second before the fault against what the host makes of the same samples: a block may lie on either side.
    let reports = host_reports(board.taken());
    let quiet = |report: &&Report| (3_000..12_000).contains(&report.sample_index);
    let volts: Vec<f32> = reports
        .iter()
        .filter(quiet)
        .filter_map(|report| report.window.as_ref())
        .map(|window| monitor::magnitude(window.u_s.positive) / 2_f32.sqrt())
        .collect();
    let mean = volts.iter().sum::<f32>() / volts.len() as f32;
    let first = &seconds[0];
    assert!(
        (first.voltage_volt / mean - 1.0).abs() < 1e-3,
        "{first:?} {mean}"
    );
    assert!(
        seconds
            .iter()
            .skip(1)
            .all(|second| second.windows.abs_diff(60) <= 1),
        "60 Hz: {seconds:?}"
    );
    board.reset(Cause::Watchdog).expect("a reset");
    board.run(LAMP_TEST_S + 1.6).expect("a run");
    let again = read_seconds(&mut board, 1, 1);
    let start = Master::new(UNIT).long(&mut board, Field::StartNumber);
    let starts: Vec<u32> = again.iter().map(|second| second.start).collect();
    assert_eq!(starts, [start]);
    assert!(start > first.start, "another run has another number");
}
