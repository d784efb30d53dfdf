//! The gateway as it runs: links, one writer, alarms, and those who wait for what is new.

mod alarms;
mod gateway;
mod keeper;
mod requests;
mod writer;

pub use gateway::{Connected, Gateway, StartError, connect};
pub use writer::WriteError;
