//! Acquisition: six channels on one converter and the encoder count, all started by one timer, sixteen times for each sample.
//!
//! One converter for all channels: two DMA rings of two converters can lose their alignment after an
//! overrun. Voltage and current of a phase follow each other by 0.625 us (0.011 degrees at 50 Hz).

use embassy_stm32::adc::{Adc, AdcChannel, AdcConfig, Exten, RingBufferedAdc, SampleTime};
use embassy_stm32::dma::ReadableRingBuffer;
use embassy_stm32::peripherals::{ADC1, DMA1_CH1, DMA1_CH2, PA0, PA1, PC0, PC1, PC2, PC3, TIM4};
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::{MasterMode, Timer};
use embassy_stm32::{Peri, pac, triggers};
use embassy_time::{Duration, with_timeout};
use monitor::{CHANNELS, ClippedChannels, RawBlock, RawSample};

use super::encoder::{self, Encoder};
use super::interrupts::Irqs;
use super::ring::{self, BLOCK, CODES, CONVERSIONS, COUNTS, Fault};

/// Samples per second; the motor constants are compiled for it.
const SAMPLE_RATE: u32 = 10_000;
/// Sequences per second: sixteen in exactly the time of a sample, so that what the mean lets through has its zeros at the
/// multiples of the sampling rate, which else would fold onto the supply.
const TRIGGER_RATE: Hertz = Hertz(SAMPLE_RATE * CONVERSIONS as u32);
/// Blocks that are thrown away after each start: the converter's first result after a pause of 1 ms or after its calibration
/// may be wrong (erratum of the family).
const IDLE_BLOCKS: u32 = 1;
/// Codes beyond which one counts as clipped, as in the core.
const RAILS: [u16; 2] = [2, 4_093];
/// Three blocks' time: the converter has stopped, or its overrun flag blocks the DMA (which the
/// driver never looks at), or the clock is gone.
const STALL: Duration = Duration::from_micros(3 * 3_200);
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

/// The latest samples, in the order in which they were taken; codes are sums of sixteen.
pub struct Block {
    codes: [[u16; CHANNELS]; BLOCK],
    counts: [u16; BLOCK],
    clipped: [ClippedChannels; BLOCK],
    is_clipped: bool,
}

impl Block {
    /// A block to be filled.
    pub const fn new() -> Self {
        Block {
            codes: [[0; CHANNELS]; BLOCK],
            counts: [0; BLOCK],
            clipped: [ClippedChannels::NONE; BLOCK],
            is_clipped: false,
        }
    }

    /// The samples one by one.
    pub fn samples(&self) -> impl Iterator<Item = RawSample> {
        let instants = self.codes.iter().zip(&self.counts).zip(&self.clipped);
        instants.map(
            |((&[v_a, i_a, v_b, i_b, v_c, i_c], &encoder_count), &clipped)| RawSample {
                voltage_codes: [v_a, v_b, v_c],
                current_codes: [i_a, i_b, i_c],
                encoder_count,
                clipped,
            },
        )
    }

    /// Codes of the first sample: voltage and current of each phase in turn.
    pub fn first(&self) -> &[u16; CHANNELS] {
        let [first, ..] = &self.codes;
        first
    }

    /// The samples as the core takes them.
    pub fn raw(&self) -> RawBlock<'_> {
        let clipped: &[ClippedChannels] = if self.is_clipped { &self.clipped } else { &[] };
        RawBlock::new(&self.codes, &self.counts).with_clipped(clipped)
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
    /// Blocks that were read.
    taken: u32,
    _adc: RingBufferedAdc<'a, ADC1>,
    _counts: ReadableRingBuffer<'a, u16>,
    // Last, so that it stops after the rings; stops when dropped.
    _trigger: Timer<'a, TIM4>,
}

/// The count after which the timer begins anew. Not `set_frequency`: its division of 64 bits alone takes 0.7 kB of flash.
fn last_count(clock: Hertz) -> u16 {
    u16::try_from(clock.0 / TRIGGER_RATE.0 - 1).unwrap_or(u16::MAX)
}

/// The converter itself looks at every conversion for one at a rail; which channel it is, the program finds then. Both rails are
/// those of the core.
fn watch_rails() {
    let [lowest, highest] = RAILS;
    pac::ADC1.tr1().write(|w| {
        w.set_lt1(lowest);
        w.set_ht1(highest);
    });
    pac::ADC1.cfgr().modify(|w| {
        w.set_awd1sgl(pac::adc::vals::Awd1sgl::ALL);
        w.set_awd1en(true);
    });
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
        watch_rails();
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
        loop {
            self.take(block).await?;
            if self.taken > IDLE_BLOCKS {
                return Ok(());
            }
        }
    }

    async fn take(&mut self, block: &mut Block) -> Result<(), Gap> {
        let filled = with_timeout(STALL, ring::more_than(self.taken)).await;
        if filled.map_err(|_| Gap::Stalled)?.wrapping_sub(self.taken) > 1 {
            return Err(Gap::Overrun);
        }
        block.is_clipped = ring::copy_block(
            self.taken,
            &mut block.codes,
            &mut block.counts,
            &mut block.clipped,
        );
        self.taken = self.taken.wrapping_add(1);
        match ring::fault() {
            Some(Fault::Overwritten) => Err(Gap::Overrun),
            Some(Fault::Apart) => Err(Gap::Misaligned),
            None if ring::filled() != self.taken => Err(Gap::Overrun),
            None => Ok(()),
        }
    }
}

/// 12.5 cycles at 40 MHz, 25 with the conversion: 3.75 us of the 6.25 us between triggers. The front end of docs/wiring.md holds the charge (47 nF at the pin).
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
