//! The journal: two pages of double words, each a whole state with a number and a checksum. The newest whole one holds.
//!
//! A word whose programming was cut off is no state and is passed over; a page is erased only while the newest state lies in
//! the other one. So whatever is interrupted, either the state before or the one after is found.
//!
//! Own code although `embassy-boot` exists: its state is a page of progress marks without checksums, which a word that was
//! cut off leaves undefined, and on this chip unreadable (error correction); and it does not ask for a signature.

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use embedded_storage::nor_flash::{NorFlash, NorFlashError, NorFlashErrorKind};

use crate::layout::{JOURNAL_PAGES, PAGE_BYTES, PROGRAM_PAGES};
use crate::refusal::Refusal;

const CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);
const WORD_BYTES: u32 = 8;
const PLACES: u32 = PAGE_BYTES / WORD_BYTES;
const BLANK: [u8; 8] = [0xFF; 8];
/// Numbers count modulo this; far more than places, so that the newer of two is known.
const NUMBERS: u32 = 1 << 12;

/// How far an update is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// None was asked for since the loader was written.
    Idle,
    /// A whole program waits; the loader shall check and exchange it.
    Requested,
    /// So many steps of the exchange of the first `pages` pages are done.
    Exchanging {
        /// Pages that are exchanged.
        pages: u8,
        /// Copies that are finished, two a page.
        step: u8,
    },
    /// The new program lies in its place and has not run yet.
    Installed {
        /// Pages that were exchanged.
        pages: u8,
    },
    /// The new program runs and has not confirmed itself. The next start brings the old one back.
    OnTrial {
        /// Pages that were exchanged.
        pages: u8,
    },
    /// The new program confirmed itself.
    Confirmed,
    /// So many steps back are done.
    Reverting {
        /// Pages that are exchanged.
        pages: u8,
        /// Copies that are finished, two a page.
        step: u8,
    },
    /// The old program is back: the new one did not confirm itself.
    Reverted,
    /// The program that waited was not taken.
    Refused(Refusal),
}

impl State {
    fn parts(self) -> [u8; 3] {
        match self {
            State::Idle => [0, 0, 0],
            State::Requested => [1, 0, 0],
            State::Exchanging { pages, step } => [2, pages, step],
            State::Installed { pages } => [3, pages, 0],
            State::OnTrial { pages } => [4, pages, 0],
            State::Confirmed => [5, 0, 0],
            State::Reverting { pages, step } => [6, pages, step],
            State::Reverted => [7, 0, 0],
            State::Refused(refusal) => [8, 0, refusal as u8],
        }
    }

    fn of_parts([kind, pages, step]: [u8; 3]) -> Option<Self> {
        if u32::from(pages) > PROGRAM_PAGES {
            return None;
        }
        Some(match kind {
            0 => State::Idle,
            1 => State::Requested,
            2 => State::Exchanging { pages, step },
            3 => State::Installed { pages },
            4 => State::OnTrial { pages },
            5 => State::Confirmed,
            6 => State::Reverting { pages, step },
            7 => State::Reverted,
            8 => State::Refused(Refusal::by_number(step)?),
            _ => return None,
        })
    }

    /// Word for flash: number 12 bits, kind 4, pages 8, step 8, then their checksum.
    fn to_bytes(self, number: u32) -> [u8; 8] {
        let [kind, pages, step] = self.parts().map(u32::from);
        let content = number << 20 | kind << 16 | pages << 8 | step;
        let mut bytes = [0; 8];
        let (low, high) = bytes.split_at_mut(4);
        low.copy_from_slice(&content.to_le_bytes());
        high.copy_from_slice(&CRC.checksum(&content.to_le_bytes()).to_le_bytes());
        bytes
    }

    fn of_bytes(bytes: [u8; 8]) -> Option<(u32, Self)> {
        let [a, b, c, d, checksum @ ..] = bytes;
        let content = u32::from_le_bytes([a, b, c, d]);
        let parts = [content >> 16 & 0xF, content >> 8 & 0xFF, content & 0xFF];
        // A blank word is none already here: an ordinary start does not wait for five hundred checksums.
        let state = State::of_parts(parts.map(|part| part as u8))?;
        let whole = CRC.checksum(&[a, b, c, d]) == u32::from_le_bytes(checksum);
        whole.then_some((content >> 20, state))
    }
}

/// Why the journal was not read or written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JournalError {
    /// The flash refused.
    Flash,
    /// What was read back is not what was written.
    Verify,
}

/// The newest state, and where the next one goes.
#[derive(Clone, Copy)]
struct Newest {
    place: u32,
    number: u32,
    state: State,
}

/// The journal in a flash from byte `first` on, a page's beginning.
pub struct Journal {
    first: u32,
    newest: Option<Newest>,
}

impl Journal {
    /// Reads all places.
    ///
    /// # Errors
    /// The flash cannot be read.
    pub fn open<F: NorFlash>(flash: &mut F, first: u32) -> Result<Self, JournalError> {
        let mut journal = Journal {
            first,
            newest: None,
        };
        for place in 0..JOURNAL_PAGES * PLACES {
            let Some((number, state)) = State::of_bytes(journal.read(flash, place)?) else {
                continue;
            };
            if journal
                .newest
                .is_none_or(|newest| is_newer(number, newest.number))
            {
                journal.newest = Some(Newest {
                    place,
                    number,
                    state,
                });
            }
        }
        Ok(journal)
    }

    /// The state that holds.
    pub fn state(&self) -> State {
        self.newest.map_or(State::Idle, |newest| newest.state)
    }

    /// Writes a state behind the newest one and reads it back. A place that refuses is passed over.
    ///
    /// # Errors
    /// It was not written; the state before holds on.
    pub fn write<F: NorFlash>(&mut self, flash: &mut F, state: State) -> Result<(), JournalError> {
        let number = self
            .newest
            .map_or(0, |newest| (newest.number + 1) % NUMBERS);
        let bytes = state.to_bytes(number);
        let (page, first) = self.newest.map_or((0, 0), |newest| {
            (newest.place / PLACES, newest.place % PLACES + 1)
        });
        for place in page * PLACES + first..(page + 1) * PLACES {
            if self.read(flash, place)? == BLANK && self.put(flash, place, bytes).is_ok() {
                self.newest = Some(Newest {
                    place,
                    number,
                    state,
                });
                return Ok(());
            }
        }
        let other = (page + 1) % JOURNAL_PAGES;
        let from = self.first + other * PAGE_BYTES;
        let erased = flash.erase(from, from + PAGE_BYTES);
        erased.map_err(|_| JournalError::Flash)?;
        self.put(flash, other * PLACES, bytes)?;
        self.newest = Some(Newest {
            place: other * PLACES,
            number,
            state,
        });
        Ok(())
    }

    fn put<F: NorFlash>(
        &self,
        flash: &mut F,
        place: u32,
        bytes: [u8; 8],
    ) -> Result<(), JournalError> {
        let written = flash.write(self.first + place * WORD_BYTES, &bytes);
        written.map_err(|_| JournalError::Flash)?;
        let whole = self.read(flash, place)? == bytes;
        whole.then_some(()).ok_or(JournalError::Verify)
    }

    fn read<F: NorFlash>(&self, flash: &mut F, place: u32) -> Result<[u8; 8], JournalError> {
        let mut bytes = [0; 8];
        let read = flash.read(self.first + place * WORD_BYTES, &mut bytes);
        match read.map_err(|error| error.kind()) {
            Ok(()) => Ok(bytes),
            // A place of its own that cannot be read holds no state.
            Err(NorFlashErrorKind::Other) => Ok([0; 8]),
            Err(_) => Err(JournalError::Flash),
        }
    }
}

/// Numbers count modulo [`NUMBERS`], and two that are in flash are less than half of it apart.
fn is_newer(number: u32, than: u32) -> bool {
    let ahead = (number + NUMBERS - than) % NUMBERS;
    ahead != 0 && ahead < NUMBERS / 2
}
