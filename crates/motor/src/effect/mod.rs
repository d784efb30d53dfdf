//! What an effect is: how it describes itself, what it may change, and the simulator that asks it.
//!
//! An effect is stateless; its parameters are a slice in the order of its [`Descriptor`]. Its steady-state term
//! ([`SteadyEffect`]) needs neither `std` nor allocation and works in `f32` or `f64`; its dynamic term
//! ([`Effect`]) lives on the host. The effects themselves stand in [`crate::effects`], one file each.

#[cfg(feature = "std")]
pub(crate) mod config;
pub mod curve;
pub(crate) mod descriptor;
#[cfg(feature = "std")]
#[expect(
    clippy::module_inception,
    reason = "the trait that the folder is about"
)]
pub(crate) mod effect;
#[cfg(feature = "file")]
pub mod expression;
#[cfg(feature = "file")]
pub(crate) mod file;
#[cfg(feature = "file")]
mod motions;
#[cfg(feature = "std")]
pub(crate) mod signals;
#[cfg(feature = "std")]
mod simulate;
#[cfg(feature = "std")]
mod stack;
pub(crate) mod steady;
#[cfg(feature = "std")]
pub mod tangent;

#[cfg(feature = "std")]
pub use config::{EffectConfig, EffectError};
pub use descriptor::{Applies, Descriptor, Kind, Parameter, Rated, Role, Scale, Written};
#[cfg(feature = "std")]
pub use effect::{At, Cage, Effect, Hook, Instantaneous, Instrument, Nominal, Rates, Side};
#[cfg(feature = "file")]
pub(crate) use file::check;
#[cfg(feature = "file")]
pub use file::{from_entry, from_motor_file, rated, to_entry};
#[cfg(feature = "std")]
pub use signals::{Inputs, Outputs};
#[cfg(feature = "std")]
pub use simulate::{Between, Plant, Run, SpeedSource, StateOffset, simulate, simulate_coarsely};
#[cfg(feature = "std")]
pub use stack::{Cut, EffectStack, MAX_FILE_STATES, Timeline, extra_states};
pub use steady::{MAX_PARAMETERS, SteadyEffect, SteadyPoint};
