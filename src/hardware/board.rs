//! Which pin does what. The same table with the wiring is in docs/wiring.md.
//!
//! | pin  | function | notes |
//! |------|----------|-------|
//! | PA0  | phase voltage a | ADC1 channel 1, first in the sequence |
//! | PA1  | phase current a | ADC1 channel 2 |
//! | PC0  | phase voltage b | ADC1 channel 6 |
//! | PC1  | phase current b | ADC1 channel 7 |
//! | PC2  | phase voltage c | ADC1 channel 8 |
//! | PC3  | phase current c | ADC1 channel 9 |
//! | PC6  | encoder A | TIM3 channel 1, pull-up: not for 5 V |
//! | PC7  | encoder B | TIM3 channel 2, pull-up: not for 5 V |
//! | PC8  | lamp RUN (green) | high is on |
//! | PB11..PB14 | lamps r1..r4 (yellow) | high is on |
//! | PB15 | lamp SENSOR (blue) | high is on |
//! | PC9  | lamp LINE (white) | high is on |
//! | PC4  | lamp LOAD (yellow) | high is on |
//! | PC5  | lamp FAULT (red) | high is on |
//! | PA2  | frames to the virtual COM port | LPUART1, 115200 8N1 |
//! | PA9  | RS-485 data to the transceiver (DI) | USART1, 19200 8E1 |
//! | PA10 | RS-485 data from the transceiver (RO) | USART1 |
//! | PA12 | RS-485 driver enable (DE and /RE) | USART1, high while sending |
//! | PA8  | relay, through a charge pump | toggled while energised |
//! | PB10 | contact of the relay | closed is low, pull-up |
//! | PC13 | button B1 of the NUCLEO | high is pressed |

use embassy_stm32::gpio::{Input, Level, Output, Pull, Speed};
use embassy_stm32::peripherals::{ADC5, FLASH, IWDG};
use embassy_stm32::{Peri, Peripherals};

use super::encoder::Encoder;
use super::lamps::{Lamps, RelayWires};
use super::sampling::Sources;
use super::serial::Lines;

/// The peripherals, by what they are for.
pub struct Board {
    /// ADC, its pins, trigger timer and DMA.
    pub sources: Sources,
    /// The lamps.
    pub lamps: Lamps,
    /// The relay and its contact.
    pub relay: RelayWires,
    /// Acknowledge, lamp mode.
    pub button: Input<'static>,
    /// Converter of the chip's own reference.
    pub housekeeping: Peri<'static, ADC5>,
    /// Flash with the calibration.
    pub flash: Peri<'static, FLASH>,
    /// Modbus and frames.
    pub lines: Lines,
    /// Watchdog.
    pub watchdog: Peri<'static, IWDG>,
}

impl Board {
    /// Deals out the peripherals; all lamps are dark.
    pub fn new(p: Peripherals) -> Self {
        Board {
            sources: Sources {
                adc: p.ADC1,
                adc_dma: p.DMA1_CH1,
                pins: (p.PA0, p.PA1, p.PC0, p.PC1, p.PC2, p.PC3),
                trigger: p.TIM4,
                encoder_dma: p.DMA1_CH2,
                _encoder: Encoder::new(p.TIM3, p.PC6, p.PC7),
            },
            lamps: Lamps::new([
                lamp(p.PC8),
                lamp(p.PB11),
                lamp(p.PB12),
                lamp(p.PB13),
                lamp(p.PB14),
                lamp(p.PB15),
                lamp(p.PC9),
                lamp(p.PC4),
                lamp(p.PC5),
            ]),
            relay: RelayWires::new(
                Output::new(p.PA8, Level::Low, Speed::Low),
                Input::new(p.PB10, Pull::Up),
            ),
            button: Input::new(p.PC13, Pull::None),
            housekeeping: p.ADC5,
            flash: p.FLASH,
            lines: Lines {
                modbus: (p.USART1, p.PA10, p.PA9, p.PA12),
                frames: (p.LPUART1, p.PA2, p.DMA1_CH3),
            },
            watchdog: p.IWDG,
        }
    }
}

fn lamp(pin: Peri<'static, impl embassy_stm32::gpio::Pin>) -> Output<'static> {
    Output::new(pin, Level::Low, Speed::Low)
}
