//! Settings of the peripherals that samples depend on: remembered when acquisition starts, read back every second.

use board::crc32_words;
use embassy_stm32::pac;

/// Checksum of the settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Settings(u32);

impl Settings {
    /// Reads them all: sequence and times of the converter, DMA, trigger, encoder, modes of the pins, clocks.
    pub fn read() -> Self {
        let (adc, dma, ports) = (pac::ADC1, pac::DMA1, [pac::GPIOA, pac::GPIOB, pac::GPIOC]);
        let words = [
            adc.cfgr().read().0,
            adc.sqr1().read().0,
            adc.sqr2().read().0,
            adc.smpr().read().0,
            adc.smpr2().read().0,
            dma.ch(0).cr().read().0,
            dma.ch(1).cr().read().0,
            pac::TIM4.arr().read().0,
            pac::TIM4.psc().read().into(),
            pac::TIM4.cr2().read().0,
            pac::TIM4.dier().read().0,
            pac::TIM3.smcr().read().0,
            pac::TIM3.ccmr_input(0).read().0,
            pac::RCC.cfgr().read().0,
            pac::RCC.pllcfgr().read().0,
        ];
        let modes = ports.map(|port| port.moder().read().0);
        Settings(crc32_words(&words) ^ crc32_words(&modes).rotate_left(1))
    }
}
