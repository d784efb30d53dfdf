//! The shaft encoder: a hardware counter, read by DMA at every trigger of the converter.

use embassy_stm32::Peri;
use embassy_stm32::dma::{self, ReadableRingBuffer, TransferOptions};
use embassy_stm32::gpio::Pull;
use embassy_stm32::pac;
use embassy_stm32::peripherals::{DMA1_CH2, PC6, PC7, TIM3, TIM4};
use embassy_stm32::timer::qei::{Config, Qei};
use embassy_stm32::timer::{Ch1, Ch2, UpDma};

use super::interrupts::Irqs;

/// The quadrature counter: four counts per encoder pulse, 16 bits, wrapping.
pub struct Encoder {
    _counter: Qei<'static, TIM3>,
}

impl Encoder {
    /// Starts counting. Open-collector encoders are pulled up here.
    pub fn new(counter: Peri<'static, TIM3>, a: Peri<'static, PC6>, b: Peri<'static, PC7>) -> Self {
        let config = Config {
            ch1_pull: Pull::Up,
            ch2_pull: Pull::Up,
            ..Config::default()
        };
        Encoder {
            _counter: Qei::new::<Ch1, Ch2>(counter, a, b, config),
        }
    }
}

/// A ring that receives the count once per update of the trigger timer, without the processor.
pub fn snapshots<'a>(
    dma: Peri<'a, DMA1_CH2>,
    buffer: &'a mut [u16],
) -> ReadableRingBuffer<'a, u16> {
    let request = <DMA1_CH2 as UpDma<TIM4>>::request(&*dma);
    let channel = dma::Channel::new(dma, Irqs);
    let counter = pac::TIM3.cnt().as_ptr().cast::<u16>();
    // The converter's ring tells when both are full.
    let mut options = TransferOptions::default();
    options.complete_transfer_ir = false;
    // Safety: `counter` is the address of a 16-bit readable register that exists as long as the chip
    // does, and the buffer stays borrowed for the life of the ring, whose drop stops the channel.
    #[allow(unsafe_code)]
    unsafe {
        ReadableRingBuffer::new(channel, request, counter, buffer, options)
    }
}
