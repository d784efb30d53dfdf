//! SENSOR (PB15) and FAULT (PC5): there is no program.

use stm32_metapac::gpio::vals::Moder;
use stm32_metapac::{GPIOB, GPIOC, RCC};

use crate::watchdog;

/// Lights both and waits for ever: for a programmer.
pub fn show_no_program() -> ! {
    RCC.ahb2enr().modify(|w| {
        w.set_gpioben(true);
        w.set_gpiocen(true);
    });
    // A peripheral answers two cycles after its clock.
    let _ = RCC.ahb2enr().read();
    for (port, pin) in [(GPIOB, 15), (GPIOC, 5)] {
        port.moder().modify(|w| w.set_moder(pin, Moder::OUTPUT));
        port.bsrr().write(|w| w.set_bs(pin, true));
    }
    loop {
        watchdog::feed();
    }
}
