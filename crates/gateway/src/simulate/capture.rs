//! The samples around an alarm of a simulated board: those of a simulated motor with that fault, through the instruments that a
//! board has.

use board::{CAPTURE_EVERY, CAPTURE_INSTANTS, Capture, CaptureAlarm, MotorImage};
use document::FileError;
use monitor::{MonitorConfig, RawSample};
use motor::motor_file::Frame;
use motor::{FaultId, MotorFile};
use scenario::simulate::{Simulation, SimulationError};
use scenario::{Fault, Probe, Scenario, SignalChain, Target};

/// The motor of every recording: the assumed one of the published bench.
pub const MOTOR_FILE: &str = include_str!("../../../../motors/assumed-300w.toml");
/// Name under which it is written beside a configuration.
pub const MOTOR_FILE_NAME: &str = "simulated-motor.toml";

/// Change of the parameter, or gain of the sensor, that fails, percent.
const CHANGE_PERCENT: f64 = 50.0;
const SENSOR_PERCENT: f64 = 10.0;
/// Noise of every channel, standard deviation as a share of full scale.
const NOISE: f64 = 0.002;
/// Conversions that a board adds to one sample.
const CONVERSIONS: u32 = 16;
/// What a motor that begins in steady state takes until nothing changes any more, s.
const SETTLING_S: f64 = 0.5;
/// Sampling time of a board, s.
const T_SAMPLE: f64 = 1e-4;
/// The second half lies behind the alarm.
const BEFORE: usize = CAPTURE_INSTANTS / 2;

/// Why there are no samples.
#[derive(Debug, thiserror::Error)]
pub enum CaptureError {
    /// The motor file.
    #[error(transparent)]
    File(#[from] FileError),
    /// The simulation.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
}

/// Takes the samples around the alarm of a fault, by its number, into a board's ring. A ring that is not armed stays as it is.
pub(super) fn record(
    capture: &mut Capture,
    fault: FaultId,
    seed: u64,
    (start, second): (u32, u32),
) -> Result<(), CaptureError> {
    let motor = MotorFile::parse(MOTOR_FILE, MOTOR_FILE_NAME)?;
    let constants = MotorImage::new(&MonitorConfig::of_board(&motor)?).identification();
    let samples = samples(motor, fault, seed)?;
    for (k, sample) in samples.iter().enumerate() {
        if k == BEFORE {
            capture.alarm(CaptureAlarm {
                start,
                second,
                motor: constants,
            });
        }
        capture.push(sample);
    }
    Ok(())
}

fn samples(
    mut motor: MotorFile,
    fault: FaultId,
    seed: u64,
) -> Result<Vec<RawSample>, CaptureError> {
    motor.sensors.noise_sigma_fraction_of_full_scale = NOISE;
    let length_s = (CAPTURE_INSTANTS * CAPTURE_EVERY) as f64 * T_SAMPLE;
    let mut scenario = Scenario::of(motor, SETTLING_S + length_s);
    scenario.seed = seed;
    scenario.faults = faults(fault);
    scenario.sensors.chain = Some(SignalChain {
        conversions: CONVERSIONS,
        ..SignalChain::default()
    });
    let taken = Simulation::new(&scenario)?;
    let all: Vec<RawSample> = taken
        .map(|sample| RawSample {
            voltage_codes: sample.measured.voltage_codes,
            current_codes: sample.measured.current_codes,
            encoder_count: sample.measured.encoder_count,
            ..RawSample::default()
        })
        .collect();
    let settled = all.len().saturating_sub(CAPTURE_INSTANTS * CAPTURE_EVERY);
    Ok(all
        .into_iter()
        .skip(settled)
        .step_by(CAPTURE_EVERY)
        .collect())
}

/// What fails in the motor or its instruments. A sensor of the published bench is one behind the d-q transformation: here its three
/// probes fail together.
fn faults(fault: FaultId) -> Vec<Fault> {
    let probes = |probe: fn(usize) -> Probe| {
        let of = |phase| Fault::of(Target::Probe(probe(phase)), SENSOR_PERCENT);
        (0..3).map(of).collect()
    };
    match fault {
        FaultId::CurrentSensor => probes(Probe::Current),
        FaultId::VoltageSensor => probes(Probe::Voltage),
        FaultId::SpeedSensor => vec![Fault::of(Target::Probe(Probe::Speed), SENSOR_PERCENT)],
        _ => Target::of(fault, Frame::RotorFlux)
            .map(|target| Fault::of(target, CHANGE_PERCENT))
            .into_iter()
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use board::CaptureState;

    #[test]
    fn every_fault_that_a_life_may_have_gives_a_whole_recording() {
        let mut seen = Vec::new();
        for fault in FaultId::ALL {
            if fault.published_pattern().is_none() {
                continue;
            }
            let mut capture = Capture::new();
            record(&mut capture, fault, 3, (1, 2)).expect("simulated");
            assert_eq!(capture.state(), CaptureState::Complete, "{fault:?}");
            let mut bytes = [0; board::CAPTURE_BYTES];
            assert!(capture.read(0, &mut bytes));
            assert!(!seen.contains(&bytes), "{fault:?} is as another one");
            seen.push(bytes);
        }
        assert!(seen.len() >= 7);
    }
}
