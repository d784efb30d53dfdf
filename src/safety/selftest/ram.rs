//! The running test of the RAM: a few words at a time, with interrupts off. What DMA uses is left to its parity.
// Every word of the memory, whatever it holds.
#![allow(unsafe_code)]

use cortex_m::interrupt;

/// Words of a slice.
const WORDS: u32 = 16;
const FIRST: u32 = 0x2000_0000;
/// The end of SRAM2.
const END: u32 = 0x2001_8000;
/// Patterns of March C- in one word.
const PATTERNS: [u32; 4] = [0x5555_5555, 0xAAAA_AAAA, 0x0000_0000, 0xFFFF_FFFF];

unsafe extern "C" {
    static __sdma: u8;
    static __edma: u8;
}

/// How far it has come.
#[derive(Clone, Copy, Debug)]
pub struct RamTest {
    at: u32,
}

impl Default for RamTest {
    fn default() -> Self {
        RamTest { at: FIRST }
    }
}

impl RamTest {
    /// Tests the next slice; whether it is sound.
    pub fn slice(&mut self) -> bool {
        let sound = (0..WORDS).all(|k| test(self.at + 4 * k));
        self.at += 4 * WORDS;
        if self.at >= END {
            self.at = FIRST;
        }
        sound
    }
}

fn test(address: u32) -> bool {
    let dma = &raw const __sdma as u32..&raw const __edma as u32;
    dma.contains(&address) || interrupt::free(|_| holds_patterns(address))
}

/// Written and read back; the content comes back too.
#[inline(never)]
fn holds_patterns(address: u32) -> bool {
    let word = address as *mut u32;
    // Safety: a word of the RAM, restored before anything else runs. It may be of this very stack: nothing that is held
    // there is needed between.
    unsafe {
        let content = word.read_volatile();
        let mut sound = true;
        for pattern in PATTERNS {
            word.write_volatile(pattern);
            sound &= word.read_volatile() == pattern;
        }
        word.write_volatile(content);
        sound && word.read_volatile() == content
    }
}
