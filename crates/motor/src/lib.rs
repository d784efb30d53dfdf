#![cfg_attr(not(feature = "std"), no_std)]
//! Induction motor physics: parameters, dynamic model, steady state and physical effects.
//!
//! Without default features this crate is `no_std` and carries what the monitor core needs.

#[cfg(feature = "std")]
pub mod dynamic;
mod params;

pub use params::{GammaParams, InvGammaParams, Mechanics, TParams};
