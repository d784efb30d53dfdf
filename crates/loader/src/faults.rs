//! How the loader ends, and the one fault that it survives: a double word of flash whose programming was cut off.
// Handlers of the processor.
#![allow(unsafe_code)]

use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use stm32_metapac::FLASH;
use update::layout::{BANK_BYTES, LOADER_BYTES};

/// Reading such a word raises this, until the flag is cleared. What was read is wrong, and a checksum finds it. The loader
/// itself is not executed with wrong bits.
#[exception]
unsafe fn NonMaskableInt() {
    let error = FLASH.eccr().read();
    let outside = error.bk_ecc() || error.addr_ecc() % BANK_BYTES >= LOADER_BYTES;
    if !error.eccd() || !outside {
        SCB::sys_reset();
    }
    FLASH.eccr().modify(|w| w.set_eccd(true));
}

#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    SCB::sys_reset()
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    SCB::sys_reset()
}
