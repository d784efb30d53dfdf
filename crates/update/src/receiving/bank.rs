//! Bank 2 for tests: it erases in the background, refuses to be programmed twice, and loses its power at any word.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

use super::background::BackgroundFlash;
use crate::key::SIGNATURE_BYTES;
use crate::layout::{BANK_BYTES, PAGE_BYTES, WAITING, WAITING_PAGES};
use crate::seal::{SEAL_MAGIC, SEAL_OFFSET};

/// Looks at a page that is being erased before it is done: some 22 ms in blocks of 3.2 ms.
const ERASING_LOOKS: u32 = 7;

/// Bank 2. Everything that would hold up the samples is asserted against.
pub struct Bank {
    pub bytes: Vec<u8>,
    pub erasing: Option<(usize, u32)>,
    /// Words that are programmed before power fails.
    pub words_left: usize,
    /// Words and bytes since the last look at them.
    pub written: usize,
    pub read: usize,
    pub erasures: usize,
    pub supplied: bool,
}

#[derive(Debug)]
pub struct Failed;

impl NorFlashError for Failed {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl Bank {
    /// What was there before is nothing that a transfer may rely on.
    pub fn used() -> Self {
        Bank {
            bytes: (0..BANK_BYTES).map(|k| (k * 7 + 3) as u8).collect(),
            erasing: None,
            words_left: usize::MAX,
            written: 0,
            read: 0,
            erasures: 0,
            supplied: true,
        }
    }

    fn at(offset: u32) -> usize {
        (offset - WAITING) as usize
    }
}

impl ErrorType for Bank {
    type Error = Failed;
}

impl ReadNorFlash for Bank {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Failed> {
        assert_eq!(self.erasing, None, "the program would stall");
        self.read += bytes.len();
        let from = Self::at(offset);
        bytes.copy_from_slice(&self.bytes[from..from + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        (WAITING + BANK_BYTES) as usize
    }
}

impl NorFlash for Bank {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE_BYTES as usize;

    fn erase(&mut self, _: u32, _: u32) -> Result<(), Failed> {
        panic!("22 ms in which the program stands still");
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Failed> {
        assert_eq!(self.erasing, None, "the program would stall");
        assert!(self.supplied, "a brown-out would cut this off");
        assert!(offset.is_multiple_of(8) && bytes.len().is_multiple_of(8));
        for (at, word) in (Self::at(offset)..).step_by(8).zip(bytes.chunks(8)) {
            let places = &mut self.bytes[at..at + 8];
            assert_eq!(places, [0xFF; 8], "a double word may be programmed once");
            self.written += 1;
            if self.words_left == 0 {
                // Torn: some bits of it.
                places
                    .iter_mut()
                    .zip(word)
                    .for_each(|(to, from)| *to &= from | 0x5A);
                return Err(Failed);
            }
            self.words_left -= 1;
            places.copy_from_slice(word);
        }
        Ok(())
    }
}

impl BackgroundFlash for Bank {
    fn is_ready(&mut self) -> bool {
        match &mut self.erasing {
            None => self.supplied,
            Some((page, 0)) => {
                let first = *page * PAGE_BYTES as usize;
                self.bytes[first..first + PAGE_BYTES as usize].fill(0xFF);
                self.erasing = None;
                self.supplied
            }
            Some((_, looks)) => {
                *looks -= 1;
                false
            }
        }
    }

    fn begin_erase(&mut self, offset: u32) {
        assert_eq!(self.erasing, None);
        assert!(self.supplied && offset.is_multiple_of(PAGE_BYTES));
        let page = Self::at(offset) / PAGE_BYTES as usize;
        assert!(page < WAITING_PAGES as usize, "others lie there");
        self.erasures += 1;
        self.erasing = Some((page, ERASING_LOOKS));
    }
}

/// A sealed program of this many bytes, and a signature's place.
pub fn package(length: usize, board: u32, version: u32) -> Vec<u8> {
    let mut program: Vec<u8> = (0..length)
        .map(|k| (k % 251) as u8 ^ version as u8)
        .collect();
    let words = [SEAL_MAGIC, length as u32, 0, version, board];
    for (k, word) in words.into_iter().enumerate() {
        program[SEAL_OFFSET + 4 * k..][..4].copy_from_slice(&word.to_le_bytes());
    }
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    let counted = [&program[..SEAL_OFFSET + 4], &program[SEAL_OFFSET + 12..]].concat();
    let checksum = crc.checksum(&counted).to_le_bytes();
    program[SEAL_OFFSET + 8..][..4].copy_from_slice(&checksum);
    program.extend((0..SIGNATURE_BYTES).map(|k| k as u8));
    program
}
