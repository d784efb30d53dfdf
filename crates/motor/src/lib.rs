#![cfg_attr(not(feature = "std"), no_std)]
//! Induction motor physics: parameters, dynamic model, steady state and physical effects.
//!
//! Without default features this crate is `no_std` and carries what the monitor core needs.

pub mod connection;
#[cfg(feature = "file")]
pub mod document;
#[cfg(feature = "std")]
pub mod dynamic;
pub mod effect;
pub mod effects;
#[cfg(feature = "std")]
pub mod linear_plant;
#[cfg(feature = "std")]
pub mod load;
#[cfg(feature = "file")]
pub mod motor_file;
mod params;
#[cfg(feature = "std")]
pub mod parity;
pub mod steady_state;
pub mod temperature;

#[cfg(feature = "file")]
pub use motor_file::MotorFile;
pub use params::{GammaParams, InvGammaParams, Mechanics, TParams};
