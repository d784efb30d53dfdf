//! Settings of the peripherals that samples depend on: remembered when acquisition starts, read back every second.

use board::crc32_words;
use embassy_stm32::pac;

/// Checksums of the settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    acquisition: u32,
    fixed: u32,
}

impl Settings {
    /// Reads them all: those that every acquisition sets anew, and those that are set once.
    pub fn read() -> Self {
        Settings {
            acquisition: acquisition(),
            fixed: fixed(),
        }
    }

    /// The settings now, with what must not have changed since `first`: a gap in the samples sets acquisition anew and
    /// nothing else.
    pub fn read_after(first: Settings) -> Self {
        Settings {
            fixed: first.fixed,
            ..Settings::read()
        }
    }
}

/// Sequence and times of the converter, DMA, trigger.
fn acquisition() -> u32 {
    let (adc, dma) = (pac::ADC1, pac::DMA1);
    crc32_words(&[
        adc.cfgr().read().0,
        adc.sqr1().read().0,
        adc.sqr2().read().0,
        adc.tr1().read().0,
        adc.smpr().read().0,
        adc.smpr2().read().0,
        dma.ch(0).cr().read().0,
        dma.ch(1).cr().read().0,
        pac::TIM4.arr().read().0,
        pac::TIM4.psc().read().into(),
        pac::TIM4.cr2().read().0,
        pac::TIM4.dier().read().0,
    ])
}

/// Encoder, clocks, modes of the pins.
fn fixed() -> u32 {
    let modes = [pac::GPIOA, pac::GPIOB, pac::GPIOC].map(|port| port.moder().read().0);
    let [a, b, c] = modes;
    crc32_words(&[
        pac::TIM3.smcr().read().0,
        pac::TIM3.ccmr_input(0).read().0,
        pac::RCC.cfgr().read().0,
        pac::RCC.pllcfgr().read().0,
        a,
        b,
        c,
    ])
}
