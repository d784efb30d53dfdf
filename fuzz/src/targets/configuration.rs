//! Files that people write: motor, scenario, campaign, sidecar.

use campaign::Plan;
use monitor::{Monitor, MonitorConfig};
use motor::MotorFile;
use recording::Sidecar;
use scenario::Scenario;
use scenario::simulate::Simulation;

use crate::seeds::root;

/// Instants of a scenario that are simulated.
const INSTANTS: usize = 20;

/// A motor file that is accepted makes a monitor or a reason against it, and is accepted again as it is written.
pub(crate) fn motor_file(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let motor = match MotorFile::parse(text, "m.toml") {
        Ok(motor) => motor,
        Err(error) => return assert!(error.to_string().contains("m.toml")),
    };
    match MonitorConfig::from_motor_file(&motor, 1e-4).map(Monitor::new) {
        Ok(Ok(_)) => {}
        Ok(Err(error)) => assert!(!error.to_string().is_empty()),
        Err(error) => assert!(error.to_string().contains("effects")),
    }
    let written = motor.to_toml();
    if let Err(error) = MotorFile::parse(&written, "again.toml") {
        panic!("{error}\n{written}");
    }
}

/// A scenario that is accepted runs, or says why not.
pub(crate) fn scenario(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    match Scenario::parse(text, "s.toml", &root().join("sim-host/scenarios")) {
        Ok(scenario) => {
            if let Ok(simulation) = Simulation::new(&scenario) {
                simulation.take(INSTANTS).for_each(drop);
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// A plan that is accepted can be counted, and its first and last runs exist.
pub(crate) fn campaign(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    match Plan::parse(text, "p.toml", &root().join("campaigns")) {
        Ok(plan) => {
            let runs = plan.runs();
            assert!(runs > 0);
            for index in [0, runs / 2, runs - 1] {
                assert!(plan.place(index).is_some(), "run {index} of {runs}");
            }
            assert!(plan.place(runs).is_none());
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// A sidecar is read, or refused by its name.
pub(crate) fn sidecar(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    if let Err(error) = Sidecar::parse(text, "x.toml") {
        assert!(error.to_string().contains("x.toml"), "{error}");
    }
}
