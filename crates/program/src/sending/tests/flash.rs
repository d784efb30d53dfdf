//! Flash of a simulated board: erases in the background, and refuses a word that is written twice.

use std::sync::{Arc, Mutex};

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use update::layout::{BANK_BYTES, PAGE_BYTES};
use update::{BackgroundFlash, MappedFlash};

/// Looks at a page that is being erased before it is done.
const ERASING_LOOKS: u32 = 7;

/// The bytes, and the page that is being erased.
pub struct Bytes {
    pub bytes: Vec<u8>,
    erasing: Option<(usize, u32)>,
}

/// One way to the flash of several.
#[derive(Clone)]
pub struct Chip(Arc<Mutex<Bytes>>);

#[derive(Debug)]
pub struct Failed;

impl NorFlashError for Failed {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl Chip {
    pub fn new() -> Self {
        let bytes = vec![0xFF; 2 * BANK_BYTES as usize];
        Chip(Arc::new(Mutex::new(Bytes {
            bytes,
            erasing: None,
        })))
    }

    /// Everything at once, as the loader has it, before which nothing is being erased.
    pub fn whole<T>(&self, work: impl FnOnce(&mut Bytes) -> T) -> T {
        let mut bytes = self.0.lock().expect("no other test panicked");
        bytes.erasing = None;
        work(&mut bytes)
    }
}

impl ErrorType for Bytes {
    type Error = Failed;
}

impl ReadNorFlash for Bytes {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Failed> {
        bytes.copy_from_slice(&self.bytes[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Bytes {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE_BYTES as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Failed> {
        self.bytes[from as usize..to as usize].fill(0xFF);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Failed> {
        let places = &mut self.bytes[offset as usize..][..bytes.len()];
        if !(offset as usize | bytes.len()).is_multiple_of(8) || places.iter().any(|at| *at != 0xFF)
        {
            return Err(Failed);
        }
        places.copy_from_slice(bytes);
        Ok(())
    }
}

impl MappedFlash for Bytes {
    fn bytes(&self, from: u32, length: u32) -> &[u8] {
        &self.bytes[from as usize..(from + length) as usize]
    }
}

impl ErrorType for Chip {
    type Error = Failed;
}

impl ReadNorFlash for Chip {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Failed> {
        self.0.lock().expect("sound").read(offset, bytes)
    }

    fn capacity(&self) -> usize {
        2 * BANK_BYTES as usize
    }
}

impl NorFlash for Chip {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE_BYTES as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Failed> {
        self.0.lock().expect("sound").erase(from, to)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Failed> {
        self.0.lock().expect("sound").write(offset, bytes)
    }
}

impl BackgroundFlash for Chip {
    fn is_ready(&mut self) -> bool {
        let mut bytes = self.0.lock().expect("sound");
        match bytes.erasing {
            None => true,
            Some((from, 0)) => {
                bytes.bytes[from..from + PAGE_BYTES as usize].fill(0xFF);
                bytes.erasing = None;
                true
            }
            Some((from, looks)) => {
                bytes.erasing = Some((from, looks - 1));
                false
            }
        }
    }

    fn begin_erase(&mut self, offset: u32) {
        self.0.lock().expect("sound").erasing = Some((offset as usize, ERASING_LOOKS));
    }
}
