//! The main job on a simulated motor: every row of Table 1 through the board's core.

mod case;
mod matrix;
mod print;

pub use case::{Case, CaseResult};
pub use matrix::{FaultMatrix, FaultRow, HealthyRow};

use motor::FileError;
use motor::MotorFile;
use motor::motor_file::{FieldCurrent, Frame};
use schemars::JsonSchema;
use serde::Serialize;

use scenario::PlantKind;
use scenario::simulate::SimulationError;

/// The assumed motor of the published bench.
///
/// # Errors
/// None as long as the shipped motor file is valid, which its tests hold.
pub fn assumed_motor() -> Result<MotorFile, FileError> {
    let text = include_str!("../../../motors/assumed-300w.toml");
    MotorFile::parse(text, "motors/assumed-300w.toml")
}

/// Loads at which the healthy motor is shown, percent of the motor file's friction torque.
const LOADS_PERCENT: [f64; 4] = [10.0, 50.0, 100.0, 150.0];
/// Noise of every channel, standard deviation as a share of full scale, where the motor file states none.
const NOISE: f64 = 0.002;

/// Everything that the demonstration measured.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Demo {
    /// Name of the motor file.
    pub motor: String,
    /// Standard deviation of the noise on voltages and currents, share of full scale.
    pub noise_sigma_fraction_of_full_scale: f64,
    /// Resolution of voltages and currents.
    pub adc_bits: u32,
    /// Seed of the noise.
    pub seed: u64,
    /// The one set of thresholds, percent of each residual's scale.
    pub threshold_percent: [f64; 4],
    /// Table 1, measured on each plant and in each frame.
    pub matrices: Vec<FaultMatrix>,
    /// The healthy motor at several loads in both frames.
    pub healthy: Vec<HealthyRow>,
}

/// Plant, frame and field current of each matrix; the first is the published experiment.
const MATRICES: [(PlantKind, Frame, FieldCurrent); 3] = [
    (PlantKind::Linear, Frame::Voltage, FieldCurrent::Nominal),
    (PlantKind::Full, Frame::RotorFlux, FieldCurrent::Live),
    (PlantKind::Full, Frame::Voltage, FieldCurrent::Live),
];

/// Number of experiments in a demonstration.
pub const EXPERIMENTS: usize = MATRICES.len() * matrix::CASES + 2 * LOADS_PERCENT.len();

/// Why there is nothing to show.
#[derive(Debug, thiserror::Error)]
pub enum DemoError {
    /// The experiment cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A value of the motor file lies outside the core's ranges.
    #[error(transparent)]
    Monitor(#[from] monitor::ConfigError),
    /// Effects of the motor file that the core cannot take.
    #[error(transparent)]
    Effects(#[from] motor::FileError),
}

/// Runs the demonstration on a motor; `progress` is called once after each experiment.
///
/// # Errors
/// A motor that cannot be simulated or monitored.
pub fn run(motor: &MotorFile, seed: u64, mut progress: impl FnMut()) -> Result<Demo, DemoError> {
    let mut motor = motor.clone();
    if motor.sensors.noise_sigma_fraction_of_full_scale == 0.0 {
        motor.sensors.noise_sigma_fraction_of_full_scale = NOISE;
    }
    let mut matrices = Vec::new();
    for (plant, frame, field) in MATRICES {
        let mut motor = motor.clone();
        motor.monitor.frame = frame;
        motor.monitor.field_current = field;
        matrices.push(FaultMatrix::measure(&motor, plant, seed, &mut progress)?);
    }
    let mut healthy = Vec::new();
    for load_percent in LOADS_PERCENT {
        for frame in [Frame::RotorFlux, Frame::Voltage] {
            healthy.push(HealthyRow::measure(&motor, load_percent, frame, seed)?);
            progress();
        }
    }
    Ok(Demo {
        motor: motor.name.clone(),
        noise_sigma_fraction_of_full_scale: motor.sensors.noise_sigma_fraction_of_full_scale,
        adc_bits: motor.sensors.adc_bits,
        seed,
        threshold_percent: motor.monitor.threshold_percent,
        matrices,
        healthy,
    })
}
