//! Recordings and load tables made ready: smooth inputs, weighted outputs, noise floor, instruments.

pub(crate) mod case;
pub(crate) mod channels;
pub(crate) mod inputs;
pub mod instrument_class;
pub(crate) mod joined;
pub(crate) mod load_table;
pub(crate) mod noise_floor;
pub(crate) mod question;
pub mod stretches;
pub(crate) mod study;
pub(crate) mod unsupported;
