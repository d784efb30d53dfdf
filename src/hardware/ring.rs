//! Memory that the DMA fills in two halves, and how the program learns that one of them is full.
//!
//! The driver's own `read` computes a remainder for every element: 112 instructions per sampling instant, a quarter of
//! what everything together may take. Here a half is copied as it lies, word by word.

use core::future::poll_fn;
use core::sync::atomic::{AtomicU32, Ordering};
use core::task::Poll;

use embassy_stm32::interrupt::typelevel::{DMA1_CHANNEL1, Handler};
use embassy_stm32::pac;
use embassy_sync::waitqueue::AtomicWaker;

/// A ring of `2 * WORDS` half-words.
pub struct Ring<const WORDS: usize>([AtomicU32; WORDS]);

impl<const WORDS: usize> Ring<WORDS> {
    /// An empty ring.
    pub const fn new() -> Self {
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

    /// Copies one half (0 or 1) as it is now.
    pub fn copy_half(&self, half: u32, to: &mut [u16]) {
        let first = if half.is_multiple_of(2) { 0 } else { WORDS / 2 };
        let (pairs, _) = to.as_chunks_mut::<2>();
        for (pair, word) in pairs.iter_mut().zip(self.0.iter().skip(first)) {
            let word = word.load(Ordering::Relaxed);
            *pair = [word as u16, (word >> 16) as u16];
        }
    }
}

static FILLED: AtomicU32 = AtomicU32::new(0);
static WAKER: AtomicWaker = AtomicWaker::new();

/// Counts the halves of the converter's ring. To be bound before the driver's handler, which clears the flags.
pub struct HalfFilled;

impl Handler<DMA1_CHANNEL1> for HalfFilled {
    // The driver clears one flag per interrupt, so each half is counted once even if both flags are up.
    #[allow(unsafe_code)]
    unsafe fn on_interrupt() {
        let flags = pac::DMA1.isr().read();
        if flags.htif(0) || flags.tcif(0) {
            FILLED.store(filled().wrapping_add(1), Ordering::Release);
            WAKER.wake();
        }
    }
}

/// Halves that were filled since [`restart`].
pub fn filled() -> u32 {
    FILLED.load(Ordering::Acquire)
}

/// Counts from zero again; to be called while the converter's ring stands.
pub fn restart() {
    FILLED.store(0, Ordering::Release);
}

/// Waits until more than `taken` halves are filled, and says how many.
pub async fn more_than(taken: u32) -> u32 {
    poll_fn(|context| {
        WAKER.register(context.waker());
        match filled() {
            now if now == taken => Poll::Pending,
            now => Poll::Ready(now),
        }
    })
    .await
}
