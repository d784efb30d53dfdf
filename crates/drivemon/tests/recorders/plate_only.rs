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
    let text = format!(
        "motor = \"motor.toml\"\nstart = \"running\"\nduration_s = 1.5\nseed = {number}\n[load]\nfriction_percent = 0\n\
         active = true\nconstant_percent = {}\n[sensors]\nnoise_sigma_fraction_of_full_scale = 0.002\ntorque = {}\n{fault}",
        (number * 37) % 111,
        number.is_multiple_of(2),
    );
    simulated(
        motor,
        &format!("plate-only-{number}-{}", fault.len()),
        &text,
    )
}

fn simulated(motor: &MotorFile, name: &str, text: &str) -> Recording {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("motor.toml"), motor.to_toml()).unwrap();
    let scenario = Scenario::parse(text, "scenario.toml", &folder)
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

/// Load, percent, and the supply's unbalance, degrees, of recordings that follow one at 70 % and 20 degrees.
const LATER: [[f64; 2]; 3] = [[70.0, 200.0], [5.0, 110.0], [100.0, 290.0]];

/// One recording in good order leaves open what the same motor draws of another unbalance, and how much of its losses it took for resistance.
#[test]
fn a_motor_known_by_its_plate_and_one_recording_is_healthy_on_another_supply() {
    let motors = motors();
    let kilowatt = |motor: &MotorFile| motor.nameplate.power_watt / 1000.0;
    // Large cages, whose bars are deep, and small motors, whose iron takes much.
    let one_of = |size: f64| {
        let is_so = |(truth, _): &&(MotorFile, MotorFile)| kilowatt(truth) == size;
        motors.iter().find(is_so).expect("in the catalogues")
    };
    let mut accused_without = 0;
    for (truth, known) in [3.0, 18.5, 45.0, 90.0].map(one_of) {
        let recorded = |[load, angle]: [f64; 2], seconds: f64, fault: &str| {
            let text = format!(
                "motor = \"motor.toml\"\nstart = \"running\"\nduration_s = {seconds}\nsample_rate_hz = 5000\nseed = {angle}\n[supply]\nunbalance_percent = 0.8\n\
                 unbalance_angle_deg = {angle}\n[load]\nfriction_percent = 0\nactive = true\nconstant_percent = {load}\n[sensors]\n\
                 noise_sigma_fraction_of_full_scale = 0.001\n{fault}",
            );
            let name = format!("plate-supply-{}-{angle}-{}", kilowatt(truth), fault.len());
            simulated(truth, &name, &text)
        };
        let healthy = recorded([70.0, 20.0], 4.0, "");
        let learnt = replay::check::learn(known, &[&healthy], &mut |_, _| ());
        let mut sure = learnt.motor.clone();
        let settings = sure.healthy.as_mut().expect("calibrated");
        settings.negative_drop_percent = [0.0; 2];
        settings.negative_impedance_percent = 10.0;
        settings.iron_loss_percent = 0.0;
        for at in LATER {
            let later = recorded(at, 1.5, "");
            let (_, told) = state(&later, &learnt.motor);
            assert_eq!(told, VerdictState::Healthy, "{} {at:?}", known.name);
            accused_without += u32::from(state(&later, &sure).1 == VerdictState::Fault);
        }
        // What both have in common is in no doubt: on the same supply a joint shows.
        let joint = "[[faults]]\nfault = \"Rsb\"\nchange_percent = 500\n";
        let same = recorded([70.0, 20.0], 1.5, joint);
        assert_eq!(
            state(&same, &learnt.motor).1,
            VerdictState::Fault,
            "{}",
            known.name
        );
    }
    assert!(
        accused_without > 0,
        "a calibration that is surer accuses no healthy motor"
    );
}
