//! The board without a board: the release ELF of the firmware, unmodified, on an emulated Cortex-M4F with
//! models of the peripherals it uses, fed with the samples of a simulated motor.
//!
//! It proves that firmware and reference manual agree as we read the manual; it does not prove silicon.
//! Access to a register that is not modelled ends the run with an error. One instruction counts as one cycle.

mod adc;
mod block;
mod board;
mod bus;
mod cpu;
mod dma;
mod elf;
mod error;
mod flash;
mod gpio;
mod iwdg;
mod log;
mod machine;
mod nvic;
mod rcc;
mod registers;
mod rtt;
mod timer;
mod usart;

pub use board::{LAMPS, Snapshot, VirtualBoard};
pub use error::BoardError;
pub use gpio::Pin;
pub use machine::{Inputs, Port, Tally};
pub use rcc::Cause;
pub use usart::{Quality, Sent};

/// Core cycles per second.
pub const CORE_HZ: u64 = 170_000_000;
