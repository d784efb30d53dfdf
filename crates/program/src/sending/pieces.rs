//! Pieces of a package, one after the other: function 21.

use std::time::Duration;

use board::modbus::{PROGRAM_FILE, UNLOCK_KEY};
use live::{ModbusError, ModbusLine, Registers};

use super::{ATTEMPT, MOST_SILENT, Pace, SendError, may_pass, refusal};
use crate::package::Package;

/// Bytes of one request: with what the protocol adds well within its longest frame.
pub const PIECE_BYTES: usize = 200;
const WRITE_FILE: u8 = 21;
const REFERENCE: u8 = 6;
/// Words of one file: a record's number has 16 bits.
const FILE_WORDS: usize = 1 << 16;
/// How long a board may be busy with one piece. Its key holds for 10 s.
const MOST_BUSY: Duration = Duration::from_secs(8);
/// How often a transfer may begin anew.
const MOST_STARTS: u32 = 3;

/// Exceptions of the protocol: locked (the transfer is forgotten), another piece is next, failed, busy.
const LOCKED: u8 = 1;
const GAP: u8 = 2;
const FAILED: u8 = 4;
const BUSY: u8 = 6;

/// Sends a package, piece by piece. `progress` hears how many bytes the board has.
///
/// # Errors
/// The line is dead, the board refuses, or somebody wants to stop. The board's program runs on as before.
pub fn send(
    line: &mut ModbusLine,
    package: &Package,
    pace: &mut dyn Pace,
    progress: &mut dyn FnMut(usize),
) -> Result<(), SendError> {
    let bytes = package.bytes();
    let mut transfer = Transfer { line, pace, bytes };
    for _ in 0..MOST_STARTS {
        if transfer.begin(progress)? {
            return Ok(());
        }
    }
    Err(SendError::Lost(MOST_STARTS))
}

struct Transfer<'a> {
    line: &'a mut ModbusLine,
    pace: &'a mut dyn Pace,
    bytes: &'a [u8],
}

impl Transfer<'_> {
    /// From the first piece to the last. `false` where the board lost the transfer, as it does when it starts again.
    fn begin(&mut self, progress: &mut dyn FnMut(usize)) -> Result<bool, SendError> {
        progress(0);
        self.unlock()?;
        for (at, piece) in pieces(self.bytes) {
            if !self.send(at, piece)? {
                return Ok(false);
            }
            progress(at + piece.len());
        }
        Ok(true)
    }

    /// The key, again and again while nothing sound comes back.
    fn unlock(&mut self) -> Result<(), SendError> {
        let begun = self.pace.now();
        loop {
            self.go_on(0)?;
            match self.line.write_holding(0, &[UNLOCK_KEY]) {
                Err(error) if may_pass(&error) && self.pace.now() - begun < MOST_SILENT => {
                    self.pace.pause(ATTEMPT);
                }
                done => return Ok(done?),
            }
        }
    }

    fn go_on(&self, sent: usize) -> Result<(), SendError> {
        let bytes = self.bytes.len();
        let stopped = self.pace.is_stopped();
        (!stopped)
            .then_some(())
            .ok_or(SendError::Stopped { sent, bytes })
    }

    /// A piece, again and again while the board is busy or nothing sound comes back.
    fn send(&mut self, at: usize, piece: &[u8]) -> Result<bool, SendError> {
        let request = request(at, piece);
        let begun = self.pace.now();
        loop {
            self.go_on(at)?;
            let error = match self.line.ask(WRITE_FILE, &request) {
                Ok(answer) if answer == request => return Ok(true),
                // An answer to something else.
                Ok(_) => None,
                Err(error) => Some(error),
            };
            let waited = self.pace.now() - begun;
            match error {
                Some(ModbusError::Refused { code: BUSY, .. }) if waited < MOST_BUSY => {}
                Some(ModbusError::Refused { code: BUSY, .. }) => {
                    return Err(self.why().unwrap_or(SendError::Busy));
                }
                Some(ModbusError::Refused {
                    code: LOCKED | GAP, ..
                }) => return Ok(false),
                Some(ModbusError::Refused { code: FAILED, .. }) => {
                    return self.why().map_or(Ok(false), Err);
                }
                Some(error) if !may_pass(&error) || waited >= MOST_SILENT => {
                    return Err(error.into());
                }
                _ => {}
            }
            self.pace.pause(ATTEMPT);
        }
    }

    /// The reason in the board's registers.
    fn why(&mut self) -> Option<SendError> {
        let registers = Registers::read(self.line).ok()?;
        refusal(&registers)
    }
}

/// Each piece with its place. None lies in both files.
fn pieces(bytes: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let halves = bytes.chunks(2 * FILE_WORDS).enumerate();
    halves.flat_map(|(half, bytes)| {
        let places = (2 * FILE_WORDS * half..).step_by(PIECE_BYTES);
        places.zip(bytes.chunks(PIECE_BYTES))
    })
}

/// The data of a request: one part of one of the program's files.
fn request(at: usize, piece: &[u8]) -> Vec<u8> {
    let words = at / 2;
    let file = PROGRAM_FILE + (words / FILE_WORDS) as u16;
    let mut part = piece.to_vec();
    // Whole words; what the program and its signature are is in its seal.
    part.resize(part.len().next_multiple_of(2), 0xFF);
    let head = [file, (words % FILE_WORDS) as u16, (part.len() / 2) as u16];
    let mut data = vec![7 + part.len() as u8, REFERENCE];
    data.extend(head.into_iter().flat_map(u16::to_be_bytes));
    data.extend(part);
    data
}

#[cfg(test)]
mod tests {
    use super::*;
    use board::modbus::PROGRAM_REST_FILE;

    #[test]
    fn a_piece_lies_in_the_file_of_its_half_and_no_piece_in_both() {
        let data = request(0, &[1, 2, 3]);
        assert_eq!(data, [11, 6, 0, 4, 0, 0, 0, 2, 1, 2, 3, 0xFF]);
        let half = 2 * FILE_WORDS;
        assert_eq!(
            request(half, &[9, 9])[2..6],
            [0, PROGRAM_REST_FILE as u8, 0, 0]
        );
        let bytes: Vec<u8> = (0..half + 777).map(|k| (k % 251) as u8).collect();
        let mut next = 0;
        for (at, piece) in pieces(&bytes) {
            assert_eq!(at, next);
            assert_eq!(at % 8, 0, "flash is written in double words");
            assert_eq!(piece, &bytes[at..at + piece.len()]);
            assert_eq!(at < half, at + piece.len() <= half, "in one file");
            next += piece.len();
        }
        assert_eq!(next, bytes.len());
    }
}
