//! Boards of the documented parts, calibrated as the pages say, behind healthy motors anywhere: no FAULT is right.

use std::error::Error;

use crate::installed::{Conditions, DEGC, Installed, WARMTH, between, random_of};
use crate::judge::raw;
use campaign::T_SAMPLE_S;
use monitor::{Lamp, Monitor, MonitorConfig, MonitorState, RawSample};
use motor::MotorFile;
use rand::Rng;

/// Loads, shares of rated torque.
const LOAD: [f64; 2] = [0.25, 1.3];
/// Frequencies, Hz, at a voltage in proportion.
const HERTZ: [f64; 2] = [45.0, 60.0];
/// Conditions at which each board is judged, and for how long, s.
pub const CONDITIONS: usize = 3;
const JUDGED_S: f64 = 1.0;

/// What became of a board.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outcome {
    /// Whether the calibration refused its recordings.
    pub refused: bool,
    /// Conditions with FAULT of the calibrated motor.
    pub faults: usize,
    /// Conditions with SENSOR.
    pub sensors: usize,
    /// Conditions with FAULT by the motor file's thresholds.
    pub faults_uncalibrated: usize,
    /// Windows that the calibrated motor's monitor judged.
    pub windows: usize,
}

/// Draws board number `k`, calibrates it, and judges a healthy motor behind it.
///
/// # Errors
/// Motor files or conditions that cannot be simulated.
pub fn judged(motors: &[MotorFile], seed: u64, k: u64) -> Result<Outcome, Box<dyn Error>> {
    let mut random = random_of(seed, k);
    let plant = &motors[random.random_range(0..motors.len())];
    let installed = Installed::draw(plant, &mut random);
    let Some(calibrated) = installed.calibrated(&mut random, k)? else {
        return Ok(Outcome {
            refused: true,
            ..Outcome::default()
        });
    };
    let mut outcome = Outcome::default();
    for _ in 0..CONDITIONS {
        let at = Conditions {
            load: between(LOAD, &mut random),
            hertz: between(HERTZ, &mut random),
            warmth: between(WARMTH, &mut random),
            degc: between(DEGC, &mut random),
        };
        let simulation = installed.simulation(&at, JUDGED_S, random.random())?;
        let samples: Vec<_> = simulation.map(|sample| raw(&sample.measured)).collect();
        let [fault, sensor, windows] = lit(&calibrated, &samples)?;
        outcome.faults += usize::from(fault > 0);
        outcome.sensors += usize::from(sensor > 0);
        outcome.windows += windows;
        let [fault, ..] = lit(&installed.told, &samples)?;
        outcome.faults_uncalibrated += usize::from(fault > 0);
    }
    Ok(outcome)
}

/// Windows with FAULT, with SENSOR, and windows judged.
fn lit(motor: &MotorFile, samples: &[RawSample]) -> Result<[usize; 3], Box<dyn Error>> {
    let config = MonitorConfig::from_motor_file(motor, T_SAMPLE_S)?;
    let monitor = Monitor::new(config)?;
    let mut state = MonitorState::default();
    let mut counted = [0; 3];
    for sample in samples {
        if let Some(report) = monitor.update_raw(&mut state, sample) {
            let is = [
                report.lamps.fault == Lamp::On,
                report.lamps.sensor == Lamp::On,
                report.not_judged.is_none(),
            ];
            counted
                .iter_mut()
                .zip(is)
                .for_each(|(n, is)| *n += usize::from(is));
        }
    }
    Ok(counted)
}
