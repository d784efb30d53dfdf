//! What the DMA writes, and the samples that are made of it.
//!
//! The converter takes each channel sixteen times while the program gets one value. The interrupt of a half ring adds the
//! sixteen codes up, so that what it leaves is a ring of samples again, sixteen times smaller.

use core::future::poll_fn;
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};
use core::task::Poll;

use embassy_stm32::interrupt::typelevel::{DMA1_CHANNEL1, Handler};
use embassy_stm32::pac;
use embassy_sync::waitqueue::AtomicWaker;
use monitor::{CHANNELS, ClippedChannels};

/// Conversions of each channel in a sample.
pub const CONVERSIONS: usize = 16;
/// Samples in half of the DMA's ring: 1.6 ms. As long the interrupt may wait.
const PART: usize = 16;
/// Samples in a block.
pub const BLOCK: usize = 32;
/// Samples in two blocks: one fills while the other is read.
const SAMPLES: usize = 2 * BLOCK;
/// Sequences in the DMA's ring.
const SEQUENCES: usize = 2 * PART * CONVERSIONS;
/// Sequences by which the two rings may seem apart: the trigger can fall between the two look-ups, and the converter is
/// behind the encoder by one sequence.
const SKEW: usize = 2;
/// Two codes to a word: a sequence is three.
const WORDS: usize = CHANNELS / 2;
/// Codes up to 1 and from 4094 on are at a rail: in either half of a word, both of these leave the lower 12 bits then.
const UP_TO_LOWEST_RAIL: u32 = 0x1001_1001;
const FROM_HIGHEST_RAIL: u32 = 0x0002_0002;
const LEFT: [u32; 2] = [1 << 12, 1 << 28];

/// A ring of `2 * WORDS` half-words.
pub struct Ring<const WORDS: usize>([AtomicU32; WORDS]);

impl<const WORDS: usize> Ring<WORDS> {
    /// An empty ring.
    const fn new() -> Self {
        Ring([const { AtomicU32::new(0) }; WORDS])
    }

    /// The ring as a driver wants it, which must only pass it on to the DMA and never `read`.
    #[allow(unsafe_code, clippy::mut_from_ref)]
    pub fn for_dma(&'static self) -> &'static mut [u16] {
        let first = self.0.as_ptr().cast::<u16>().cast_mut();
        // Safety: `WORDS` aligned words that may change behind a shared reference are `2 * WORDS` half-words. The
        // drivers take address and length of the slice; its content is touched by the DMA and by atomic loads alone.
        unsafe { core::slice::from_raw_parts_mut(first, 2 * WORDS) }
    }
}

/// Codes, sequence by sequence.
#[unsafe(link_section = ".dma.codes")]
#[allow(unsafe_code)]
pub static CODES: Ring<{ SEQUENCES * WORDS }> = Ring::new();
/// The encoder's count at every trigger.
#[unsafe(link_section = ".dma.counts")]
#[allow(unsafe_code)]
pub static COUNTS: Ring<{ SEQUENCES / 2 }> = Ring::new();

/// A sample: sums of codes by pairs, then count and marks of clipped channels.
struct Kept([AtomicU32; WORDS + 1]);

static KEPT: [Kept; SAMPLES] = [const { Kept([const { AtomicU32::new(0) }; WORDS + 1]) }; SAMPLES];
/// Half rings since [`restart`].
static PARTS: AtomicU32 = AtomicU32::new(0);
static FAULT: AtomicU8 = AtomicU8::new(0);
/// A conversion at a rail was told, which may lie in the part to come.
static LOOK_AGAIN: AtomicU8 = AtomicU8::new(0);
static WAKER: AtomicWaker = AtomicWaker::new();

/// What is wrong with samples that were made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A half was overwritten before it was added up.
    Overwritten,
    /// The rings of converter and encoder do not hold the same instants any more.
    Apart,
}

/// Adds up each half of the converter's ring. To be bound before the driver's handler, which clears the flags.
pub struct HalfFilled;

impl Handler<DMA1_CHANNEL1> for HalfFilled {
    // The driver clears one flag per interrupt, so each half comes once even if both flags are up.
    #[allow(unsafe_code)]
    unsafe fn on_interrupt() {
        let part = PARTS.load(Ordering::Relaxed);
        let flags = pac::DMA1.isr().read();
        if !flags.htif(0) && !flags.tcif(0) {
            return;
        }
        add_up(part);
        let flags = pac::DMA1.isr().read();
        // Whichever half this is, the other one must not be full as well: then this one fills again.
        let own = [(true, false), (false, true)];
        if own.get(part as usize % 2) != Some(&(flags.htif(0), flags.tcif(0))) {
            FAULT.store(Fault::Overwritten as u8 + 1, Ordering::Release);
        } else if skew() > SKEW {
            FAULT.store(Fault::Apart as u8 + 1, Ordering::Release);
        }
        PARTS.store(part.wrapping_add(1), Ordering::Release);
        if (part as usize + 1).is_multiple_of(BLOCK / PART) || fault().is_some() {
            WAKER.wake();
        }
    }
}

/// Sequences by which the encoder's ring is ahead of the converter's. Nothing interrupts the handler that asks.
fn skew() -> usize {
    let left = |channel| usize::from(pac::DMA1.ch(channel).ndtr().read().ndt());
    let [codes, counts] = [left(0).div_ceil(CHANNELS), left(1)];
    (SEQUENCES + codes - counts) % SEQUENCES
}

/// Makes the samples of a half ring, in which the converter has told whether anything is at a rail.
fn add_up(part: u32) {
    let told = u8::from(pac::ADC1.isr().read().awd1());
    pac::ADC1.isr().write(|w| w.set_awd1(true));
    // Told between the end of this part and now: it lies in the next one.
    let looks = told | LOOK_AGAIN.swap(told, Ordering::Relaxed) != 0;
    let (sequences, _) = CODES.0.as_chunks::<WORDS>();
    let (groups, _) = sequences.as_chunks::<CONVERSIONS>();
    let (counts, _) = COUNTS.0.as_chunks::<{ CONVERSIONS / 2 }>();
    let from = |ring: usize| part as usize * PART % ring;
    let groups = groups.iter().skip(from(2 * PART)).take(PART);
    let counts = counts.iter().skip(from(2 * PART));
    let places = KEPT.iter().skip(from(SAMPLES));
    for ((group, counts), place) in groups.zip(counts).zip(places) {
        make(group, counts, looks, place);
    }
}

/// Makes a sample of its sixteen sequences and counts. Not inlined: its registers are its own.
#[inline(never)]
fn make(
    group: &[[AtomicU32; WORDS]; CONVERSIONS],
    [.., last]: &[AtomicU32; CONVERSIONS / 2],
    looks: bool,
    Kept([a, b, c, d]): &Kept,
) {
    a.store(sum(group, |[a, _, _]| a), Ordering::Relaxed);
    b.store(sum(group, |[_, b, _]| b), Ordering::Relaxed);
    c.store(sum(group, |[_, _, c]| c), Ordering::Relaxed);
    let clipped = if looks { clipped(group) } else { 0 };
    // The last count of sixteen: then the sample is late by the mean's 46.9 us, whatever the shaft does.
    let count = last.load(Ordering::Relaxed) >> 16;
    d.store(count | clipped << 16, Ordering::Relaxed);
}

/// Sums of the codes of two channels, one after the other for want of registers. Sixteen times 4095 is 65520: no carry leaves a
/// half of a word.
#[inline(always)]
fn sum(
    group: &[[AtomicU32; WORDS]; CONVERSIONS],
    pair: impl Fn(&[AtomicU32; WORDS]) -> &AtomicU32,
) -> u32 {
    let mut sum = 0_u32;
    for sequence in group {
        sum = sum.wrapping_add(pair(sequence).load(Ordering::Relaxed));
    }
    sum
}

/// Marks of the channels of which any conversion is at a rail, as [`ClippedChannels`] takes them.
#[inline(never)]
fn clipped(group: &[[AtomicU32; WORDS]; CONVERSIONS]) -> u32 {
    let mut beyond = [0_u32; WORDS];
    for sequence in group {
        for (beyond, word) in beyond.iter_mut().zip(sequence) {
            let codes = word.load(Ordering::Relaxed);
            *beyond |=
                codes.wrapping_add(FROM_HIGHEST_RAIL) | UP_TO_LOWEST_RAIL.wrapping_sub(codes);
        }
    }
    let mut marks = 0;
    for (phase, beyond) in beyond.iter().enumerate() {
        for (kind, left) in LEFT.iter().enumerate() {
            marks |= u32::from(beyond & left != 0) << (phase + 3 * kind);
        }
    }
    marks
}

/// Copies one block (0 or 1) as it is now; whether any channel is marked as clipped.
pub fn copy_block(
    block: u32,
    codes: &mut [[u16; CHANNELS]; BLOCK],
    counts: &mut [u16; BLOCK],
    clipped: &mut [ClippedChannels; BLOCK],
) -> bool {
    let first = if block.is_multiple_of(2) { 0 } else { BLOCK };
    let kept = KEPT.iter().skip(first);
    let places = codes.iter_mut().zip(counts).zip(clipped);
    let mut marks = 0;
    for (((codes, count), clipped), Kept(kept)) in places.zip(kept) {
        let [a, b, c, d] = kept.each_ref().map(|word| word.load(Ordering::Relaxed));
        let [low, high] = [|word: u32| word as u16, |word: u32| (word >> 16) as u16];
        *codes = [low(a), high(a), low(b), high(b), low(c), high(c)];
        *count = low(d);
        *clipped = ClippedChannels::from_bits(high(d) as u8);
        marks |= high(d);
    }
    marks != 0
}

/// Blocks that were filled since [`restart`].
pub fn filled() -> u32 {
    PARTS.load(Ordering::Acquire) / (BLOCK / PART) as u32
}

/// What was wrong since [`restart`].
pub fn fault() -> Option<Fault> {
    match FAULT.load(Ordering::Acquire) {
        0 => None,
        1 => Some(Fault::Overwritten),
        _ => Some(Fault::Apart),
    }
}

/// Counts from zero again; to be called while the converter's ring stands.
pub fn restart() {
    FAULT.store(0, Ordering::Release);
    PARTS.store(0, Ordering::Release);
}

/// Waits until more than `taken` blocks are filled or something is wrong, and says how many there are.
pub async fn more_than(taken: u32) -> u32 {
    poll_fn(|context| {
        WAKER.register(context.waker());
        match filled() {
            now if now == taken && fault().is_none() => Poll::Pending,
            now => Poll::Ready(now),
        }
    })
    .await
}
