#![cfg_attr(not(test), no_std)]
//! The monitor core: from ADC code to lamp. `no_std`, no allocation, f32, no hardware.
//!
//! One sample's way, folder by folder: `input` (blocks of codes on the board, SI on a computer; what is invalid is kept
//! out) -> `sync` (angle of the supply, phasors of whole cycles, speed) -> `window` (some cycles as one measurement) ->
//! `checks` (sensors, supply, rotor bars) -> `model` (operating point, effects, residuals) with `noise` -> `isolation` on
//! a calibrated motor -> `lamps`. [`Monitor`] calls them in this order.
//!
//! Three voltages and currents of 50 Hz, sampled at 10 kHz, and what comes once per supply cycle:
//!
//! ```
//! # #[cfg(feature = "motor-file")] {
//! use monitor::{Abc, Lamp, Monitor, MonitorConfig, MonitorState, Sample};
//! use motor::MotorFile;
//!
//! let motor = MotorFile::read("../../motors/peer-2k2.toml").expect("a motor file");
//! let config = MonitorConfig::from_motor_file(&motor, 1e-4).expect("effects of the library");
//! let monitor = Monitor::new(config).expect("valid");
//! let mut state = MonitorState::default();
//! let phases = |amplitude: f32, angle: f32| {
//!     let third = std::f32::consts::TAU / 3.0;
//!     let [a, b, c] = [0.0, third, 2.0 * third].map(|shift| amplitude * (angle - shift).cos());
//!     Abc { a, b, c }
//! };
//! let reports = (0..10_000).filter_map(|k| {
//!     let angle = 314.16 * 1e-4 * k as f32;
//!     let (u_s_abc, i_s_abc) = (phases(326.0, angle), phases(5.0, angle - 1.0));
//!     let (u_s_abc, i_s_abc) = (Some(u_s_abc), Some(i_s_abc));
//!     let sample = Sample { u_s_abc, i_s_abc, ..Sample::default() };
//!     monitor.update(&mut state, &sample)
//! });
//! // Without a speed nothing is judged, and no lamp of a fault is lit.
//! let last = reports.last().expect("fifty cycles");
//! assert!(last.residuals.is_none() && last.lamps.fault == Lamp::Off);
//! # }
//! ```

// A motor file is read on a host.
#[cfg(all(feature = "motor-file", not(test)))]
extern crate std;

mod beside;
mod by_cycle;
mod checks;
mod config;
#[cfg(feature = "motor-file")]
mod from_motor_file;
mod input;
mod isolation;
mod lamps;
mod model;
mod monitor;
mod noise;
#[cfg(feature = "motor-file")]
mod of_board;
mod rehearsal;
mod report;
mod sync;
#[cfg(test)]
mod tests;
mod window;

pub use beside::moving::{MotionWord, Moving, MovingCause, MovingFault};
pub use beside::{Beside, CodeUnits, Stretch};
pub use checks::cage::{Cage, CageLimits, HealthySidebands, RotorReading};
pub use checks::rotor_bars::{RotorState, Sidebands};
pub use checks::sensors::{HealthConfig, Phase, SensorFinding, dead_channel};
pub use checks::speed_swing::Driven;
pub use checks::supply::{SupplyConfig, SupplyFinding};
pub use checks::unbalance::unexplained_current;
pub use config::{ConfigError, LoadKind, MonitorConfig};
pub use covariance::{Cholesky, Covariance};
pub use frames::{Abc, AlphaBeta, Dq, Sequence, magnitude};
pub use input::chain::AnalogueChain;
pub use input::converter::{ChannelScale, Converter};
pub use input::sample::{CHANNELS, ClippedChannels, RawBlock, RawSample, Sample, SpeedSample};
pub use input::torque::TorqueReading;
pub use isolation::{
    ALL_CAUSES, Beyond, CAUSES, CalibratedRange, Cause, Conditions, Evidence, Healthy, Heating,
    Isolation, ROWS, Row, Uncertainty, probabilities,
};
pub use lamps::lamp::{Lamp, Lamps};
pub use lamps::likely_cause::{Channel, Known, Suspect, Suspicion, TIE_RATIO, Witness, likely};
pub use lamps::signature::{Candidates, FAULTS, TABLE_1};
pub use lamps::threshold::{ComparatorConfig, ComparatorState};
pub use model::doubt::{CIRCUIT, ParameterDoubt};
pub use model::effects::{
    ActiveEffect, ActiveEffects, ActiveLaws, Corrected, MAX_EFFECT_PARAMETERS, MAX_EFFECTS,
    MAX_LAWS, correct,
};
pub use model::operating_point::{Frame, OperatingPoint};
pub use model::residuals::{FieldCurrent, RESIDUALS, ResidualModel, Residuals};
pub use monitor::{Monitor, MonitorState};
pub use motor::{FaultId, InMotion};
#[cfg(feature = "motor-file")]
pub use of_board::{BOARD_CONVERSIONS, BOARD_T_SAMPLE};
pub use pll::{Supply, SyncConfig, SyncState, SyncTick, renormalise, small_rotation};
pub use rehearsal::Rehearsal;
pub use report::{NotJudged, Reason, Report};
pub use sync::encoder::{EncoderConfig, EncoderState, SpeedReading};
pub use sync::phasor::{ChannelCycle, CyclePhasors};
pub use window::{Cycle, CycleNoise, MAX_WINDOW_CYCLES, RateNoise, Rates, Window};
