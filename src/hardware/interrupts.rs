//! Interrupts of acquisition.

use embassy_stm32::peripherals::{DMA1_CH1, DMA1_CH2};
use embassy_stm32::{bind_interrupts, dma};

use super::ring::HalfFilled;

bind_interrupts!(
    /// Interrupts of the two DMA rings.
    pub struct Irqs {
        DMA1_CHANNEL1 => HalfFilled, dma::InterruptHandler<DMA1_CH1>;
        DMA1_CHANNEL2 => dma::InterruptHandler<DMA1_CH2>;
    }
);
