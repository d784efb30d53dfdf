//! A program's way to a board over its line: pieces, the order to install it, and what becomes of it.

mod error;
mod pieces;
mod trial;

use std::thread::sleep;
use std::time::{Duration, Instant};

use board::modbus::Field;
use live::{ModbusError, ModbusLine, Registers, RegistersError};
use update::{Refusal, Seal, Version};

use crate::package::Package;

pub use error::SendError;
pub use pieces::{PIECE_BYTES, send};
pub use trial::{Stage, install, wait};

/// Time as it passes, and whether somebody wants to stop.
pub trait Pace {
    /// Waits.
    fn pause(&mut self, time: Duration);

    /// Time since any moment.
    fn now(&self) -> Duration;

    /// Whether to stop.
    fn is_stopped(&self) -> bool;
}

/// Time of a clock; stopped by a function.
pub struct Clock<S> {
    begun: Instant,
    stopped: S,
}

impl<S: Fn() -> bool> Clock<S> {
    /// Stopped when the function says so.
    pub fn new(stopped: S) -> Self {
        Clock {
            begun: Instant::now(),
            stopped,
        }
    }
}

impl<S: Fn() -> bool> Pace for Clock<S> {
    fn pause(&mut self, time: Duration) {
        sleep(time);
    }

    fn now(&self) -> Duration {
        self.begun.elapsed()
    }

    fn is_stopped(&self) -> bool {
        (self.stopped)()
    }
}

/// The program that a board runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Running {
    /// Its version.
    pub version: Version,
    /// Its checksum, as it was sealed.
    pub checksum: u32,
}

impl Running {
    /// Whether the board would take a package: what it would refuse, before minutes are spent on the line.
    ///
    /// # Errors
    /// The package is older, or for another board.
    pub fn may_be_followed_by(&self, package: &Package) -> Result<(), SendError> {
        let runs = Seal {
            version: self.version,
            ..package.seal()
        };
        match package.seal().may_follow(Some(runs)) {
            Ok(()) => Ok(()),
            Err(Refusal::Older) => Err(SendError::Older {
                package: package.seal().version,
                board: self.version,
            }),
            Err(refusal) => Err(SendError::Refused { refusal }),
        }
    }
}

/// No such register.
const NO_ADDRESS: u8 = 2;

/// Asks a board for its program.
///
/// # Errors
/// No answer, or a program that knows nothing of updates.
pub fn running(line: &mut ModbusLine) -> Result<Running, SendError> {
    let registers = Registers::read(line).map_err(|error| match error {
        // The map has grown by what an update tells.
        RegistersError::Line(ModbusError::Refused {
            code: NO_ADDRESS, ..
        }) => SendError::Unable,
        other => other.into(),
    })?;
    Ok(of_registers(&registers))
}

fn of_registers(registers: &Registers) -> Running {
    Running {
        version: Version(registers.long(Field::ProgramVersion)),
        checksum: registers.long(Field::ProgramChecksum),
    }
}

/// How long the line may be silent before a program is given up. A board that starts again meanwhile is back by then.
const MOST_SILENT: Duration = Duration::from_secs(20);
/// Between two attempts.
const ATTEMPT: Duration = Duration::from_millis(20);

/// Whether an error of the line may pass by itself: no answer, or a damaged one.
fn may_pass(error: &ModbusError) -> bool {
    matches!(
        error,
        ModbusError::Silent { .. } | ModbusError::Damaged { .. }
    )
}

/// Why the board refused, where its registers say so.
fn refusal(registers: &Registers) -> Option<SendError> {
    let number = registers.word(Field::UpdateRefused);
    let known = u8::try_from(number).ok().and_then(Refusal::by_number);
    match number {
        0 => None,
        _ => Some(known.map_or(SendError::RefusedUnknown(number), |refusal| {
            SendError::Refused { refusal }
        })),
    }
}

#[cfg(test)]
mod tests;
