//! Motors of which nothing is known but the plate: the healthy ones stay dark, and what they can show is shown.
//!
//! `CASES=608 cargo test -p drivemon --release --test recorders plate_only -- --nocapture` is the full run of docs/first-steps.md.

use std::path::Path;

use audit::{Expectation, audit};
use monitor::Monitor;
use motor::MotorFile;
use nameplate::plate::PlateFile;
use nameplate::{Estimate, Plate, catalogue, motor_text};
use recording::Recording;
use replay::{Samples, VerdictState};
use scenario::Scenario;
use scenario::simulate::record;

/// The catalogue motors that a circuit meets: what they are, and what a plate says of them.
fn motors() -> Vec<(MotorFile, MotorFile)> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../nameplate/data/motors.csv");
    let (_, rows) = catalogue::read(std::fs::File::open(path).unwrap()).unwrap();
    rows.iter()
        .filter_map(|row| {
            let full = row.plate.clone().unwrap();
            let truth = Estimate::of(&full).unwrap();
            let bare = Plate {
                breakdown_torque_ratio: None,
                locked_rotor_torque_ratio: None,
                locked_rotor_current_ratio: None,
                ..full
            };
            let known = Estimate::of(&bare).unwrap();
            (truth.fit.worst < 0.05).then(|| (file(&full, &truth), file(&bare, &known)))
        })
        .collect()
}

fn file(plate: &Plate, estimate: &Estimate) -> MotorFile {
    let plate = PlateFile {
        plate: *plate,
        ..PlateFile::default()
    };
    MotorFile::parse(&motor_text(&plate, estimate).unwrap(), "motor.toml").unwrap()
}

/// The true motor at a load, as a recorder of 12 bits and 0.2 % noise shows it.
fn recorded(motor: &MotorFile, number: usize, fault: &str) -> Recording {
    let folder =
        Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("plate-only-{number}-{}", fault.len()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("motor.toml"), motor.to_toml()).unwrap();
    let text = format!(
        "motor = \"motor.toml\"\nstart = \"running\"\nduration_s = 1.5\nseed = {number}\n[load]\nfriction_percent = 0\n\
         active = true\nconstant_percent = {}\n[sensors]\nnoise_sigma_fraction_of_full_scale = 0.002\ntorque = {}\n{fault}",
        (number * 37) % 111,
        number.is_multiple_of(2),
    );
    let scenario = Scenario::parse(&text, "scenario.toml", &folder)
        .unwrap_or_else(|error| panic!("{error}\n{text}"));
    let recording = record(&scenario, |_| {}).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    recording
}

fn state(recording: &Recording, motor: &MotorFile) -> (bool, VerdictState) {
    let audit = audit(recording, &Expectation::from(motor));
    let monitor = Monitor::new(replay::config_for(motor, recording).unwrap()).unwrap();
    let timeline = replay::replay(&monitor, &Samples::new(recording, &audit), &mut |_| {});
    (audit.supported, timeline.verdict(&[]).state)
}

#[test]
fn healthy_motors_known_by_their_plate_stay_dark() {
    let cases = std::env::var("CASES").ok().and_then(|n| n.parse().ok());
    let motors = motors();
    let (mut healthy, mut not_judged, mut lit) = (0, 0, Vec::new());
    for number in 0..cases.unwrap_or(30) {
        // A stride that visits all sizes and makers.
        let (truth, known) = &motors[number * 61 % motors.len()];
        let (supported, state) = state(&recorded(truth, number, ""), known);
        match state {
            VerdictState::Healthy => healthy += 1,
            VerdictState::Fault => lit.push(format!("{number} {} {supported}", known.name)),
            _ => not_judged += 1,
        }
    }
    println!(
        "{} motors: healthy {healthy}, not judged {not_judged}, FAULT {}",
        motors.len(),
        lit.len()
    );
    assert!(lit.is_empty(), "{lit:#?}");
    assert!(healthy > 9 * not_judged, "{healthy} {not_judged}");
}

/// Dark only where the plate leaves it open: a dead channel needs no parameters.
#[test]
fn a_dead_channel_is_seen_by_the_plate_alone() {
    let motors = motors();
    let seen = (0..8).filter(|number| {
        let (truth, known) = &motors[number * 61 % motors.len()];
        let fault = "[[faults]]\nfault = \"vb\"\ndead = true\nfrom_s = 0.7\n";
        state(&recorded(truth, *number, fault), known).1 == VerdictState::Fault
    });
    assert_eq!(seen.count(), 8);
}
