//! The clock: a crystal that must oscillate in time, the internal oscillator where it does not, and hardware that watches
//! the crystal from then on.
//!
//! 80 MHz, not 170: no boost of the supply, no half frequency on the way, two wait states, and timers that divide evenly.
//! What runs takes a sixth of it, and up to two thirds where a motor is judged in motion, at two cycles an instruction.

use embassy_stm32::Config;
use embassy_stm32::pac;
use embassy_stm32::rcc::{
    Hse, HseMode, LsConfig, Pll, PllMul, PllPreDiv, PllRDiv, PllSource, Sysclk, mux,
};
use embassy_stm32::time::Hertz;

/// The crystal X3 of the NUCLEO. The internal oscillator is 1 % off, and so would be every measured
/// speed and frequency; residual thresholds lie at 0.3 %.
const CRYSTAL: Hertz = Hertz(24_000_000);
/// Looks at the crystal, 16 cycles apart at 16 MHz: at least 100 ms. Data sheets want 2 ms.
const LOOKS: u32 = 100_000;

/// What the core runs on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum Source {
    /// The crystal.
    Crystal,
    /// The internal oscillator: nothing that is measured holds.
    Internal,
}

/// Starts the crystal; gives up after a tenth of a second, or at once where it has stopped before.
pub fn start(trusts_crystal: bool) -> Source {
    if !trusts_crystal {
        return Source::Internal;
    }
    pac::RCC.cr().modify(|w| w.set_hseon(true));
    for _ in 0..LOOKS {
        if pac::RCC.cr().read().hserdy() {
            return Source::Crystal;
        }
        cortex_m::asm::delay(16);
    }
    pac::RCC.cr().modify(|w| w.set_hseon(false));
    Source::Internal
}

/// 24 MHz / 6 or 16 MHz / 4, x 40 / 2 = 80 MHz for core, timers and converters.
pub fn config(source: Source) -> Config {
    let mut config = Config::default();
    let (hse, pll_source, prediv) = match source {
        Source::Crystal => (
            Some(Hse {
                freq: CRYSTAL,
                mode: HseMode::Oscillator,
            }),
            PllSource::HSE,
            PllPreDiv::DIV6,
        ),
        Source::Internal => (None, PllSource::HSI, PllPreDiv::DIV4),
    };
    config.rcc.hse = hse;
    config.rcc.pll = Some(Pll {
        source: pll_source,
        prediv,
        mul: PllMul::MUL40,
        divp: None,
        divq: None,
        divr: Some(PllRDiv::DIV2),
    });
    config.rcc.sys = Sysclk::PLL1_R;
    config.rcc.hsi48 = None;
    // The calendar counts the low-speed oscillator: the witness of the crystal (src/safety/selftest/clock.rs).
    config.rcc.ls = LsConfig::default_lsi();
    config.rcc.mux.rtcsel = mux::Rtcsel::LSI;
    config.rcc.mux.adc12sel = mux::Adcsel::SYS;
    config.rcc.mux.adc345sel = mux::Adcsel::SYS;
    config
}

/// From now on hardware leaves a crystal that stops and raises the non-maskable interrupt.
pub fn watch(source: Source) {
    if source == Source::Crystal {
        pac::RCC.cr().modify(|w| w.set_csson(true));
    }
}
