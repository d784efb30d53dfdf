//! What a master may read and write.

use super::map::Image;
use crate::configuration::Desk;

/// Copies bytes of the event log from a place on; `false` while flash cannot be read.
pub type ReadEvents = fn(usize, &mut [u8]) -> bool;

/// What was compiled into the program, and the chip's serial number. What else identifies a board is in its registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Version of the program.
    pub version: &'static str,
    /// Revision of its source; empty where it was not built from a repository.
    pub revision: &'static str,
    /// The chip's serial number, its highest 32 bits first.
    pub serial: [u32; 3],
}

/// What a master may read, and the configuration that it may write.
pub struct Memory<'a> {
    /// Input registers.
    pub image: &'a Image,
    /// Who the board is.
    pub identity: &'a Identity,
    /// The event log.
    pub events: ReadEvents,
    /// Configurations.
    pub desk: &'a mut Desk,
}
