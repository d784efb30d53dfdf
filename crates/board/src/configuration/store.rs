//! Pages of flash that hold the newest configuration whatever a reset interrupts: a page each, in turns.
//!
//! A record is as large as a quarter of what the stack has left, so it is read and written in pieces.

use embedded_storage::nor_flash::NorFlash;

use super::{CONFIGURATION_WORDS, Configuration};
use crate::calibration::{PAGE_BYTES, StoreError};
use crate::checksum::Checksum;

/// Pages of the store.
pub const PAGES: u32 = 4;
/// Bytes that are read or written at once: four of the double words that flash is programmed in.
const PIECE_BYTES: usize = 32;
const PIECE_WORDS: usize = PIECE_BYTES / 4;
/// Sequence number, and identification of the motor constants that were compiled in.
const HEAD_WORDS: usize = 2;
/// With the checksum behind.
const RECORD_WORDS: usize = (HEAD_WORDS + CONFIGURATION_WORDS + 1).next_multiple_of(PIECE_WORDS);
const PIECES: u32 = (RECORD_WORDS / PIECE_WORDS) as u32;

const _: () = assert!(RECORD_WORDS * 4 <= PAGE_BYTES as usize);

/// What the store holds beside the newest configuration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Confirmed {
    /// Identification of the motor constants that were compiled into the program when it was confirmed; `None` where there is no
    /// whole record.
    pub compiled: Option<u32>,
    /// Something was written that is no whole record.
    pub damaged: bool,
}

/// The store in a flash from byte `first` on, a page's beginning.
pub struct ConfigurationStore<F> {
    flash: F,
    first: u32,
}

/// A look at one page.
enum Page {
    Blank,
    Damaged,
    /// With its sequence number.
    Record(u32),
}

/// Words of a piece.
type Piece = [u32; PIECE_WORDS];

impl<F: NorFlash> ConfigurationStore<F> {
    /// Neither reads nor writes yet.
    pub fn new(flash: F, first: u32) -> Self {
        ConfigurationStore { flash, first }
    }

    /// Reads the newest confirmed configuration; `into` stays as it is where there is none.
    ///
    /// # Errors
    /// The flash cannot be read.
    #[inline(never)]
    pub fn load(&mut self, into: &mut Configuration) -> Result<Confirmed, StoreError> {
        let (newest, damaged) = self.newest()?;
        let mut confirmed = Confirmed {
            compiled: None,
            damaged,
        };
        let Some((page, _)) = newest else {
            return Ok(confirmed);
        };
        let mut places = into.words_mut().iter_mut();
        for k in 0..PIECES {
            let piece = self.read(page, k)?;
            let mut words = piece.as_slice();
            if let (0, [_, compiled, rest @ ..]) = (k, words) {
                confirmed.compiled = Some(*compiled);
                words = rest;
            }
            places
                .by_ref()
                .zip(words)
                .for_each(|(place, word)| *place = *word);
        }
        Ok(confirmed)
    }

    /// Writes a configuration to the page behind the newest and looks whether it is whole. Takes up to 40 ms.
    ///
    /// # Errors
    /// It was not stored; what held before holds on.
    #[inline(never)]
    pub fn save(&mut self, compiled: u32, configuration: &Configuration) -> Result<(), StoreError> {
        let (newest, _) = self.newest()?;
        let (page, sequence) = newest.map_or((0, 0), |(page, sequence)| {
            ((page + 1) % PAGES, sequence.wrapping_add(1))
        });
        let (from, to) = (self.address(page, 0), self.address(page, 0) + PAGE_BYTES);
        self.flash.erase(from, to).map_err(|_| StoreError::Flash)?;
        let head = [sequence, compiled];
        let mut content = head.into_iter().chain(*configuration.words());
        let mut checksum = Checksum::new();
        for k in 0..PIECES {
            let mut piece: Piece = [(); PIECE_WORDS].map(|()| content.next().unwrap_or(0));
            let [words @ .., last] = &mut piece;
            update(&mut checksum, words);
            match k + 1 == PIECES {
                true => *last = core::mem::take(&mut checksum).finish(),
                false => update(&mut checksum, core::slice::from_ref(last)),
            }
            self.write(page, k, &piece)?;
        }
        match self.look(page)? {
            Page::Record(found) if found == sequence => Ok(()),
            _ => Err(StoreError::Verify),
        }
    }

    /// Page and sequence number of the newest record, and whether any page is damaged.
    fn newest(&mut self) -> Result<(Option<(u32, u32)>, bool), StoreError> {
        let (mut newest, mut damaged): (Option<(u32, u32)>, bool) = (None, false);
        for page in 0..PAGES {
            match self.look(page)? {
                Page::Blank => {}
                Page::Damaged => damaged = true,
                Page::Record(sequence) => {
                    if newest.is_none_or(|(_, known)| known < sequence) {
                        newest = Some((page, sequence));
                    }
                }
            }
        }
        Ok((newest, damaged))
    }

    #[inline(never)]
    fn look(&mut self, page: u32) -> Result<Page, StoreError> {
        let (mut checksum, mut sequence, mut blank) = (Checksum::new(), 0, true);
        for k in 0..PIECES {
            let piece = self.read(page, k)?;
            blank &= piece.iter().all(|word| *word == u32::MAX);
            let [first, .., last] = piece;
            if k == 0 {
                sequence = first;
            }
            if k + 1 < PIECES {
                update(&mut checksum, &piece);
                continue;
            }
            let [words @ .., _] = &piece;
            update(&mut checksum, words);
            return Ok(match core::mem::take(&mut checksum).finish() == last {
                true => Page::Record(sequence),
                false if blank => Page::Blank,
                false => Page::Damaged,
            });
        }
        Ok(Page::Damaged)
    }

    fn read(&mut self, page: u32, piece: u32) -> Result<Piece, StoreError> {
        let mut bytes = [0; PIECE_BYTES];
        let read = self.flash.read(self.address(page, piece), &mut bytes);
        read.map_err(|_| StoreError::Flash)?;
        let mut words = [0; PIECE_WORDS];
        let fours = bytes.as_chunks::<4>().0;
        words
            .iter_mut()
            .zip(fours)
            .for_each(|(word, four)| *word = u32::from_le_bytes(*four));
        Ok(words)
    }

    fn write(&mut self, page: u32, piece: u32, words: &Piece) -> Result<(), StoreError> {
        let mut bytes = [0; PIECE_BYTES];
        let (fours, _) = bytes.as_chunks_mut::<4>();
        fours
            .iter_mut()
            .zip(words)
            .for_each(|(four, word)| *four = word.to_le_bytes());
        let written = self.flash.write(self.address(page, piece), &bytes);
        written.map_err(|_| StoreError::Flash)
    }

    #[cfg(test)]
    pub(super) fn into_flash(self) -> F {
        self.flash
    }

    fn address(&self, page: u32, piece: u32) -> u32 {
        self.first + page * PAGE_BYTES + piece * PIECE_BYTES as u32
    }
}

fn update(checksum: &mut Checksum, words: &[u32]) {
    for word in words {
        checksum.update(&word.to_le_bytes());
    }
}

#[cfg(test)]
mod tests;
