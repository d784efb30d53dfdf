//! Everything that knows the chip.

pub mod board;
pub mod encoder;
pub mod flash_store;
pub mod housekeeping;
mod interrupts;
pub mod lamps;
mod memory;
mod ring;
pub mod sampling;
pub mod serial;
pub mod telemetry;
