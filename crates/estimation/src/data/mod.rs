//! Recordings and load tables made ready: smooth inputs, weighted outputs, noise floor, instruments.

pub mod case;
pub mod channels;
pub mod given;
pub mod inputs;
pub mod instrument_class;
pub mod joined;
pub mod load_table;
pub mod noise_floor;
pub mod question;
pub mod stretches;
pub mod study;
pub mod subject;
pub mod unsupported;
