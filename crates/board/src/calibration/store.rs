//! Two flash pages that hold the newest calibration whatever a reset interrupts.
//!
//! Records are appended; a page is erased only while the newest record lies whole in the other one. So a reset in the
//! middle of a write leaves the old record, and the CRC tells a half-written one from a whole one. Twelve records fit a
//! page, and every page stands 10 000 erasures: 240 000 calibrations.
//!
//! Own code although key-value stores for flash exist (`sequential-storage`): for one record their maps, caches and
//! repairs are several times this code, and their way of erasing would have to be proved as this one is.

use embedded_storage::nor_flash::NorFlash;

use super::Calibration;
use super::record::{Found, RECORD_BYTES, Record};

/// Bytes of a page.
pub const PAGE_BYTES: u32 = 2048;
/// Pages of the store.
pub const PAGES: u32 = 2;
const PLACES: u32 = PAGE_BYTES / RECORD_BYTES as u32;

/// What the store holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loaded {
    /// The newest whole calibration.
    pub newest: Option<Calibration>,
    /// There is no whole record although something was written once.
    pub lost: bool,
}

/// Why a calibration was not stored. The old one holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError {
    /// The flash refused to be read, erased or programmed.
    Flash,
    /// What was read back is not what was written.
    Verify,
}

/// The store in a flash from byte `first` on, a page's beginning.
pub struct Store<F> {
    flash: F,
    first: u32,
}

/// Where the newest record lies.
#[derive(Clone, Copy)]
struct Newest {
    page: u32,
    place: u32,
    record: Record,
}

/// A look at all places.
struct Survey {
    newest: Option<Newest>,
    damaged: bool,
}

impl<F: NorFlash> Store<F> {
    /// Neither reads nor writes yet.
    pub fn new(flash: F, first: u32) -> Self {
        Store { flash, first }
    }

    /// Reads the newest calibration.
    ///
    /// # Errors
    /// The flash cannot be read.
    pub fn load(&mut self) -> Result<Loaded, StoreError> {
        let survey = self.survey()?;
        Ok(Loaded {
            newest: survey.newest.map(|newest| newest.record.calibration),
            lost: survey.newest.is_none() && survey.damaged,
        })
    }

    /// Stores a calibration behind the newest one and reads it back.
    ///
    /// # Errors
    /// It was not stored; what held before holds on.
    pub fn save(&mut self, calibration: &Calibration) -> Result<(), StoreError> {
        let newest = self.survey()?.newest;
        let (page, place) = self.free_place(newest)?;
        let sequence = newest.map_or(0, |newest| newest.record.sequence.wrapping_add(1));
        let record = Record::new(sequence, *calibration);
        let bytes = record.to_bytes().ok_or(StoreError::Verify)?;
        let written = self.flash.write(self.address(page, place), &bytes);
        written.map_err(|_| StoreError::Flash)?;
        let mut found = [0; RECORD_BYTES];
        self.read_bytes(page, place, &mut found)?;
        (found == bytes).then_some(()).ok_or(StoreError::Verify)
    }

    #[inline(never)]
    fn survey(&mut self) -> Result<Survey, StoreError> {
        let mut survey = Survey {
            newest: None,
            damaged: false,
        };
        for page in 0..PAGES {
            for place in 0..PLACES {
                match self.read(page, place)? {
                    Found::Blank => {}
                    Found::Damaged => survey.damaged = true,
                    Found::Record(record) => survey.take(Newest {
                        page,
                        place,
                        record,
                    }),
                }
            }
        }
        Ok(survey)
    }

    /// The first blank place behind the newest record, or the first of the other page, freshly erased.
    fn free_place(&mut self, newest: Option<Newest>) -> Result<(u32, u32), StoreError> {
        let (page, first) = newest.map_or((0, 0), |newest| (newest.page, newest.place + 1));
        for place in first..PLACES {
            if self.read(page, place)? == Found::Blank {
                return Ok((page, place));
            }
        }
        let other = (page + 1) % PAGES;
        let (from, to) = (self.address(other, 0), self.address(other, 0) + PAGE_BYTES);
        self.flash.erase(from, to).map_err(|_| StoreError::Flash)?;
        Ok((other, 0))
    }

    #[inline(never)]
    fn read(&mut self, page: u32, place: u32) -> Result<Found, StoreError> {
        let mut bytes = [0; RECORD_BYTES];
        self.read_bytes(page, place, &mut bytes)?;
        Ok(Found::read(&bytes))
    }

    fn read_bytes(
        &mut self,
        page: u32,
        place: u32,
        bytes: &mut [u8; RECORD_BYTES],
    ) -> Result<(), StoreError> {
        let read = self.flash.read(self.address(page, place), bytes);
        read.map_err(|_| StoreError::Flash)
    }

    fn address(&self, page: u32, place: u32) -> u32 {
        self.first + page * PAGE_BYTES + place * RECORD_BYTES as u32
    }
}

impl Survey {
    fn take(&mut self, candidate: Newest) {
        let newer = |known: &Newest| known.record.sequence < candidate.record.sequence;
        if self.newest.as_ref().is_none_or(newer) {
            self.newest = Some(candidate);
        }
    }
}

#[cfg(test)]
mod tests;
