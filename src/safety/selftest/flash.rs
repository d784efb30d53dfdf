//! The program in flash against the checksum that it was sealed with.
// The program as bytes.
#![allow(unsafe_code)]

use board::Checksum;

use super::seal::{LEFT_OUT, PROGRAM};

/// Bytes of a slice: some thirteen kilobytes a second.
const SLICE: u32 = 512;

/// How far the running test has come.
pub struct FlashTest {
    sealed: Option<(u32, u32)>,
    at: u32,
    checksum: Checksum,
}

impl FlashTest {
    /// Takes length and checksum from the seal.
    pub fn new(sealed: Option<(u32, u32)>) -> Self {
        FlashTest {
            sealed,
            at: PROGRAM,
            checksum: Checksum::new(),
        }
    }

    /// Tests the whole program at once; one that was not sealed passes.
    ///
    /// # Errors
    /// The checksum does not hold.
    pub fn whole(&mut self) -> Result<(), ()> {
        let length = self.sealed.map_or(0, |(length, _)| length);
        for _ in 0..=length / SLICE {
            if let Some(sound) = self.slice() {
                return sound.then_some(()).ok_or(());
            }
        }
        Ok(())
    }

    /// Goes on by a slice; says at the end of the program whether it is whole.
    pub fn slice(&mut self) -> Option<bool> {
        let (length, expected) = self.sealed?;
        let end = PROGRAM + length;
        let to = (self.at + SLICE).min(end);
        for address in self.at..to {
            if !LEFT_OUT.contains(&address) {
                self.checksum.update(&[byte(address)]);
            }
        }
        self.at = to;
        (to == end).then(|| {
            self.at = PROGRAM;
            core::mem::replace(&mut self.checksum, Checksum::new()).finish() == expected
        })
    }
}

fn byte(address: u32) -> u8 {
    // Safety: any byte of the program is readable; volatile, because the compiler believes that it knows them.
    unsafe { (address as *const u8).read_volatile() }
}
