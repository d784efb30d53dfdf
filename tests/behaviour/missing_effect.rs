//! A missing effect lights lamps; adopted, it leaves them dark, and a real fault still lights.

use crate::common::motor;
use monitor::{Monitor, MonitorConfig, MonitorState, RawSample, Report};
use motor::MotorFile;
use motor::motor_file::{EffectEntry, Frame};
use scenario::simulate::Simulation;
use scenario::{Fault, Scenario};

/// An iron loss of 54 W, a sixth of the rated power, as a motor file writes it.
fn core_loss() -> EffectEntry {
    EffectEntry::with_numbers("core-loss", [("core_loss_resistance_ohm", 900.0)])
}

/// The last report on a motor, watched by a monitor that believes in another one.
fn watch(plant: &MotorFile, believed: &MotorFile, faults: Vec<Fault>) -> Report {
    let scenario = Scenario {
        faults,
        ..Scenario::of(plant.clone(), 1.0)
    };
    let config = MonitorConfig::from_motor_file(believed, scenario.t_sample()).expect("valid");
    let monitor = Monitor::new(config).expect("valid");
    let mut state = MonitorState::default();
    let mut last = Report::default();
    for sample in Simulation::new(&scenario).expect("the motor runs") {
        let raw = RawSample {
            voltage_codes: sample.measured.voltage_codes,
            current_codes: sample.measured.current_codes,
            encoder_count: sample.measured.encoder_count,
            ..RawSample::default()
        };
        last = monitor.update_raw(&mut state, &raw).unwrap_or(last);
    }
    last
}

fn without_effects(file: &MotorFile) -> MotorFile {
    MotorFile {
        effects: Vec::new(),
        ..file.clone()
    }
}

#[test]
fn an_adopted_effect_puts_the_lamps_out_and_leaves_real_faults_lit() {
    let mut plant = motor("motors/assumed-300w.toml");
    plant.sensors.noise_sigma_fraction_of_full_scale = 0.002;
    plant.effects = vec![core_loss()];
    let unaware = watch(&plant, &without_effects(&plant), Vec::new());
    assert!(
        !unaware.lamps.is_quiet(),
        "the missing effect lights nothing: {:?}",
        unaware.normalised
    );
    let aware = watch(&plant, &plant, Vec::new());
    assert!(aware.lamps.is_quiet(), "{:?}", aware.normalised);
    let fault = Fault::percent("Rs", 50.0, Frame::RotorFlux).expect("a row of the table");
    let faulty = watch(&plant, &plant, vec![fault]);
    assert_eq!(
        faulty.lamps.pattern(),
        [true, false, false, true],
        "{:?}",
        faulty.normalised
    );
}
