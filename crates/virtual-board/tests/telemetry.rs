//! The frames that the firmware sends hold, bit for bit, the residuals that the host computes from the same samples.

mod common;

use board::{Frame, LAMP_NAMES, Message, Shown};
use common::{INHIBITED, LAMP_TEST_S, board as board_of, motor, scenario};
use monitor::{Monitor, MonitorConfig, MonitorState, Report};
use motor::motor_file::Frame as MotorFrame;
use scenario::{Fault, Start};

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
