//! Acquisition: six channels on one converter and the encoder count, all started by one timer.
//!
//! One converter for all channels: two DMA rings of two converters can lose their alignment after an
//! overrun. Voltage and current of a phase follow each other by 0.63 us (0.011 degrees at 50 Hz).

use embassy_stm32::adc::{Adc, AdcChannel, AdcConfig, Exten, RingBufferedAdc, SampleTime};
use embassy_stm32::dma::ReadableRingBuffer;
use embassy_stm32::peripherals::{ADC1, DMA1_CH1, DMA1_CH2, PA0, PA1, PC0, PC1, PC2, PC3, TIM4};
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::{MasterMode, Timer};
use embassy_stm32::{Peri, pac, triggers};
use embassy_time::{Duration, with_timeout};
use monitor::{RawBlock, RawSample};

use super::encoder::{self, Encoder};
use super::interrupts::Irqs;
use super::ring::{self, Ring};

/// Sampling instants per second; the motor constants are compiled for it.
const SAMPLE_RATE: Hertz = Hertz(10_000);
/// Instants per block: 3.2 ms, a sixth of a supply cycle, so that a report is never late by more.
pub const BLOCK: usize = 32;
/// Channels per instant.
const CHANNELS: usize = 6;
/// Two halves: one fills while the other is read.
const RING: usize = 2 * BLOCK;
/// Three blocks' time: the converter has stopped, or its overrun flag blocks the DMA (which the
/// driver never looks at), or the clock is gone.
const STALL: Duration = Duration::from_micros(3 * 3_200);
/// Instants by which the two rings may seem apart: the trigger can fall between the two look-ups,
/// and the converter is behind the encoder by one sequence.
const SKEW: usize = 2;

/// What acquisition is made of. Kept by the caller so that it can be started anew after a gap.
pub struct Sources {
    /// The converter.
    pub adc: Peri<'static, ADC1>,
    /// Its DMA channel.
    pub adc_dma: Peri<'static, DMA1_CH1>,
    /// Voltage a, current a, voltage b, current b, voltage c, current c.
    pub pins: Pins,
    /// Timer that starts every instant.
    pub trigger: Peri<'static, TIM4>,
    /// DMA channel of the encoder count.
    pub encoder_dma: Peri<'static, DMA1_CH2>,
    /// Kept because dropping it stops the counter.
    pub _encoder: Encoder,
}

type Pins = (
    Peri<'static, PA0>,
    Peri<'static, PA1>,
    Peri<'static, PC0>,
    Peri<'static, PC1>,
    Peri<'static, PC2>,
    Peri<'static, PC3>,
);

#[unsafe(link_section = ".dma.codes")]
#[allow(unsafe_code)]
static CODES: Ring<{ RING * CHANNELS / 2 }> = Ring::new();
#[unsafe(link_section = ".dma.counts")]
#[allow(unsafe_code)]
static COUNTS: Ring<{ RING / 2 }> = Ring::new();

/// The latest instants, in the order in which they were taken.
pub struct Block {
    codes: [u16; BLOCK * CHANNELS],
    counts: [u16; BLOCK],
}

impl Block {
    /// A block to be filled.
    pub const fn new() -> Self {
        Block {
            codes: [0; BLOCK * CHANNELS],
            counts: [0; BLOCK],
        }
    }

    /// The instants one by one.
    pub fn samples(&self) -> impl Iterator<Item = RawSample> {
        let (instants, _) = self.codes.as_chunks::<CHANNELS>();
        instants.iter().zip(&self.counts).map(
            |(&[v_a, i_a, v_b, i_b, v_c, i_c], &encoder_count)| RawSample {
                voltage_codes: [v_a, v_b, v_c],
                current_codes: [i_a, i_b, i_c],
                encoder_count,
            },
        )
    }

    /// Codes of the first instant: voltage and current of each phase in turn.
    pub fn first(&self) -> &[u16; CHANNELS] {
        let (instants, _) = self.codes.as_chunks::<CHANNELS>();
        instants.first().unwrap_or(&[0; CHANNELS])
    }

    /// The instants as the core takes them.
    pub fn raw(&self) -> RawBlock<'_> {
        let (instants, _) = self.codes.as_chunks();
        RawBlock::new(instants, &self.counts)
    }
}

/// Why samples are missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum Gap {
    /// No half ring was filled in time.
    Stalled,
    /// A half was overwritten before it was read.
    Overrun,
    /// The rings do not hold the same instants any more.
    Misaligned,
}

/// Running acquisition.
pub struct Acquisition<'a> {
    /// Halves that were read.
    taken: u32,
    _adc: RingBufferedAdc<'a, ADC1>,
    _counts: ReadableRingBuffer<'a, u16>,
    // Last, so that it stops after the rings; stops when dropped.
    _trigger: Timer<'a, TIM4>,
}

/// The count after which the timer begins anew. Not `set_frequency`: its division of 64 bits alone takes 0.7 kB of flash.
fn last_count(clock: Hertz) -> u16 {
    u16::try_from(clock.0 / SAMPLE_RATE.0 - 1).unwrap_or(u16::MAX)
}

impl<'a> Acquisition<'a> {
    /// Calibrates the converter and starts both rings before the timer, so that both begin with the
    /// same instant.
    pub fn start(sources: &'a mut Sources) -> Self {
        let trigger = Timer::new(sources.trigger.reborrow());
        trigger.set_max_compare_value(last_count(trigger.get_clock_frequency()));
        trigger.set_master_mode(MasterMode::UPDATE);
        let mut counts = encoder::snapshots(sources.encoder_dma.reborrow(), COUNTS.for_dma());
        let converter = Adc::new(sources.adc.reborrow(), AdcConfig::default());
        let mut adc = converter.into_ring_buffered(
            sources.adc_dma.reborrow(),
            CODES.for_dma(),
            Irqs,
            sequence(&mut sources.pins).into_iter(),
            triggers::TIM4_TRGO,
            Exten::RISING_EDGE,
        );
        ring::restart();
        counts.start();
        adc.start();
        trigger.enable_update_dma(true);
        trigger.start();
        Acquisition {
            taken: 0,
            _adc: adc,
            _counts: counts,
            _trigger: trigger,
        }
    }

    /// Waits for the next block.
    ///
    /// # Errors
    /// Samples are missing; the acquisition must be started anew.
    pub async fn read(&mut self, block: &mut Block) -> Result<(), Gap> {
        let filled = with_timeout(STALL, ring::more_than(self.taken)).await;
        if filled.map_err(|_| Gap::Stalled)?.wrapping_sub(self.taken) > 1 {
            return Err(Gap::Overrun);
        }
        CODES.copy_half(self.taken, &mut block.codes);
        COUNTS.copy_half(self.taken, &mut block.counts);
        self.taken = self.taken.wrapping_add(1);
        match ring::filled() {
            filled if filled != self.taken => Err(Gap::Overrun),
            _ if skew() > SKEW => Err(Gap::Misaligned),
            _ => Ok(()),
        }
    }
}

/// Instants by which the encoder's ring is ahead of the converter's.
fn skew() -> usize {
    let left = |channel| usize::from(pac::DMA1.ch(channel).ndtr().read().ndt());
    let [codes, counts] = [left(0).div_ceil(CHANNELS), left(1)];
    (RING + codes - counts) % RING
}

/// 12.5 cycles at 40 MHz: the front end of docs/wiring.md holds the charge (47 nF at the pin).
fn sequence(
    (v_a, i_a, v_b, i_b, v_c, i_c): &mut Pins,
) -> [(embassy_stm32::adc::AnyAdcChannel<'_, ADC1>, SampleTime); CHANNELS] {
    [
        v_a.reborrow().degrade_adc(),
        i_a.reborrow().degrade_adc(),
        v_b.reborrow().degrade_adc(),
        i_b.reborrow().degrade_adc(),
        v_c.reborrow().degrade_adc(),
        i_c.reborrow().degrade_adc(),
    ]
    .map(|channel| (channel, SampleTime::CYCLES12_5))
}
