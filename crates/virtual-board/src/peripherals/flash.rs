//! The flash interface: access control, unlocking, erasing pages and programming double words; and power that fails
//! while it does.

use crate::peripherals::registers::{Registers, Unmodelled};

const KEYR: u32 = 0x08;
const SR: u32 = 0x10;
const CR: u32 = 0x14;
const ECCR: u32 = 0x18;
/// ECCR: two wrong bits in a double word were read; written as 1 to clear.
const ECC_DETECTED: u32 = 1 << 31;
const LOCK: u32 = 1 << 31;
const PROGRAM: u32 = 1;
const PAGE_ERASE: u32 = 1 << 1;
const START: u32 = 1 << 16;
const END_OF_OPERATION: u32 = 1;
const RESET: &[(u32, u32)] = &[
    (0x00, 0x0004_0600), // ACR
    (CR, 0xC000_0000),
    // DBANK, and every other option as shipped.
    (0x20, 0xFFEF_F8AA),
];
/// Bytes of a page in dual-bank mode.
pub const PAGE: u32 = 2048;
const PAGES_PER_BANK: u32 = 128;

/// The interface; the array itself is memory.
#[derive(Clone, Debug)]
pub struct Flash {
    registers: Registers,
    status: u32,
    key: u32,
    /// Steps (words programmed, pages erased) until power fails within one.
    steps_left: Option<u32>,
    /// Power has failed within a step.
    pub has_failed: bool,
    /// Double words whose programming was cut off: their error correction does not hold.
    broken: Vec<u32>,
    ecc_detected: bool,
    noise: u64,
}

/// How a step ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    Whole,
    /// Some of the bits, the set ones here, did not change.
    Torn(u32),
    /// There is no power.
    Nothing,
}

impl Flash {
    /// After reset: locked.
    pub fn new() -> Self {
        Flash {
            registers: Registers::new("FLASH", RESET),
            status: 0,
            key: 0,
            steps_left: None,
            has_failed: false,
            broken: Vec::new(),
            ecc_detected: false,
            noise: 1,
        }
    }

    /// A reset: the interface is as new, the array is not.
    pub fn reset(&mut self) {
        *self = Flash {
            broken: std::mem::take(&mut self.broken),
            noise: self.noise,
            ..Flash::new()
        };
    }

    /// Lets power fail within the step after `steps` whole ones.
    pub fn fail_after(&mut self, steps: u32) {
        self.steps_left = Some(steps);
    }

    /// Begins to program a word or to erase a page.
    pub fn step(&mut self) -> Step {
        if self.has_failed {
            return Step::Nothing;
        }
        match &mut self.steps_left {
            None => Step::Whole,
            Some(0) => {
                self.has_failed = true;
                // Knuth's 64-bit linear congruential generator.
                self.noise = self
                    .noise
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                Step::Torn((self.noise >> 32) as u32)
            }
            Some(left) => {
                *left -= 1;
                Step::Whole
            }
        }
    }

    /// The double word at `address` is neither the old one nor the new one.
    pub fn break_word(&mut self, address: u32) {
        self.broken.push(address & !7);
    }

    /// The page from `address` on was erased.
    pub fn mend_page(&mut self, address: u32) {
        self.broken
            .retain(|broken| !(address..address + PAGE).contains(broken));
    }

    /// Whether any double word is broken.
    pub fn has_broken(&self) -> bool {
        !self.broken.is_empty()
    }

    /// A read of the array; whether it raises the non-maskable interrupt. The emulator shows only the first read of each
    /// kibibyte, so all reads beside a broken double word count as reads of it.
    pub fn check(&mut self, address: u32) -> bool {
        let beside = |broken: &u32| broken & !0x3FF == address & !0x3FF;
        let found = self.broken.iter().any(beside);
        self.ecc_detected |= found;
        found
    }

    /// Whether the interrupt of the error correction is asserted.
    pub fn interrupt(&self) -> bool {
        self.ecc_detected
    }

    /// Whether the program may write to the array now.
    pub fn is_programming(&self) -> bool {
        let cr = self.registers.get(CR);
        cr & LOCK == 0 && cr & PROGRAM != 0
    }

    /// Records a finished double word.
    pub fn programmed(&mut self) {
        self.status |= END_OF_OPERATION;
    }

    /// A bus read.
    pub fn read(&self, offset: u32) -> Result<u32, Unmodelled> {
        match offset {
            SR => Ok(self.status),
            ECCR => Ok(if self.ecc_detected { ECC_DETECTED } else { 0 }),
            _ => self.registers.read(offset),
        }
    }

    /// A bus write. Returns the offset of a page to be erased.
    pub fn write(&mut self, offset: u32, value: u32) -> Result<Option<u32>, Unmodelled> {
        match offset {
            KEYR => {
                if self.key == 0x4567_0123 && value == 0xCDEF_89AB {
                    self.registers.set(CR, self.registers.get(CR) & !LOCK);
                }
                self.key = value;
            }
            SR => self.status &= !value,
            ECCR => self.ecc_detected &= value & ECC_DETECTED == 0,
            CR if self.registers.get(CR) & LOCK != 0 => {
                let access = format!("write of {value:#x} while locked");
                return Err(self.registers.unmodelled(access, offset));
            }
            CR => {
                self.registers.set(CR, value & !START);
                return Ok(self.erased(value));
            }
            _ => self.registers.write(offset, value)?,
        }
        Ok(None)
    }

    fn erased(&mut self, command: u32) -> Option<u32> {
        if command & PAGE_ERASE == 0 || command & START == 0 {
            return None;
        }
        self.status |= END_OF_OPERATION;
        let (page, bank) = (command >> 3 & 0x7F, command >> 11 & 1);
        Some((bank * PAGES_PER_BANK + page) * PAGE)
    }
}
