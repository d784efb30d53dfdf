//! A flash as the chip has it: 2 KiB pages, double words that are written once, and power that fails within a step.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use update::MappedFlash;
use update::layout::PAGE_BYTES;

const BYTES: usize = 512 * 1024;

/// Why flash did not do as it was told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// Power is gone: nothing more is done until it is back.
    Power,
    /// A word is written where one is already.
    Written,
    /// A worn page.
    Refused,
}

impl NorFlashError for Failure {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

/// The array, and how many steps are left until power fails.
#[derive(Clone)]
pub struct Flash {
    pub bytes: Vec<u8>,
    /// Double words that were programmed since their page was erased, even with ones.
    written: Vec<bool>,
    pub steps_left: Option<u32>,
    pub steps: u32,
    /// The step that is refused once although there is power.
    pub refused_step: Option<u32>,
    has_power: bool,
    noise: u64,
}

impl Flash {
    pub fn blank() -> Self {
        Flash {
            bytes: vec![0xFF; BYTES],
            written: vec![false; BYTES / 8],
            steps_left: None,
            steps: 0,
            refused_step: None,
            has_power: true,
            noise: 0x9E37_79B9_7F4A_7C15,
        }
    }

    pub fn put(&mut self, at: u32, bytes: &[u8]) {
        let at = at as usize;
        self.bytes[at..at + bytes.len()].copy_from_slice(bytes);
        self.written[at / 8..(at + bytes.len()).div_ceil(8)].fill(true);
    }

    pub fn power_on(&mut self) {
        self.has_power = true;
        self.steps_left = None;
    }

    /// Each cut tears differently.
    pub fn seed(&mut self, seed: u64) {
        self.noise = self
            .noise
            .wrapping_add(seed.wrapping_mul(0xD129_0DDA_53C4_3E49));
    }

    fn random(&mut self) -> u64 {
        // Knuth's 64-bit linear congruential generator; its high bits.
        self.noise = self
            .noise
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.noise ^ self.noise >> 32
    }

    /// `Err` where power fails within this step or is gone.
    fn step(&mut self) -> Result<(), Failure> {
        if !self.has_power {
            return Err(Failure::Power);
        }
        self.steps += 1;
        if self.refused_step.take_if(|at| *at == self.steps).is_some() {
            return Err(Failure::Refused);
        }
        match &mut self.steps_left {
            Some(0) => {
                self.has_power = false;
                Err(Failure::Power)
            }
            Some(left) => {
                *left -= 1;
                Ok(())
            }
            None => Ok(()),
        }
    }

    fn erase_page(&mut self, page: usize) -> Result<(), Failure> {
        let range = page * PAGE_BYTES as usize..(page + 1) * PAGE_BYTES as usize;
        let whole = self.has_power && self.steps_left != Some(0);
        if whole {
            self.bytes[range.clone()].fill(0xFF);
            self.written[range.start / 8..range.end / 8].fill(false);
        } else if self.has_power {
            // An erasure that was cut off leaves anything.
            for at in range {
                self.bytes[at] |= self.random() as u8;
            }
        }
        self.step()
    }

    fn program(&mut self, at: usize, word: &[u8; 8]) -> Result<(), Failure> {
        if self.has_power && self.written[at / 8] {
            return Err(Failure::Written);
        }
        let whole = self.has_power && self.steps_left != Some(0);
        let kept = if whole { 0 } else { self.random() };
        if self.has_power {
            for (k, byte) in word.iter().enumerate() {
                self.bytes[at + k] &= byte | kept.to_le_bytes()[k];
            }
            // Even a word that reads blank may have been begun.
            self.written[at / 8] = true;
        }
        self.step()
    }
}

impl ErrorType for Flash {
    type Error = Failure;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, at: u32, bytes: &mut [u8]) -> Result<(), Failure> {
        let at = at as usize;
        bytes.copy_from_slice(&self.bytes[at..at + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE_BYTES as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Failure> {
        (from / PAGE_BYTES..to / PAGE_BYTES).try_for_each(|page| self.erase_page(page as usize))
    }

    fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), Failure> {
        let (words, rest) = bytes.as_chunks::<8>();
        assert!(rest.is_empty() && at.is_multiple_of(8));
        let places = (at as usize..).step_by(8);
        places
            .zip(words)
            .try_for_each(|(at, word)| self.program(at, word))
    }
}

impl MappedFlash for Flash {
    fn bytes(&self, from: u32, length: u32) -> &[u8] {
        &self.bytes[from as usize..(from + length) as usize]
    }
}
