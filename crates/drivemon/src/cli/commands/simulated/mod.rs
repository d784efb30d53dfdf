//! Commands that simulate a motor.

pub(crate) mod campaign;
pub(crate) mod demo;
pub(crate) mod simulate;
