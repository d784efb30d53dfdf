//! The independent watchdog, where an option byte has hardware start it: after a reset it waits for half a second, which
//! is too short for checking a signature.

use stm32_metapac::iwdg::vals::{Key, Pr};
use stm32_metapac::{FLASH, IWDG};

/// The most that it counts, also after a reset.
const COUNTS: u16 = 0xFFF;

/// Its longest time: 32.8 s at 32 kHz.
pub fn extend() {
    set(Pr::DIVIDE_BY256);
}

/// Its time after a reset: 0.5 s.
pub fn restore() {
    set(Pr::DIVIDE_BY4);
}

/// Feeds it; where it does not run, nothing happens.
pub fn feed() {
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}

/// Without its oscillator a setting would never take effect.
fn runs() -> bool {
    !FLASH.optr().read().idwg_sw()
}

fn set(prescaler: Pr) {
    if !runs() {
        return;
    }
    feed();
    settle();
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.pr().write(|w| w.set_pr(prescaler));
    IWDG.rlr().write(|w| w.set_rl(COUNTS));
    settle();
    feed();
}

/// Until what was set has reached the other oscillator.
fn settle() {
    while IWDG.sr().read().0 != 0 {}
}
