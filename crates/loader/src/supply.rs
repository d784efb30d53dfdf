//! The voltage detector: flash is neither erased nor programmed while the supply is low (as src/hardware/flash_store.rs).

use stm32_metapac::{PWR, RCC};

/// About 2.9 V: below it nothing is begun that a brown-out would cut off.
const DETECTOR_LEVEL: u8 = 6;

/// Switches it on.
pub fn watch() {
    RCC.apb1enr1().modify(|w| w.set_pwren(true));
    // A peripheral answers two cycles after its clock.
    let _ = RCC.apb1enr1().read();
    PWR.cr2().modify(|w| {
        w.set_pls(DETECTOR_LEVEL);
        w.set_pvde(true);
    });
}

/// As after a reset.
pub fn unwatch() {
    PWR.cr2().modify(|w| {
        w.set_pls(0);
        w.set_pvde(false);
    });
    RCC.apb1enr1().modify(|w| w.set_pwren(false));
}

/// Whether the supply is below the level.
pub fn is_low() -> bool {
    PWR.sr2().read().pvdo()
}
