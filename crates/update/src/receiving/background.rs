//! Flash that erases while the program goes on.

use embedded_storage::nor_flash::NorFlash;

/// Flash in the bank that the program does not run from.
pub trait BackgroundFlash: NorFlash {
    /// Whether something can be read, erased or programmed now: nothing is being erased, and the supply is good.
    fn is_ready(&mut self) -> bool;

    /// Begins to erase the page at `offset`.
    fn begin_erase(&mut self, offset: u32);
}
