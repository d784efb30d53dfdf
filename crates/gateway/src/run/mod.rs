//! The gateway as it runs: links, one writer, and whoever waits for what is new.

mod alarms;
mod gateway;
mod keeper;
mod writer;

pub use gateway::{Connected, Gateway, StartError, connect};
pub use writer::WriteError;
