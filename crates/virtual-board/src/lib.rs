//! The board without a board: the release ELF of the firmware, unmodified, on an emulated Cortex-M4F with
//! models of the peripherals it uses, fed with the samples of a simulated motor.
//!
//! It proves that firmware and reference manual agree as we read the manual; it does not prove silicon.
//! Access to a register that is not modelled ends the run with an error. One instruction counts as one cycle of the clock that the program
//! has set, or as many as [`VirtualBoard::set_cycles_per_instruction`] says.

mod board;
mod error;
mod firmware;
mod machine;
mod peripherals;
mod processor;

pub use board::{LAMPS, Snapshot, VirtualBoard};
pub use error::BoardError;
pub use machine::relay::Contact;
pub use machine::{Inputs, Port, Tally};
pub use peripherals::flash::{PREPARED_OPTIONS, SHIPPED_OPTIONS};
pub use peripherals::gpio::Pin;
pub use peripherals::rcc::Cause;
pub use peripherals::usart::{Quality, Sent};

/// Units of emulated time per second: each of the chip's clocks (16, 24, 80, 170 MHz, 32 kHz) takes a whole number of them.
pub const TICK_HZ: u64 = 4_080_000_000;

/// Core cycles per second once the program has set its clocks.
pub const CORE_HZ: u64 = 80_000_000;
