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
pub fn record(scenario: &Scenario, progress: impl FnMut(f64)) -> Result<Recording, RecordError> {
    Pieces::new(scenario, usize::MAX, progress)?.piece()
}

/// A scenario as consecutive pieces of a recording; the next one is simulated when it is asked for.
pub struct Pieces<'s> {
    scenario: &'s Scenario,
    samples: Samples,
    columns: Columns,
    rows: usize,
    is_done: bool,
    progress: Box<dyn FnMut(f64) + 's>,
}

/// Samples as the instruments show them.
type Samples = Box<dyn Iterator<Item = SimSample>>;

impl<'s> Pieces<'s> {
    /// Pieces of `rows` samples; the last is up to a thirtieth longer. Effects on the instruments need whole signals: where
    /// there are any, all samples are in memory. `progress` is told the share done, 0..=1.
    ///
    /// # Errors
    /// A scenario that cannot be run.
    pub fn new(
        scenario: &'s Scenario,
        rows: usize,
        progress: impl FnMut(f64) + 's,
    ) -> Result<Pieces<'s>, SimulationError> {
        let effects = effects::of_instruments(scenario)?;
        let simulated = Simulation::inside(scenario)?;
        let samples: Samples = match effects.is_empty() {
            true => Box::new(simulated),
            false => Box::new(shown(scenario, &effects, simulated.collect())?.into_iter()),
        };
        Ok(Pieces {
            scenario,
            samples,
            columns: Columns::default(),
            rows,
            is_done: false,
            progress: Box::new(progress),
        })
    }
}

impl Pieces<'_> {
    /// The next piece, or all that is left.
    fn piece(&mut self) -> Result<Recording, RecordError> {
        let most = self.rows.saturating_add(self.rows / 30);
        for sample in self.samples.by_ref() {
            if self.columns.t.len().is_multiple_of(10_000) {
                (self.progress)(sample.t / self.scenario.duration_s);
            }
            self.columns.push(&sample);
            if self.columns.t.len() > most {
                let rest = self.columns.split_off(self.rows);
                let piece = std::mem::replace(&mut self.columns, rest);
                return piece.into_recording(self.scenario);
            }
        }
        self.is_done = true;
        (self.progress)(1.0);
        std::mem::take(&mut self.columns).into_recording(self.scenario)
    }
}

impl Iterator for Pieces<'_> {
    type Item = Result<Recording, RecordError>;

    fn next(&mut self) -> Option<Self::Item> {
        (!self.is_done).then(|| self.piece())
    }
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
    /// What follows the first `rows` samples.
    fn split_off(&mut self, rows: usize) -> Columns {
        let mut columns = self.u.iter_mut().chain(&mut self.i);
        let mut next = || {
            columns
                .next()
                .map(|x| x.split_off(rows))
                .unwrap_or_default()
        };
        Columns {
            u: [next(), next(), next()],
            i: [next(), next(), next()],
            t: self.t.split_off(rows),
            speed: self.speed.split_off(rows),
            torque: self.torque.split_off(rows),
        }
    }

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
