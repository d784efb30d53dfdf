//! What a master may read and write.

use super::map::Image;
use crate::configuration::Desk;

/// A file that a master may read. A function may be one; `dyn Fn` itself would need three entries of a table for each.
pub trait File {
    /// Copies bytes from place `at` on; `false` while they cannot be read.
    fn read(&self, at: usize, bytes: &mut [u8]) -> bool;
}

impl<F: Fn(usize, &mut [u8]) -> bool> File for F {
    fn read(&self, at: usize, bytes: &mut [u8]) -> bool {
        self(at, bytes)
    }
}

/// What a master may read as files.
#[derive(Clone, Copy)]
pub struct Files<'a> {
    /// The event log, as it lies in flash.
    pub events: &'a dyn File,
    /// The last seconds ([`crate::SecondRing`]).
    pub seconds: &'a dyn File,
    /// The samples around an alarm ([`crate::Capture::read`]).
    pub capture: &'a dyn File,
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
    /// Event log, seconds, samples around an alarm.
    pub files: Files<'a>,
    /// Configurations.
    pub desk: &'a mut Desk,
}
