//! Listening to a running board: frames from a serial port or a debug probe.

mod capture;
mod decoder;
#[cfg(feature = "probe")]
mod probe;
mod source;

pub use capture::{CaptureError, Collector, Fetched, recording};
pub use decoder::Decoder;
pub use source::{Source, SourceError, open_probe, open_serial};
