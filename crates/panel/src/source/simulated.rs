//! A simulated motor that runs for ever and whose faults are switched from the page.

use document::FileError;
use monitor::{ClippedChannels, FaultId, MonitorConfig, RawSample, Rehearsal, TABLE_1};
use motor::MotorFile;
use motor::motor_file::Frame;
use serde::Serialize;

use super::{Can, Instant, Item, Reading, Source, SourceFailure, SourceInfo, SwitchedFault};
use scenario::simulate::{Measured, Simulation, SimulationError};
use scenario::{Fault, Scenario};

/// Noise of every channel, standard deviation as a share of full scale, where the motor file states none.
const NOISE: f64 = 0.002;
/// Changes that a fault may have, percent: a sensor may be dead, a motor's parameter may not vanish.
const LARGEST_PERCENT: f64 = 1000.0;

/// The assumed motor of the published bench.
const BUILT_IN: &str = include_str!("../../../../motors/assumed-300w.toml");

/// The motor that runs when nothing else was asked for.
///
/// # Errors
/// None that a test would let pass.
pub fn built_in_motor() -> Result<MotorFile, FileError> {
    MotorFile::parse(BUILT_IN, "motors/assumed-300w.toml")
}

/// A switch of the page.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PanelFault {
    /// Its name in scenario files.
    pub name: &'static str,
    /// In plain words.
    pub words: &'static str,
    /// Pattern of r1..r4 in Table 1; `None` for a fault that is not in it.
    pub table_1: Option<[bool; 4]>,
    /// The smallest change, percent: beyond it nothing physical is left.
    pub least_percent: f64,
}

/// Faults beyond Table 1.
const OTHERS: [(&str, &str, f64); 8] = [
    ("Rsa", "joint with resistance in phase a", 0.0),
    ("bars", "broken rotor bars", 0.0),
    ("ia", "current probe a", -100.0),
    ("ib", "current probe b", -100.0),
    ("ic", "current probe c", -100.0),
    ("va", "voltage probe a", -100.0),
    ("vb", "voltage probe b", -100.0),
    ("vc", "voltage probe c", -100.0),
];

/// Number of switches.
const SWITCHES: usize = TABLE_1.len() + OTHERS.len();

/// Every switch of the page, the rows of Table 1 first.
pub const PANEL_FAULTS: fn() -> [PanelFault; SWITCHES] = || {
    std::array::from_fn(|k| match TABLE_1.get(k) {
        Some((fault, pattern)) => PanelFault {
            name: fault.name(),
            words: fault.words(),
            table_1: Some(*pattern),
            least_percent: if fault.is_sensor() { -100.0 } else { -95.0 },
        },
        None => {
            let (name, words, least_percent) = OTHERS[k - TABLE_1.len()];
            PanelFault {
                name,
                words,
                table_1: None,
                least_percent,
            }
        }
    })
};

/// A running simulation.
#[derive(Debug)]
pub struct SimulatedSource {
    simulation: Simulation,
    /// Faults that the scenario brings along.
    written: Vec<Fault>,
    rehearsal: Rehearsal,
}

impl SimulatedSource {
    /// A healthy motor on its rated supply; noise is added where the motor file states none.
    ///
    /// # Errors
    /// A motor that cannot run.
    pub fn of_motor(mut motor: MotorFile) -> Result<SimulatedSource, SimulationError> {
        if motor.sensors.noise_sigma_fraction_of_full_scale == 0.0 {
            motor.sensors.noise_sigma_fraction_of_full_scale = NOISE;
        }
        SimulatedSource::new(&Scenario {
            seed: 1,
            ..Scenario::of(motor, 1.0)
        })
    }

    /// A scenario, which goes on for ever as it is at its end.
    ///
    /// # Errors
    /// A scenario that cannot be simulated sample by sample.
    pub fn new(scenario: &Scenario) -> Result<SimulatedSource, SimulationError> {
        Ok(SimulatedSource {
            simulation: Simulation::endless(scenario)?,
            written: scenario.faults.clone(),
            rehearsal: Rehearsal::default(),
        })
    }
}

impl Source for SimulatedSource {
    fn info(&self) -> SourceInfo {
        let scenario = self.simulation.scenario();
        SourceInfo {
            kind: "simulation",
            name: scenario.name.clone(),
            sample_rate_hz: scenario.sample_rate_hz,
            span_s: None,
            can: Can {
                faults: true,
                pace: true,
                seek: false,
                parameters: true,
            },
            audit: Vec::new(),
        }
    }

    fn now_s(&self) -> f64 {
        self.simulation.now()
    }

    fn advance(&mut self, until_s: f64, take: &mut dyn FnMut(Item)) -> Result<bool, SourceFailure> {
        while self.simulation.now() < until_s {
            let Some(sample) = self.simulation.next() else {
                return Ok(false);
            };
            let measured = &sample.measured;
            take(Item::Sample(instant(sample.t, measured), raw(measured)));
        }
        Ok(true)
    }

    fn config(&self, motor: Option<&MotorFile>) -> Result<Option<MonitorConfig>, FileError> {
        let scenario = self.simulation.scenario();
        let config = motor.map(|motor| {
            MonitorConfig::from_motor_file(&scenario.sensors.told(motor), scenario.t_sample())
        });
        config.transpose()
    }

    fn switch_faults(&mut self, faults: &[SwitchedFault]) -> Result<(), SourceFailure> {
        let mut rehearsal = Rehearsal::default();
        let mut of_motor = self.written.clone();
        for fault in faults {
            check(fault)?;
            if !rehearsed(&mut rehearsal, fault) {
                let made = Fault::percent(&fault.name, fault.change_percent, Frame::RotorFlux);
                of_motor.extend(made);
            }
        }
        let switched = self.simulation.switch_faults(of_motor);
        switched.map_err(|error| SourceFailure(error.to_string()))?;
        self.rehearsal = rehearsal;
        Ok(())
    }

    fn rehearsal(&self) -> Rehearsal {
        self.rehearsal
    }
}

fn check(fault: &SwitchedFault) -> Result<(), SourceFailure> {
    let known = PANEL_FAULTS();
    let Some(switch) = known.iter().find(|known| known.name == fault.name) else {
        let names = known.map(|known| known.name).join(", ");
        return Err(SourceFailure(format!(
            "there is no fault `{}`: choose one of {names}",
            fault.name
        )));
    };
    let (least, name) = (switch.least_percent, fault.name.as_str());
    if (least..=LARGEST_PERCENT).contains(&fault.change_percent) {
        return Ok(());
    }
    Err(SourceFailure(format!(
        "{name}: a change of {} % is not possible: choose one from {least} to {LARGEST_PERCENT} %",
        fault.change_percent
    )))
}

/// Sensor rows of Table 1 are switched on the d-q signals, as the published bench does.
fn rehearsed(rehearsal: &mut Rehearsal, fault: &SwitchedFault) -> bool {
    let gain = (1.0 + fault.change_percent / 100.0) as f32;
    match FaultId::from_name(&fault.name) {
        Some(FaultId::CurrentSensor) => rehearsal.current_q_gain = gain,
        Some(FaultId::VoltageSensor) => rehearsal.voltage_gain = gain,
        Some(FaultId::SpeedSensor) => rehearsal.speed_gain = gain,
        _ => return false,
    }
    true
}

fn instant(t_s: f64, measured: &Measured) -> Instant {
    Instant {
        t_s,
        u_volt: measured.u_s_abc.map(|u| u as f32),
        i_amp: measured.i_s_abc.map(|i| i as f32),
        omega_mech: measured.omega_mech as f32,
    }
}

fn raw(measured: &Measured) -> Reading {
    Reading::Raw(RawSample {
        voltage_codes: measured.voltage_codes,
        current_codes: measured.current_codes,
        encoder_count: measured.encoder_count,
        clipped: ClippedChannels::of(measured.clipped),
    })
}
