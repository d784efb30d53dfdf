//! A chip's flash for tests: power can fail at every step, with the torn cell contents that silicon leaves.

use std::vec;
use std::vec::Vec;

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

use crate::calibration::PAGE_BYTES;

/// Flash as in the reference manual: erased to ones by page, programmed once per double word.
#[derive(Clone)]
pub(crate) struct Chip {
    pub bytes: Vec<u8>,
    /// Double words programmed and pages erased before power fails.
    pub steps_left: u32,
    /// What a torn step leaves: random bits.
    pub noise: u64,
    pub erasures: u32,
}

#[derive(Debug)]
pub(crate) struct PowerFailed;

impl NorFlashError for PowerFailed {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl Chip {
    pub fn new(pages: u32) -> Self {
        Chip {
            bytes: vec![0xFF; (pages * PAGE_BYTES) as usize],
            steps_left: u32::MAX,
            noise: 1,
            erasures: 0,
        }
    }

    pub fn random(&mut self) -> u8 {
        // Knuth's 64-bit linear congruential generator.
        self.noise = self
            .noise
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.noise >> 56) as u8
    }

    fn step(&mut self) -> bool {
        let whole = self.steps_left > 0;
        self.steps_left = self.steps_left.saturating_sub(1);
        whole
    }
}

impl ErrorType for Chip {
    type Error = PowerFailed;
}

impl ReadNorFlash for Chip {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerFailed> {
        let from = offset as usize;
        bytes.copy_from_slice(&self.bytes[from..from + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Chip {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE_BYTES as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), PowerFailed> {
        assert_eq!((from % PAGE_BYTES, to - from), (0, PAGE_BYTES));
        self.erasures += 1;
        let whole = self.step();
        for k in from as usize..to as usize {
            self.bytes[k] |= if whole { 0xFF } else { self.random() };
        }
        if whole { Ok(()) } else { Err(PowerFailed) }
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerFailed> {
        assert!(offset.is_multiple_of(8) && bytes.len().is_multiple_of(8));
        let places = (offset as usize..).step_by(8);
        for (at, word) in places.zip(bytes.chunks(8)) {
            let blank = self.bytes[at..at + 8].iter().all(|byte| *byte == 0xFF);
            assert!(blank, "a double word may be programmed once");
            let whole = self.step();
            for (k, byte) in word.iter().enumerate() {
                self.bytes[at + k] &= byte | if whole { 0 } else { self.random() };
            }
            if !whole {
                return Err(PowerFailed);
            }
        }
        Ok(())
    }
}
