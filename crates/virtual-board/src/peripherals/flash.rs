//! The flash interface: access control, unlocking, erasing pages and programming double words; and power that fails
//! while it does.

use std::ops::Range;

use crate::TICK_HZ;
use crate::peripherals::registers::{Registers, Unmodelled};

const KEYR: u32 = 0x08;
const SR: u32 = 0x10;
const CR: u32 = 0x14;
const ECCR: u32 = 0x18;
/// ECCR: two wrong bits in a double word were read; written as 1 to clear. Its address within the bank, and the bank.
const ECC_DETECTED: u32 = 1 << 31;
const ECC_ADDRESS: u32 = 0x7_FFFF;
const ECC_BANK: u32 = 1 << 21;
const OPTKEYR: u32 = 0x0C;
const OPTR: u32 = 0x20;
const OPTION_LOCK: u32 = 1 << 30;
const OPTION_START: u32 = 1 << 17;
const OPTION_LAUNCH: u32 = 1 << 27;
/// Option bytes: the watchdog starts by software only.
const SOFTWARE_WATCHDOG: u32 = 1 << 16;
/// Option bytes as ST ships the chip: two banks, everything else off.
pub const SHIPPED_OPTIONS: u32 = 0xFFEF_F8AA;
/// As docs/firmware.md wants them: watchdog started by hardware, parity of the RAM, brown-out level 4.
pub const PREPARED_OPTIONS: u32 = 0xFEEE_FCAA;
const BANK: u32 = PAGES_PER_BANK * PAGE;
const FIRST: u32 = 0x0800_0000;
const LOCK: u32 = 1 << 31;
const PROGRAM: u32 = 1;
const PAGE_ERASE: u32 = 1 << 1;
const START: u32 = 1 << 16;
const END_OF_OPERATION: u32 = 1;
/// SR: a double word was not blank; its second word came without the first.
const PROGRAM_ERROR: u32 = 1 << 3;
const SEQUENCE_ERROR: u32 = 1 << 7;
/// SR: a page is being erased, or a double word programmed.
const BUSY: u32 = 1 << 16;
/// What a page and a double word take (data sheet of the STM32G474, typical).
const ERASE_TICKS: u64 = 22 * (TICK_HZ / 1_000);
const PROGRAM_TICKS: u64 = 85 * (TICK_HZ / 1_000_000);
const BLANK: [u8; 8] = [0xFF; 8];
const RESET: &[(u32, u32)] = &[
    (0x00, 0x0004_0600), // ACR
    (CR, 0xC000_0000),
    (OPTR, PREPARED_OPTIONS),
];
/// Bytes of a page in dual-bank mode.
pub const PAGE: u32 = 2048;
const PAGES_PER_BANK: u32 = 128;

/// The interface; the array itself is memory.
#[derive(Clone, Debug)]
pub struct Flash {
    registers: Registers,
    status: u32,
    /// What is being erased or programmed is done then.
    busy_until: u64,
    /// The double word whose first word was taken, and whether it was blank.
    begun: Option<(u32, bool)>,
    key: u32,
    /// Steps (words programmed, pages erased) until power fails within one.
    steps_left: Option<u32>,
    /// Power has failed within a step.
    pub has_failed: bool,
    /// Pages that were erased: what was translated of them before is no more what lies there.
    pub erasures: u32,
    /// Double words whose programming was cut off: their error correction does not hold.
    broken: Vec<u32>,
    /// ECCR.
    ecc: u32,
    option_key: u32,
    /// Option bytes in the array, which are loaded at power-up and when the program asks for it.
    stored_options: u32,
    loaded_options: u32,
    /// The program asks for the option bytes to be loaded, with a reset.
    pub launches: bool,
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
            busy_until: 0,
            begun: None,
            key: 0,
            steps_left: None,
            has_failed: false,
            erasures: 0,
            broken: Vec::new(),
            ecc: 0,
            option_key: 0,
            stored_options: PREPARED_OPTIONS,
            loaded_options: PREPARED_OPTIONS,
            launches: false,
            noise: 1,
        }
    }

    /// A reset: the interface is as new, the array is not. Option bytes are loaded where the cause says so.
    pub fn reset(&mut self, loads_options: bool) {
        let loaded = match loads_options {
            true => self.stored_options,
            false => self.loaded_options,
        };
        *self = Flash {
            broken: std::mem::take(&mut self.broken),
            noise: self.noise,
            stored_options: self.stored_options,
            loaded_options: loaded,
            ..Flash::new()
        };
        self.registers.set(OPTR, loaded);
    }

    /// Puts option bytes in place as a programmer does, before power-up.
    pub fn set_options(&mut self, options: u32) {
        (self.stored_options, self.loaded_options) = (options, options);
        self.registers.set(OPTR, options);
    }

    /// Option bytes in the array.
    pub fn options(&self) -> u32 {
        self.stored_options
    }

    /// Whether hardware starts the watchdog.
    pub fn starts_watchdog(&self) -> bool {
        self.loaded_options & SOFTWARE_WATCHDOG == 0
    }

    /// Wait states of a read.
    pub fn wait_states(&self) -> u64 {
        u64::from(self.registers.get(0x00) & 0xF)
    }

    /// A double word with two wrong bits was read or fetched at `address`.
    pub fn detect(&mut self, address: u32) {
        let offset = address - FIRST;
        let bank = if offset < BANK { 0 } else { ECC_BANK };
        self.ecc = ECC_DETECTED | bank | ((offset % BANK) & ECC_ADDRESS & !7);
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

    /// Whether any double word of these addresses is broken.
    pub fn has_broken(&self, addresses: &Range<u32>) -> bool {
        self.broken.iter().any(|broken| addresses.contains(broken))
    }

    /// A read of the array; whether it raises the non-maskable interrupt. The emulator shows only the first read of each
    /// kibibyte, so all reads beside a broken double word count as reads of it.
    pub fn check(&mut self, address: u32) -> bool {
        let beside = |broken: &&u32| **broken & !0x3FF == address & !0x3FF;
        let found = self.broken.iter().find(beside).copied();
        if let Some(broken) = found {
            self.detect(broken);
        }
        found.is_some()
    }

    /// Whether the interrupt of the error correction is asserted.
    pub fn interrupt(&self) -> bool {
        self.ecc & ECC_DETECTED != 0
    }

    /// Whether the program may write to the array now.
    pub fn is_programming(&self) -> bool {
        let cr = self.registers.get(CR);
        cr & LOCK == 0 && cr & PROGRAM != 0
    }

    /// Whether a page is being erased or a double word programmed: nothing else may be, and a read of its bank would stall.
    pub fn is_busy(&self, now: u64) -> bool {
        now < self.busy_until
    }

    /// When it ends.
    pub fn busy_until(&self) -> u64 {
        self.busy_until
    }

    /// Whether the chip takes the word for `address`: the first and then the second of a double word that is blank, and no
    /// other, but for zeros. `old` is the double word as it is.
    pub fn takes(&mut self, address: u32, old: [u8; 8], new: [u8; 4]) -> bool {
        let first = address & !7;
        let begun = self.begun.take();
        let blank = match begun {
            _ if address == first => old == BLANK && !self.broken.contains(&first),
            Some((begun, blank)) if begun == first => blank,
            _ => {
                self.status |= SEQUENCE_ERROR;
                return false;
            }
        };
        let taken = blank || new == [0; 4];
        if !taken {
            self.status |= PROGRAM_ERROR;
        } else if address == first {
            self.begun = Some((first, blank));
        }
        taken
    }

    /// Records a word; with the second one the double word is programmed.
    pub fn programmed(&mut self, address: u32, now: u64) {
        if !address.is_multiple_of(8) {
            self.status |= END_OF_OPERATION;
            self.busy_until = now + PROGRAM_TICKS;
        }
    }

    /// A bus read.
    pub fn read(&self, offset: u32, now: u64) -> Result<u32, Unmodelled> {
        match offset {
            SR => Ok(self.status | if self.is_busy(now) { BUSY } else { 0 }),
            ECCR => Ok(self.ecc),
            _ => self.registers.read(offset),
        }
    }

    /// A bus write. Returns the offset of a page to be erased.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> Result<Option<u32>, Unmodelled> {
        match offset {
            CR if self.is_busy(now) => {
                let access = format!("write of {value:#x} while it is busy");
                return Err(self.registers.unmodelled(access, offset));
            }
            KEYR => {
                if self.key == 0x4567_0123 && value == 0xCDEF_89AB {
                    self.registers.set(CR, self.registers.get(CR) & !LOCK);
                }
                self.key = value;
            }
            SR => self.status &= !value,
            ECCR => {
                if value & ECC_DETECTED != 0 {
                    self.ecc = 0;
                }
            }
            OPTKEYR => {
                let locked = self.registers.get(CR) & LOCK != 0;
                if !locked && self.option_key == 0x0819_2A3B && value == 0x4C5D_6E7F {
                    self.registers
                        .set(CR, self.registers.get(CR) & !OPTION_LOCK);
                }
                self.option_key = value;
            }
            OPTR if self.registers.get(CR) & OPTION_LOCK != 0 => {
                let access = format!("write of {value:#x} while locked");
                return Err(self.registers.unmodelled(access, offset));
            }
            CR if self.registers.get(CR) & LOCK != 0 => {
                let access = format!("write of {value:#x} while locked");
                return Err(self.registers.unmodelled(access, offset));
            }
            CR => {
                let open = self.registers.get(CR) & OPTION_LOCK == 0;
                if open && value & OPTION_START != 0 {
                    self.stored_options = self.registers.get(OPTR);
                }
                self.launches |= open && value & OPTION_LAUNCH != 0;
                // Locks are closed by writing and opened by keys only.
                let locks = value | self.registers.get(CR) & (LOCK | OPTION_LOCK);
                let kept = !(START | OPTION_START | OPTION_LAUNCH);
                self.registers.set(CR, locks & kept);
                return Ok(self.erased(value, now));
            }
            _ => self.registers.write(offset, value)?,
        }
        Ok(None)
    }

    fn erased(&mut self, command: u32, now: u64) -> Option<u32> {
        if command & PAGE_ERASE == 0 || command & START == 0 {
            return None;
        }
        self.status |= END_OF_OPERATION;
        self.busy_until = now + ERASE_TICKS;
        let (page, bank) = (command >> 3 & 0x7F, command >> 11 & 1);
        Some((bank * PAGES_PER_BANK + page) * PAGE)
    }
}
