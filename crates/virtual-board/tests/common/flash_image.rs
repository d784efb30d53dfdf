//! Bytes of flash as something that can be read; nothing here is ever written.

use std::convert::Infallible;

use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

/// A copy of flash.
pub struct FlashImage(pub Vec<u8>);

impl ErrorType for FlashImage {
    type Error = Infallible;
}

impl ReadNorFlash for FlashImage {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Infallible> {
        let from = offset as usize;
        bytes.copy_from_slice(&self.0[from..from + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl NorFlash for FlashImage {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = 2048;

    fn erase(&mut self, _: u32, _: u32) -> Result<(), Infallible> {
        unreachable!("only the board writes")
    }

    fn write(&mut self, _: u32, _: &[u8]) -> Result<(), Infallible> {
        unreachable!("only the board writes")
    }
}
