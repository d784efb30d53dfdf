//! What a master may read and write.

use super::map::Image;
use crate::configuration::Desk;

/// Copies bytes of a file from a place on; `false` while it cannot be read.
pub type ReadFile<'a> = &'a dyn Fn(usize, &mut [u8]) -> bool;

/// What a master may read as files.
#[derive(Clone, Copy)]
pub struct Files<'a> {
    /// The event log, as it lies in flash.
    pub events: ReadFile<'a>,
    /// The last seconds ([`crate::SecondRing`]).
    pub seconds: ReadFile<'a>,
}

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
    /// Event log and seconds.
    pub files: Files<'a>,
    /// Configurations.
    pub desk: &'a mut Desk,
}
