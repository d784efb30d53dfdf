//! Where the calibration lies: the last two pages of bank 2, away from the program, which runs on from bank 1.

use board::{PAGE_BYTES, PAGES, Store};
use embassy_stm32::Peri;
use embassy_stm32::flash::{Blocking, Flash};
use embassy_stm32::pac;
use embassy_stm32::peripherals::FLASH;

/// Bytes of the chip's flash.
const FLASH_BYTES: u32 = 512 * 1024;

/// The calibration in this chip's flash.
pub type FlashStore = Store<Flash<'static, Blocking>>;

/// Opens the store. `None` on a chip whose option bytes join the banks: its pages are others, and the driver would panic.
pub fn open(flash: Peri<'static, FLASH>) -> Option<FlashStore> {
    let two_banks = pac::FLASH.optr().read().dbank();
    two_banks.then(|| Store::new(Flash::new_blocking(flash), FLASH_BYTES - PAGES * PAGE_BYTES))
}
