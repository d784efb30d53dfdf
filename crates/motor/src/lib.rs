#![cfg_attr(not(feature = "std"), no_std)]
//! Induction motor physics: parameters, dynamic model, steady state and physical effects.
//!
//! Without default features this crate is `no_std` and carries what the monitor core needs.
//!
//! ```
//! # #[cfg(feature = "file")] {
//! use motor::MotorFile;
//! use motor::steady_state::SteadyState;
//! use num_complex::Complex;
//!
//! let motor = MotorFile::read("../../motors/peer-2k2.toml").expect("a motor file");
//! let plate = &motor.nameplate;
//! let volt = Complex::new(plate.phase_voltage_amplitude(), 0.0);
//! let (n_p, omega) = (motor.mechanics.n_p, plate.omega_sync());
//! let point = SteadyState::new(&motor.parameters, n_p, volt, omega)
//!     .at_torque(plate.torque_nm)
//!     .expect("below breakdown");
//! assert!(point.slip() > 0.01 && point.slip() < 0.1);
//! # }
//! ```

pub mod connection;
#[cfg(feature = "std")]
pub mod dynamic;
pub mod effect;
pub mod effects;
mod in_motion;
#[cfg(feature = "file")]
pub mod motor_file;
mod params;
pub mod steady_state;
pub mod temperature;

#[cfg(feature = "file")]
pub use document::FileError;
pub use faults::FaultId;
pub use in_motion::InMotion;
#[cfg(feature = "file")]
pub use motor_file::MotorFile;
pub use params::{Mechanics, TParams};
