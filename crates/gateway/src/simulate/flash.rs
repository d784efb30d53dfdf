//! A chip's flash in memory, without its times and its failures.

use std::sync::{Arc, Mutex, PoisonError};

use board::{LOG_PAGES, PAGE_BYTES};
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use update::BackgroundFlash;

/// The pages of the event log; every clone is the same flash.
#[derive(Clone, Debug)]
pub(super) struct Flash(Arc<Mutex<Vec<u8>>>);

/// Outside the flash.
#[derive(Debug)]
pub(super) struct Outside;

impl NorFlashError for Outside {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::OutOfBounds
    }
}

impl Flash {
    /// Erased.
    pub fn new() -> Self {
        let bytes = vec![0xFF; (LOG_PAGES * PAGE_BYTES) as usize];
        Flash(Arc::new(Mutex::new(bytes)))
    }

    /// Copies bytes from `at` on; `false` beyond the end.
    pub fn copy(&self, at: usize, bytes: &mut [u8]) -> bool {
        let end = at + bytes.len();
        self.with(|flash| match flash.get(at..end) {
            Some(source) => {
                bytes.copy_from_slice(source);
                true
            }
            None => false,
        })
    }

    fn with<T>(&self, what: impl FnOnce(&mut Vec<u8>) -> T) -> T {
        what(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl ErrorType for Flash {
    type Error = Outside;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Outside> {
        let inside = self.copy(offset as usize, bytes);
        inside.then_some(()).ok_or(Outside)
    }

    fn capacity(&self) -> usize {
        (LOG_PAGES * PAGE_BYTES) as usize
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE_BYTES as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Outside> {
        self.with(|flash| match flash.get_mut(from as usize..to as usize) {
            Some(pages) => {
                pages.fill(0xFF);
                Ok(())
            }
            None => Err(Outside),
        })
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Outside> {
        let from = offset as usize;
        self.with(|flash| match flash.get_mut(from..from + bytes.len()) {
            Some(place) => {
                place.copy_from_slice(bytes);
                Ok(())
            }
            None => Err(Outside),
        })
    }
}

impl BackgroundFlash for Flash {
    fn is_ready(&mut self) -> bool {
        true
    }

    fn begin_erase(&mut self, offset: u32) {
        // Only pages of this flash are ever entered.
        let _ = self.erase(offset, offset + PAGE_BYTES);
    }
}
