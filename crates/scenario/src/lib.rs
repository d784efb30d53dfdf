//! Scenario files: what a simulated motor lives through.
//!
//! A scenario names a motor file and says what the supply does, what the shaft drives, what breaks when
//! and what the instruments are like. Everything except `motor` and `duration_s` has a default.
//!
//! ```
//! use scenario::Scenario;
//! use scenario::simulate::Simulation;
//!
//! let scenario = Scenario::read("../../sim-host/scenarios/healthy-300w.toml").expect("a scenario");
//! let samples = Simulation::new(&scenario).expect("it can be simulated");
//! let peak = samples.take(1000).map(|sample| sample.measured.i_s_abc[0].abs());
//! assert!(peak.fold(0.0, f64::max) > 0.5); // ampere
//! ```

mod chain;
mod faults;
mod load;
mod read;
mod sensors;
pub mod simulate;
mod supply;

#[cfg(test)]
mod malformed;
#[cfg(test)]
mod malformed_cases;
#[cfg(test)]
pub(crate) mod tests;

pub use chain::{CHANNELS, Carrier, ChannelChain, Inl, InlShape, Reference, SEQUENCE, SignalChain};
pub use faults::{Asymmetry, Change, DqSignal, Fault, Parameter, Probe, Target};
pub use load::{Interpolation, Load, LoadSpec, Profile, ProfileError};
pub use sensors::{SensorSpec, SpeedSensor};
pub use supply::{Piecewise, SupplySpec};

use document::{Document, FileError, read_text};
use motor::MotorFile;
use motor::motor_file::EffectEntry;
use std::path::{Path, PathBuf};

/// The equations that stand in for the motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlantKind {
    /// The five-state motor in stationary coordinates.
    Full,
    /// The published linear model (33) with constant field current.
    Linear,
}

/// The state in which a simulation begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// At rest and without flux.
    Standstill,
    /// Settled at the operating point of the first instant.
    Running,
}

/// One simulated experiment, validated.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// What the experiment is called.
    pub name: String,
    /// The motor, healthy.
    pub motor: MotorFile,
    /// Where the motor was read; nowhere when it is built in.
    pub motor_path: Option<PathBuf>,
    /// Which equations.
    pub plant: PlantKind,
    /// Where it begins.
    pub start: Start,
    /// Length of the experiment from t = 0, s.
    pub duration_s: f64,
    /// Samples per second, Hz.
    pub sample_rate_hz: f64,
    /// Samples before this time are simulated and not recorded, s.
    pub record_from_s: f64,
    /// Interval of the d-q data of a side-by-side experiment, s.
    pub data_interval_s: f64,
    /// Seed of every random number.
    pub seed: u64,
    /// What the supply does.
    pub supply: SupplySpec,
    /// What the shaft drives.
    pub load: LoadSpec,
    /// What breaks when.
    pub faults: Vec<Fault>,
    /// What the instruments are like.
    pub sensors: SensorSpec,
    /// Physical effects in force beside those of the motor file.
    pub effects: Vec<EffectEntry>,
}

/// The board's sampling rate.
const SAMPLE_RATE_HZ: f64 = 10_000.0;
/// The published instrument takes its d-q data every 20 ms.
const DATA_INTERVAL_S: f64 = 0.02;

/// A signal chain takes its quantities at least this often, s: straight lines between them are then off by 2e-6 of a
/// sinusoid of 60 Hz.
const CHAIN_STEP_S: f64 = 10e-6;

impl Scenario {
    /// A healthy motor on its rated supply with its own load, already running, sampled at 10 kHz by the
    /// instruments of its motor file.
    pub fn of(motor: MotorFile, duration_s: f64) -> Scenario {
        Scenario {
            name: motor.name.clone(),
            plant: PlantKind::Full,
            start: Start::Running,
            duration_s,
            sample_rate_hz: SAMPLE_RATE_HZ,
            record_from_s: 0.0,
            data_interval_s: DATA_INTERVAL_S,
            seed: 0,
            supply: SupplySpec::rated(&motor.nameplate),
            load: LoadSpec::default(),
            faults: Vec::new(),
            sensors: SensorSpec::of(&motor),
            effects: Vec::new(),
            motor_path: None,
            motor,
        }
    }

    /// Reads a scenario file; the motor file that it names is looked up beside it.
    ///
    /// # Errors
    /// An unreadable file, or all problems of the scenario or of its motor file with file, line and remedy.
    pub fn read(path: impl AsRef<Path>) -> Result<Scenario, FileError> {
        let path = path.as_ref();
        let text = read_text(path)?;
        let folder = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
        Scenario::parse(&text, &path.display().to_string(), &folder)
    }

    /// Validates the text of a scenario file; `folder` is where the motor file's path begins.
    ///
    /// # Errors
    /// All problems of the scenario or of its motor file with file, line and remedy.
    pub fn parse(text: &str, file_label: &str, folder: &Path) -> Result<Scenario, FileError> {
        let document = Document::parse(text, file_label)?;
        let (path, motor) = read::motor_file(&document, folder)?;
        let scenario = read::scenario(&document, motor).map(|scenario| Scenario {
            motor_path: Some(path),
            ..scenario
        });
        document.finish(scenario)
    }

    /// The same experiment without faults.
    #[must_use]
    pub fn healthy(&self) -> Scenario {
        Scenario {
            faults: Vec::new(),
            ..self.clone()
        }
    }

    /// Time between samples, s.
    pub fn t_sample(&self) -> f64 {
        1.0 / self.sample_rate_hz
    }

    /// Equal steps from one sample to the next: one, or as many as a signal chain needs to be fed finely.
    pub(crate) fn steps_per_sample(&self) -> u32 {
        match self.sensors.chain {
            // At most 1000: samples come at 100 Hz and more.
            Some(_) => (self.t_sample() / CHAIN_STEP_S - 1e-9).ceil().max(1.0) as u32,
            None => 1,
        }
    }

    /// Number of samples from t = 0, the last at or before `duration_s`.
    pub fn samples(&self) -> u64 {
        // Bounded by the readers' limits; a hair against 0.3 * 10000 = 2999.9999.
        (self.duration_s * self.sample_rate_hz + 1e-6).floor() as u64 + 1
    }
}
