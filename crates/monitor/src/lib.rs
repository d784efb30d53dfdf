#![cfg_attr(not(test), no_std)]
//! The monitor core: from ADC code to lamp. `no_std`, no allocation, f32, no hardware.
//!
//! One sample's way: [`Converter`] (codes to SI) -> [`SyncConfig`] (angle of the supply) ->
//! phasors of whole cycles -> once per cycle: residuals -> thresholds -> signature -> lamps.

mod allowance;
mod block;
mod calibrated;
mod codes;
mod config;
mod convert;
mod effects;
mod encoder;
mod frames;
#[cfg(feature = "motor-file")]
mod from_motor_file;
mod health;
mod intake;
mod isolation;
mod lamps;
mod likely;
mod monitor;
mod noise;
mod operating_point;
mod panel;
mod phasor;
mod rehearsal;
mod report;
mod residuals;
mod rotation;
mod rotor;
mod sample;
mod scatter;
mod settled;
mod signature;
mod supply;
mod sync;
#[cfg(test)]
mod tests;
mod threshold;
mod trend;
mod window;

pub use config::{ConfigError, LoadKind, MonitorConfig};
pub use convert::{ChannelScale, Converter};
pub use effects::{
    ActiveEffect, ActiveEffects, Corrected, MAX_EFFECT_PARAMETERS, MAX_EFFECTS, correct,
};
pub use encoder::{EncoderConfig, EncoderState, SpeedReading};
pub use frames::{Abc, AlphaBeta, Dq, Sequence, magnitude};
pub use health::{HealthConfig, Phase, SensorFinding};
pub use isolation::{
    ALL_CAUSES, CAUSES, Cause, Evidence, Healthy, Heating, Isolation, ROWS, Row, Uncertainty,
    probabilities,
};
pub use lamps::{Lamp, Lamps};
pub use likely::{Channel, Known, Suspect, Suspicion, TIE_RATIO, Witness, likely};
pub use monitor::{Monitor, MonitorState};
pub use operating_point::{Frame, OperatingPoint};
pub use phasor::{ChannelCycle, CyclePhasors};
pub use rehearsal::Rehearsal;
pub use report::{NotJudged, Report};
pub use residuals::{FieldCurrent, RESIDUALS, ResidualModel, Residuals};
pub use rotor::{RotorReading, RotorState, Sidebands};
pub use sample::{CHANNELS, ClippedChannels, RawBlock, RawSample, Sample, SpeedSample};
pub use signature::{Candidates, FAULTS, Fault, TABLE_1};
pub use supply::{SupplyConfig, SupplyFinding};
pub use sync::{SyncConfig, SyncState, SyncTick};
pub use threshold::{ComparatorConfig, ComparatorState};
pub use window::{CycleNoise, MAX_WINDOW_CYCLES, RateNoise, Rates, Window};
