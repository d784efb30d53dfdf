//! A whole experiment as a recording.

use super::instruments::shown;
use super::plant::effects;
use super::{SimSample, Simulation, SimulationError};
use crate::{Scenario, SpeedSensor, Start};
use motor::motor_file::LoadKind;
use recording::{
    Channel, LoadTorque, Metadata, Recording, Sensors, StartsFrom, Supply, VoltageKind,
};

/// Why there is no recording.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The scenario cannot be run.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The samples do not make a recording (fewer than two).
    #[error(transparent)]
    Recording(#[from] recording::Error),
}

/// Runs a scenario and keeps what its instruments showed; `progress` is told the share done, 0..=1.
///
/// # Errors
/// A scenario that cannot be run, or that leaves fewer than two samples.
pub fn record(
    scenario: &Scenario,
    mut progress: impl FnMut(f64),
) -> Result<Recording, RecordError> {
    let effects = effects::of_instruments(scenario)?;
    let samples = Simulation::inside(scenario)?
        .enumerate()
        .map(|(k, sample)| {
            if k % 10_000 == 0 {
                progress(sample.t / scenario.duration_s);
            }
            sample
        });
    let mut columns = Columns::default();
    if effects.is_empty() {
        samples.for_each(|sample| columns.push(&sample));
    } else {
        let shown = shown(scenario, &effects, samples.collect())?;
        shown.iter().for_each(|sample| columns.push(sample));
    }
    progress(1.0);
    columns.into_recording(scenario)
}

#[derive(Default)]
struct Columns {
    t: Vec<f64>,
    u: [Vec<f64>; 3],
    i: [Vec<f64>; 3],
    speed: Vec<f64>,
    torque: Vec<f64>,
}

impl Columns {
    fn push(&mut self, sample: &SimSample) {
        let shown = &sample.measured;
        self.t.push(sample.t);
        for k in 0..3 {
            self.u[k].push(shown.u_s_abc[k]);
            self.i[k].push(shown.i_s_abc[k]);
        }
        self.speed.push(shown.omega_mech);
        self.torque.push(shown.tau_load);
    }

    fn into_recording(self, scenario: &Scenario) -> Result<Recording, RecordError> {
        let mut recording = Recording::new(&scenario.name, self.t, metadata(scenario))?;
        for (channel, values) in Channel::VOLTAGES.into_iter().zip(self.u) {
            recording = recording.with_channel(channel, values)?;
        }
        for (channel, values) in Channel::CURRENTS.into_iter().zip(self.i) {
            recording = recording.with_channel(channel, values)?;
        }
        if scenario.sensors.speed != SpeedSensor::None {
            recording = recording.with_channel(Channel::SPEED, self.speed)?;
        }
        if scenario.sensors.torque {
            recording = recording.with_channel(Channel::TORQUE, self.torque)?;
        }
        Ok(recording)
    }
}

fn metadata(scenario: &Scenario) -> Metadata {
    let belief = "simulated grid: see the scenario";
    Metadata {
        voltage: VoltageKind::Instantaneous,
        supply: Supply::Grid,
        supply_belief: format!("{belief} \"{}\"", scenario.name),
        load_torque: load_torque(scenario),
        starts_from: match scenario.start {
            _ if scenario.record_from_s > 0.0 => StartsFrom::Unknown,
            Start::Standstill => StartsFrom::Standstill,
            Start::Running => StartsFrom::Running,
        },
        sensors: sensors(scenario),
    }
}

fn load_torque(scenario: &Scenario) -> LoadTorque {
    if scenario.sensors.torque {
        return LoadTorque::Measured;
    }
    match scenario.motor.load {
        LoadKind::Friction if scenario.load.is_linear() => LoadTorque::Friction,
        _ => LoadTorque::Free,
    }
}

/// What the instruments declare of themselves; perfect ones have neither range nor steps.
fn sensors(scenario: &Scenario) -> Sensors {
    let own = &scenario.sensors.instrument;
    let declared = Sensors {
        noise_sigma_fraction_of_full_scale: Some(own.noise_sigma_fraction_of_full_scale),
        voltage_full_scale_volt: Some(own.voltage_full_scale_volt),
        current_full_scale_amp: Some(own.current_full_scale_amp),
        speed_full_scale_rad_s: Some(own.speed_full_scale_rad_s),
        torque_full_scale_nm: Some(own.torque_full_scale_nm),
        ..Sensors::default()
    };
    match scenario.sensors.quantise {
        true => Sensors {
            adc_bits: Some(own.adc_bits),
            ..declared
        },
        false => declared,
    }
}
