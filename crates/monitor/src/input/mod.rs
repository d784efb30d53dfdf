//! From ADC codes to valid samples in SI units.

pub(crate) mod block;
pub(crate) mod chain;
pub(crate) mod codes;
pub(crate) mod converter;
pub(crate) mod sample;
pub(crate) mod torque;
pub(crate) mod validity;
