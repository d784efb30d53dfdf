//! The place where a new program waits: received piece by piece, then checked, while the samples go on.
//!
//! It lies in the bank that the program does not run from. A page is erased in the background before the first byte of it
//! comes; of what is written and read each step is short. What lies there counts only once all of it was checked, so a
//! transfer that was cut off does no harm: the next one begins at 0 and erases what it needs.

use super::background::BackgroundFlash;
use super::tray::{PORTION_BYTES, Portion};
use crate::key::SIGNATURE_BYTES;
use crate::layout::{PAGE_BYTES, WAITING, WAITING_PAGES};
use crate::refusal::Refusal;
use crate::seal::{SEAL_BYTES, SEAL_OFFSET, Seal, Tally};

/// Bytes of which the checksum is computed in one step.
const CHECKED_BYTES: usize = 512;
/// Of these at once.
const READ_BYTES: usize = 64;

/// What became of a portion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// It lies in flash.
    Done,
    /// Not yet: a page is being erased, or the supply is low.
    Wait,
    /// The transfer is over: flash refused it, or it contradicts what was received.
    Failed(Refusal),
}

/// How a check stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Checked {
    /// Not finished, or flash is not ready.
    NotYet,
    /// A whole program for this board; who made it the loader asks.
    Whole(Seal),
    /// Not taken.
    Refused(Refusal),
}

/// A check that has begun.
struct Check {
    seal: Seal,
    tally: Tally,
}

/// The place in a flash, at [`WAITING`].
pub struct Waiting<F> {
    flash: F,
    received: u32,
    /// Pages that were erased for this transfer, from the first on.
    erased: u32,
    check: Option<Check>,
}

impl<F: BackgroundFlash> Waiting<F> {
    /// Nothing is received yet, whatever lies there.
    pub fn new(flash: F) -> Self {
        Waiting {
            flash,
            received: 0,
            erased: 0,
            check: None,
        }
    }

    /// Bytes that are received.
    pub fn received(&self) -> u32 {
        self.received
    }

    /// Takes the next portion, one again, or a first one, with which a transfer begins anew. Writes four double words at
    /// most.
    pub fn take(&mut self, portion: &Portion) -> Taken {
        if !self.flash.is_ready() {
            return Taken::Wait;
        }
        if portion.offset == 0 && self.received > 0 {
            self.restart();
        }
        if portion.offset != self.received {
            return self.compare(portion);
        }
        match self.prepare(portion) {
            Some(true) => self.write(portion),
            Some(false) => Taken::Wait,
            None => self.fail(Refusal::NoProgram),
        }
    }

    /// Erases ahead while nothing else is to do, and sees each erasure end.
    pub fn rest(&mut self) {
        let ahead = self.received / PAGE_BYTES + 1;
        let ready = self.flash.is_ready();
        if ready && self.received > 0 && self.erased <= ahead {
            self.erase_next();
        }
    }

    /// Forgets what was received.
    pub fn restart(&mut self) {
        (self.received, self.erased, self.check) = (0, 0, None);
    }

    /// Whether the pages of a portion are erased; begins with one that is not. `None` beyond the last page.
    fn prepare(&mut self, portion: &Portion) -> Option<bool> {
        let needed = portion.end().saturating_sub(1) / PAGE_BYTES;
        if needed >= WAITING_PAGES {
            return None;
        }
        let erased = self.erased > needed;
        if !erased {
            self.erase_next();
        }
        Some(erased)
    }

    fn erase_next(&mut self) {
        if self.erased < WAITING_PAGES {
            self.flash.begin_erase(WAITING + self.erased * PAGE_BYTES);
            self.erased += 1;
        }
    }

    fn write(&mut self, portion: &Portion) -> Taken {
        let written = self.flash.write(WAITING + portion.offset, portion.padded());
        if written.is_err() || !self.holds(portion) {
            return self.fail(Refusal::Flash);
        }
        self.received = portion.end();
        Taken::Done
    }

    /// A portion that came before must be the same again.
    fn compare(&mut self, portion: &Portion) -> Taken {
        if portion.end() > self.received || !self.holds(portion) {
            return self.fail(Refusal::Incomplete);
        }
        Taken::Done
    }

    fn holds(&mut self, portion: &Portion) -> bool {
        let mut bytes = [0; PORTION_BYTES];
        let padded = portion.padded();
        let Some(places) = bytes.get_mut(..padded.len()) else {
            return false;
        };
        self.flash.read(WAITING + portion.offset, places).is_ok() && places == padded
    }

    fn fail(&mut self, refusal: Refusal) -> Taken {
        self.restart();
        Taken::Failed(refusal)
    }

    /// Checks what was received, a bounded number of bytes a call: seal, board, version, completeness, checksum. `running` is
    /// the seal of the program that runs, where it has one.
    pub fn check(&mut self, running: Option<Seal>) -> Checked {
        if !self.flash.is_ready() {
            return Checked::NotYet;
        }
        let checked = match self.check.take() {
            None => self.begin_check(running).map(Some),
            Some(check) => self.go_on(check),
        };
        match checked {
            Ok(Some(check)) if check.tally.bytes() == check.seal.length as usize => {
                match check.tally.check(&check.seal) {
                    Ok(()) => Checked::Whole(check.seal),
                    Err(refusal) => Checked::Refused(refusal),
                }
            }
            Ok(check) => {
                self.check = check;
                Checked::NotYet
            }
            Err(refusal) => Checked::Refused(refusal),
        }
    }

    fn begin_check(&mut self, running: Option<Seal>) -> Result<Check, Refusal> {
        let mut bytes = [0; SEAL_BYTES];
        if (self.received as usize) < SEAL_OFFSET + SEAL_BYTES {
            return Err(Refusal::Incomplete);
        }
        self.read(SEAL_OFFSET as u32, &mut bytes)?;
        let seal = Seal::of_bytes(&bytes)?;
        seal.may_follow(running)?;
        if self.received < seal.length + SIGNATURE_BYTES as u32 {
            return Err(Refusal::Incomplete);
        }
        let tally = Tally::default();
        Ok(Check { seal, tally })
    }

    fn go_on(&mut self, mut check: Check) -> Result<Option<Check>, Refusal> {
        let mut bytes = [0; READ_BYTES];
        for _ in 0..CHECKED_BYTES / READ_BYTES {
            let at = check.tally.bytes();
            let left = (check.seal.length as usize).saturating_sub(at);
            if left == 0 {
                break;
            }
            let places = bytes.get_mut(..left.min(READ_BYTES)).unwrap_or_default();
            self.read(at as u32, places)?;
            check.tally.update(places);
        }
        Ok(Some(check))
    }

    fn read(&mut self, at: u32, bytes: &mut [u8]) -> Result<(), Refusal> {
        let read = self.flash.read(WAITING + at, bytes);
        read.map_err(|_| Refusal::Flash)
    }
}

#[cfg(test)]
mod tests;
