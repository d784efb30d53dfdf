//! The processor that executes the firmware.

pub(crate) mod block;
pub(crate) mod cpu;
