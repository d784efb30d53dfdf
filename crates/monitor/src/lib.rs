#![cfg_attr(not(test), no_std)]
//! The monitor core: from ADC code to lamp. `no_std`, no allocation, f32, no hardware.
//!
//! One sample's way: [`Converter`] (codes to SI) -> [`SyncConfig`] (angle of the supply) ->
//! phasors of whole cycles -> once per cycle: residuals -> thresholds -> signature -> lamps.

mod checks;
mod config;
mod frames;
#[cfg(feature = "motor-file")]
mod from_motor_file;
mod input;
mod isolation;
mod lamps;
mod model;
mod monitor;
mod noise;
mod rehearsal;
mod report;
mod sync;
#[cfg(test)]
mod tests;
mod window;

pub use checks::rotor_bars::{RotorReading, RotorState, Sidebands};
pub use checks::sensors::{HealthConfig, Phase, SensorFinding};
pub use checks::supply::{SupplyConfig, SupplyFinding};
pub use config::{ConfigError, LoadKind, MonitorConfig};
pub use frames::{Abc, AlphaBeta, Dq, Sequence, magnitude};
pub use input::converter::{ChannelScale, Converter};
pub use input::sample::{CHANNELS, ClippedChannels, RawBlock, RawSample, Sample, SpeedSample};
pub use isolation::{
    ALL_CAUSES, CAUSES, Cause, Evidence, Healthy, Heating, Isolation, ROWS, Row, Uncertainty,
    probabilities,
};
pub use lamps::lamp::{Lamp, Lamps};
pub use lamps::likely_cause::{Channel, Known, Suspect, Suspicion, TIE_RATIO, Witness, likely};
pub use lamps::signature::{Candidates, FAULTS, Fault, TABLE_1};
pub use lamps::threshold::{ComparatorConfig, ComparatorState};
pub use model::effects::{
    ActiveEffect, ActiveEffects, Corrected, MAX_EFFECT_PARAMETERS, MAX_EFFECTS, correct,
};
pub use model::operating_point::{Frame, OperatingPoint};
pub use model::residuals::{FieldCurrent, RESIDUALS, ResidualModel, Residuals};
pub use monitor::{Monitor, MonitorState};
pub use rehearsal::Rehearsal;
pub use report::{NotJudged, Report};
pub use sync::encoder::{EncoderConfig, EncoderState, SpeedReading};
pub use sync::phasor::{ChannelCycle, CyclePhasors};
pub use sync::pll::{SyncConfig, SyncState, SyncTick};
pub use window::{CycleNoise, MAX_WINDOW_CYCLES, RateNoise, Rates, Window};
