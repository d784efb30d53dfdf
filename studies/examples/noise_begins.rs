//! How often FAULT lights where channels of a healthy motor become noisy from one sample to the next.
//!
//! `cargo run --release -p studies --example noise_begins` prints the counts of docs/limits.md: calibrated motors at several loads, whose
//! noise is small for five seconds and then ten to twenty times as large for four; seen by a board with an encoder that knows no load, and
//! by a recorder whose tachometer and torque transducer become noisy too.

use campaign::T_SAMPLE_S;
use monitor::{
    ClippedChannels, Lamp, Monitor, MonitorConfig, MonitorState, RawSample, Sample, SpeedSample,
};
use motor::MotorFile;
use motor::motor_file::LoadKind;
use rayon::prelude::*;
use scenario::simulate::{Measured, Simulation};
use scenario::{LoadSpec, Scenario, SensorSpec, SpeedSensor};
use std::error::Error;

const MOTORS: [&str; 3] = ["assumed-300w", "peer-2k2", "chalmers-4kw"];
/// Standard deviations before and after, shares of full scale.
const NOISES: [[f64; 2]; 3] = [[0.0005, 0.01], [0.001, 0.02], [0.002, 0.02]];
/// Loads, shares of rated torque, each with a noise of its own: 0.37 to 1.14.
const LOADS: u64 = 12;
/// Instruments: a board's, or a recorder's.
const SEEN_BY: [(&str, bool); 2] = [("board", false), ("recorder", true)];
const NOISY_FROM_S: f64 = 5.0;
const JUDGED_S: f64 = 9.0;

fn main() -> Result<(), Box<dyn Error>> {
    println!("| seen by | motor | noise, % of full scale | FAULT before | FAULT after |");
    println!("|---|---|---|---|---|");
    for (seen_by, recorded) in SEEN_BY {
        let mut after = 0;
        for name in MOTORS {
            for noises in NOISES {
                after += row((seen_by, recorded), name, noises)?;
            }
        }
        let all = MOTORS.len() * NOISES.len() * LOADS as usize;
        println!("| {seen_by} | all | | | {after} of {all} |");
    }
    Ok(())
}

/// Prints one row, and gives how often FAULT lights after the noise has begun.
fn row(
    (seen_by, recorded): (&str, bool),
    name: &str,
    noises: [f64; 2],
) -> Result<usize, Box<dyn Error>> {
    let plant = shipped(name)?;
    let calibrated = shipped(&format!("{name}-calibrated"))?;
    let one = |seed| {
        let lit = lit(&plant, &calibrated, recorded, noises, seed);
        lit.map_err(|error| error.to_string())
    };
    let all: Result<Vec<[bool; 2]>, String> = (1..=LOADS).into_par_iter().map(one).collect();
    let all = all?;
    let count = |k: usize| all.iter().filter(|lit| lit[k]).count();
    let [quiet, noisy] = noises.map(|share| 100.0 * share);
    let (before, after) = (count(0), count(1));
    println!(
        "| {seen_by} | {name} | {quiet} to {noisy} | {before} of {LOADS} | {after} of {LOADS} |"
    );
    Ok(after)
}

/// Whether FAULT lights before and after the noise begins.
fn lit(
    plant: &MotorFile,
    calibrated: &MotorFile,
    recorded: bool,
    noises: [f64; 2],
    seed: u64,
) -> Result<[bool; 2], Box<dyn Error>> {
    let simulated = |noise| Simulation::new(&scenario(plant, recorded, noise, seed));
    let [quiet, noisy] = noises.map(simulated);
    let told = without_friction(calibrated, recorded);
    let monitor = Monitor::new(MonitorConfig::from_motor_file(&told, T_SAMPLE_S)?)?;
    let mut state = MonitorState::default();
    let mut lit = [false; 2];
    // The same motor twice: only what its instruments add differs.
    for (quiet, noisy) in quiet?.zip(noisy?) {
        let begun = quiet.t >= NOISY_FROM_S;
        let sample = if begun { noisy } else { quiet };
        let shown = shown(&monitor, &sample.measured, recorded);
        let report = monitor.update(&mut state, &shown);
        lit[usize::from(begun)] |= report.is_some_and(|report| report.lamps.fault == Lamp::On);
    }
    Ok(lit)
}

/// The motor with a load that is measured, or that nobody knows.
fn without_friction(motor: &MotorFile, measured: bool) -> MotorFile {
    let mut motor = motor.clone();
    motor.load = match measured {
        true => LoadKind::Measured,
        false => LoadKind::Free,
    };
    motor.mechanics.load_friction = 0.0;
    motor
}

fn scenario(plant: &MotorFile, recorded: bool, noise: f64, seed: u64) -> Scenario {
    let mut motor = without_friction(plant, recorded);
    motor.sensors.noise_sigma_fraction_of_full_scale = noise;
    let torque = (0.3 + 0.07 * seed as f64) * motor.nameplate.torque_nm;
    Scenario {
        seed,
        load: LoadSpec::constant(torque, true),
        sensors: SensorSpec {
            speed: match recorded {
                true => SpeedSensor::Tachometer,
                false => SpeedSensor::Encoder,
            },
            ..SensorSpec::of(&motor)
        },
        ..Scenario::of(motor, JUDGED_S)
    }
}

/// What the core gets.
fn shown(monitor: &Monitor, measured: &Measured, recorded: bool) -> Sample {
    let raw = RawSample {
        voltage_codes: measured.voltage_codes,
        current_codes: measured.current_codes,
        encoder_count: measured.encoder_count,
        clipped: ClippedChannels::of(measured.clipped),
    };
    let board = monitor.config().converter.convert(&raw);
    match recorded {
        true => Sample {
            speed: SpeedSample::RadPerSecond(measured.omega_mech as f32),
            tau_load: Some(measured.tau_load as f32),
            ..board
        },
        false => board,
    }
}

/// A shipped motor file.
fn shipped(name: &str) -> Result<MotorFile, Box<dyn Error>> {
    let path = format!("{}/../motors/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    Ok(MotorFile::read(path)?)
}
