//! Asking boards: over a network or on a serial line.

mod error;
mod link_bus;
mod rtu;
mod tcp;

pub(crate) use error::BusError;
pub(crate) use link_bus::Bus;
