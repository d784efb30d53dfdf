//! A running board: its frames from a serial port or a debug probe, and questions to it over Modbus.
//!
//! ```
//! let mut decoder = live::Decoder::default();
//! // Noise on the wire: no message, and no panic.
//! assert!(decoder.take(&[7; 300]).is_empty());
//! ```

mod capture;
mod crash;
mod decoder;
mod log;
mod modbus;
mod objects;
#[cfg(feature = "probe")]
mod probe;
mod registers;
mod source;

pub use capture::{CaptureError, Collector, Fetched, recording};
pub use crash::{fault_status, missing_marks};
pub use decoder::Decoder;
pub use log::{LogSplitter, SplitLog};
pub use modbus::{ModbusError, ModbusLine, Wire};
pub use registers::{Registers, RegistersError, doubts_in_words};
pub use source::{Source, SourceError, open_probe, open_serial};
