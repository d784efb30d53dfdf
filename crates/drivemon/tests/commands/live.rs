//! `drivemon monitor --serial` on a pseudo-terminal, as a real port would be.
#![cfg(unix)]

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output};
use std::time::Duration;

use crate::common::{drivemon, stderr};
use board::{CAPTURE_EVERY, Capture, CaptureAlarm, Frame, MAX_FRAME_BYTES, MotorImage, Shown};
use monitor::{BOARD_CONVERSIONS, Monitor, MonitorConfig, MonitorState, RawSample};
use motor::MotorFile;
use motor::motor_file::Frame as MotorFrame;
use scenario::simulate::Simulation;
use scenario::{Fault, Scenario, SignalChain};
use serialport::{SerialPort, TTYPort};

fn motor_path() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../motors/assumed-300w.toml");
    path.display().to_string()
}

fn codes(scenario: &Scenario) -> impl Iterator<Item = RawSample> {
    let simulation = Simulation::new(scenario).expect("a scenario that runs");
    simulation.map(|sample| RawSample {
        voltage_codes: sample.measured.voltage_codes,
        current_codes: sample.measured.current_codes,
        encoder_count: sample.measured.encoder_count,
        ..RawSample::default()
    })
}

/// What the board sends about a stator that heats after half a second: frames, and the samples around the alarm.
fn sent(seconds: f64) -> Vec<u8> {
    let motor = MotorFile::read(motor_path()).expect("a shipped motor file");
    let config = MonitorConfig::of_board(&motor).expect("shipped");
    let image = MotorImage::new(&config);
    let monitor = Monitor::new(config).expect("a valid configuration");
    let mut scenario = Scenario::of(motor, seconds);
    // The board's samples are sums of so many conversions.
    scenario.sensors.chain = Some(SignalChain {
        conversions: u32::from(BOARD_CONVERSIONS),
        ..SignalChain::default()
    });
    let fault = Fault::percent("Rs", 50.0, MotorFrame::RotorFlux).expect("a known fault");
    scenario.faults = vec![Fault {
        from_s: 0.5,
        ..fault
    }];
    let (mut state, mut capture, mut bytes) = (MonitorState::default(), Capture::new(), Vec::new());
    let mut sequence = 0;
    for (k, raw) in codes(&scenario).enumerate() {
        if k % CAPTURE_EVERY == 0 {
            capture.push(&raw);
        }
        if let Some(report) = monitor.update_raw(&mut state, &raw) {
            if report.lamps.fault == monitor::Lamp::On {
                capture.alarm(CaptureAlarm {
                    start: 0,
                    second: 0,
                    motor: image.identification(),
                });
            }
            let frame = Frame::new(&report, &Shown::only(report.lamps), sequence, 3_300);
            sequence += 1;
            bytes.extend(frame.encode(&mut [0; MAX_FRAME_BYTES]));
            if let Some(piece) = capture.next_chunk(image.identification()) {
                bytes.extend(piece.encode(&mut [0; MAX_FRAME_BYTES]));
            }
        }
    }
    bytes
}

/// Runs drivemon on one end while `bytes` go into the other.
fn watch(bytes: Vec<u8>, more: &[&str]) -> Output {
    let (mut board, host) = TTYPort::pair().expect("a pseudo-terminal");
    let port = host.name().expect("a name");
    let writer = std::thread::spawn(move || {
        for piece in bytes.chunks(512) {
            // The reader may have seen enough.
            if board.write_all(piece).is_err() {
                break;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_secs(2));
    });
    let output = Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .args(["monitor", "--serial", &port])
        .args(more)
        .output()
        .expect("drivemon runs");
    writer.join().expect("a writer");
    drop(host);
    output
}

#[test]
fn lamps_are_shown_and_a_lit_fault_is_the_exit_code() {
    let output = watch(sent(1.0), &["--for", "2"]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}\n{output:?}");
    assert!(said.contains("FAULT was lit"), "{said}");
    assert!(said.lines().any(|line| line.contains('●')), "{said}");
}

#[test]
fn the_samples_around_an_alarm_go_straight_into_compare() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let file = folder.join("alarm.csv").display().to_string();
    // 160 pieces, one per window of 60 Hz, from 0.9 s on.
    let output = watch(sent(4.0), &["--motor", &motor_path(), "--capture", &file]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        said.contains("640 samples around the alarm"),
        "{said}\n{output:?}"
    );
    let compared = Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .args(["compare", &file, "--motor", &motor_path()])
        .output()
        .expect("drivemon runs");
    let said = String::from_utf8_lossy(&compared.stdout).into_owned();
    // Half of it lies behind the alarm: the model does not fit a stator of 1.5 times the resistance.
    assert_eq!(compared.status.code(), Some(1), "{said}\n{compared:?}");
}

#[test]
fn another_motors_file_is_refused() {
    let other = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../motors/peer-2k2.toml");
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("other.csv");
    let (other, file) = (other.display().to_string(), file.display().to_string());
    let output = watch(sent(4.0), &["--motor", &other, "--capture", &file]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("other motor constants"));
}

#[test]
fn silence_and_rubbish_are_told_apart() {
    let silent = watch(Vec::new(), &[]);
    assert_eq!(silent.status.code(), Some(3), "{silent:?}");
    assert!(String::from_utf8_lossy(&silent.stderr).contains("no frame came"));
    let rubbish = watch([1, 2, 3, 0].repeat(50), &[]);
    assert_eq!(rubbish.status.code(), Some(3), "{rubbish:?}");
    assert!(String::from_utf8_lossy(&rubbish.stderr).contains("--baud"));
}

#[test]
fn a_port_that_does_not_exist_is_an_error_with_a_remedy() {
    let output = drivemon(&["monitor", "--serial", "/dev/no-such-port"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let said = stderr(&output);
    assert!(
        said.contains("/dev/no-such-port") && said.contains("; "),
        "{said}"
    );
}

#[test]
fn a_page_is_refused_with_the_way_to_get_one() {
    let output = drivemon(&[
        "monitor",
        "--serial",
        "/dev/no-such-port",
        "--report",
        "x.html",
    ]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let said = stderr(&output);
    assert!(
        said.contains("--report") && said.contains("--capture"),
        "{said}"
    );
}
