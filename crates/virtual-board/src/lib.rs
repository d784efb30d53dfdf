//! The board without a board: the release ELF of the firmware, unmodified, on an emulated Cortex-M4F with
//! models of the peripherals it uses, fed with the samples of a simulated motor.
//!
//! It proves that firmware and reference manual agree as we read the manual; it does not prove silicon.
//! Access to a register that is not modelled ends the run with an error. One instruction counts as one cycle.

mod board;
mod error;
mod firmware;
mod machine;
mod peripherals;
mod processor;

pub use board::{LAMPS, Snapshot, VirtualBoard};
pub use error::BoardError;
pub use machine::{Inputs, Port, Tally};
pub use peripherals::gpio::Pin;
pub use peripherals::rcc::Cause;
pub use peripherals::usart::{Quality, Sent};

/// Core cycles per second.
pub const CORE_HZ: u64 = 170_000_000;
