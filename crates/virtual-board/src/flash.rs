//! The flash interface: access control, unlocking, erasing pages and programming double words.

use crate::registers::{Registers, Unmodelled};

const KEYR: u32 = 0x08;
const SR: u32 = 0x10;
const CR: u32 = 0x14;
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
}

impl Flash {
    /// After reset: locked.
    pub fn new() -> Self {
        Flash {
            registers: Registers::new("FLASH", RESET),
            status: 0,
            key: 0,
        }
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
