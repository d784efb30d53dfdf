//! Where the calibration lies: the last two pages of bank 2, away from the program, which runs on from bank 1.

use board::{PAGE_BYTES, PAGES, Store};
use embassy_stm32::Peri;
use embassy_stm32::flash::{Blocking, Error, Flash};
use embassy_stm32::pac;
use embassy_stm32::peripherals::FLASH;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

/// Bytes of the chip's flash.
const FLASH_BYTES: u32 = 512 * 1024;
/// Level of the voltage detector, about 2.9 V: below it nothing is begun that a brown-out would cut off.
const DETECTOR_LEVEL: u8 = 6;

/// The calibration in this chip's flash.
pub type FlashStore = Store<GuardedFlash>;

/// Opens the store. `None` on a chip whose option bytes join the banks: its pages are others, and the driver would panic.
pub fn open(flash: Peri<'static, FLASH>) -> Option<FlashStore> {
    pac::PWR.cr2().modify(|w| {
        w.set_pls(DETECTOR_LEVEL);
        w.set_pvde(true);
    });
    let two_banks = pac::FLASH.optr().read().dbank();
    two_banks.then(|| {
        let flash = GuardedFlash(Flash::new_blocking(flash));
        Store::new(flash, FLASH_BYTES - PAGES * PAGE_BYTES)
    })
}

/// Flash that is neither erased nor programmed while the supply is low.
pub struct GuardedFlash(Flash<'static, Blocking>);

/// Why flash was not read, erased or programmed.
#[derive(Debug)]
pub enum FlashError {
    /// The supply is below the voltage detector's level.
    LowSupply,
    /// The driver's.
    Driver(Error),
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            FlashError::LowSupply => NorFlashErrorKind::Other,
            FlashError::Driver(error) => error.kind(),
        }
    }
}

/// Whether the supply is below the voltage detector's level.
pub fn is_supply_low() -> bool {
    pac::PWR.sr2().read().pvdo()
}

fn supplied() -> Result<(), FlashError> {
    match is_supply_low() {
        true => Err(FlashError::LowSupply),
        false => Ok(()),
    }
}

impl ErrorType for GuardedFlash {
    type Error = FlashError;
}

impl ReadNorFlash for GuardedFlash {
    const READ_SIZE: usize = <Flash<'static, Blocking> as ReadNorFlash>::READ_SIZE;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        ReadNorFlash::read(&mut self.0, offset, bytes).map_err(FlashError::Driver)
    }

    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl NorFlash for GuardedFlash {
    const WRITE_SIZE: usize = <Flash<'static, Blocking> as NorFlash>::WRITE_SIZE;
    const ERASE_SIZE: usize = <Flash<'static, Blocking> as NorFlash>::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        supplied()?;
        NorFlash::erase(&mut self.0, from, to).map_err(FlashError::Driver)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        supplied()?;
        NorFlash::write(&mut self.0, offset, bytes).map_err(FlashError::Driver)
    }
}
