//! Both banks of flash, by registers. The loader runs from bank 1: while that is erased or programmed, it stands still.
// Flash is memory at fixed addresses.
#![allow(unsafe_code)]

use cortex_m::asm;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use stm32_metapac::FLASH;
use stm32_metapac::flash::regs::Sr;
use update::MappedFlash;
use update::layout::{BANK_BYTES, FLASH_BASE, PAGE_BYTES};

use crate::{supply, watchdog};

const FLASH_BYTES: u32 = 2 * BANK_BYTES;
const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];
/// SR: all errors. Each is cleared by writing it as 1, and forbids the next operation until then.
const ERRORS: u32 = 0xC3FA;
/// Bytes that are programmed at once.
const UNIT_BYTES: usize = 8;

/// The chip's flash.
pub struct ChipFlash(());

/// Why flash was not read, erased or programmed.
#[derive(Clone, Copy, Debug)]
pub enum FlashError {
    /// The supply is below the voltage detector's level.
    LowSupply,
    /// The chip refused.
    Refused,
    /// Outside of flash.
    OutOfBounds,
    /// Not whole pages or double words.
    NotAligned,
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            FlashError::LowSupply | FlashError::Refused => NorFlashErrorKind::Other,
            FlashError::OutOfBounds => NorFlashErrorKind::OutOfBounds,
            FlashError::NotAligned => NorFlashErrorKind::NotAligned,
        }
    }
}

impl ChipFlash {
    /// The only one.
    pub fn new() -> Self {
        ChipFlash(())
    }

    /// The instruction cache may hold code of a page as it was.
    pub fn forget_instructions(&mut self) {
        FLASH.acr().modify(|w| w.set_icen(false));
        FLASH.acr().modify(|w| w.set_icrst(true));
        FLASH.acr().modify(|w| w.set_icrst(false));
        FLASH.acr().modify(|w| w.set_icen(true));
    }
}

/// Flash unlocked and without errors of earlier operations, its data cache off; locked and on again afterwards.
fn unlocked(operate: impl FnOnce() -> Result<(), FlashError>) -> Result<(), FlashError> {
    if supply::is_low() {
        return Err(FlashError::LowSupply);
    }
    if FLASH.cr().read().lock() {
        KEYS.into_iter()
            .for_each(|key| FLASH.keyr().write_value(key));
    }
    FLASH.acr().modify(|w| w.set_dcen(false));
    FLASH.sr().write_value(Sr(ERRORS));
    let done = operate();
    FLASH.cr().modify(|w| w.set_lock(true));
    // The data cache may hold bytes as they were.
    FLASH.acr().modify(|w| w.set_dcrst(true));
    FLASH.acr().modify(|w| w.set_dcrst(false));
    FLASH.acr().modify(|w| w.set_dcen(true));
    done
}

/// Waits for the end of an operation; whether it was done.
fn wait() -> Result<(), FlashError> {
    while FLASH.sr().read().bsy() {
        watchdog::feed();
    }
    let errors = FLASH.sr().read().0 & ERRORS;
    FLASH.sr().write_value(Sr(errors | 1));
    match errors {
        0 => Ok(()),
        _ => Err(FlashError::Refused),
    }
}

fn erase_page(page: u32) -> Result<(), FlashError> {
    let in_bank = page % (BANK_BYTES / PAGE_BYTES);
    FLASH.cr().modify(|w| {
        w.set_per(true);
        w.set_bker(page != in_bank);
        w.set_pnb(in_bank as u8);
    });
    FLASH.cr().modify(|w| w.set_strt(true));
    let erased = wait();
    FLASH.cr().modify(|w| w.set_per(false));
    erased
}

fn program(offset: u32, unit: &[u8; UNIT_BYTES]) -> Result<(), FlashError> {
    let (words, _) = unit.as_chunks::<4>();
    FLASH.cr().modify(|w| w.set_pg(true));
    for (at, word) in (FLASH_BASE + offset..).step_by(4).zip(words) {
        // Safety: an aligned word of flash, whose interface takes it while PG is set. Nobody holds a reference to it.
        unsafe { (at as *mut u32).write_volatile(u32::from_le_bytes(*word)) };
        asm::isb();
    }
    let programmed = wait();
    FLASH.cr().modify(|w| w.set_pg(false));
    programmed
}

fn check(offset: u32, length: usize, unit: u32) -> Result<(), FlashError> {
    let length = u32::try_from(length).map_err(|_| FlashError::OutOfBounds)?;
    let end = offset.checked_add(length);
    if end.is_none_or(|end| end > FLASH_BYTES) {
        return Err(FlashError::OutOfBounds);
    }
    let aligned = offset.is_multiple_of(unit) && length.is_multiple_of(unit);
    aligned.then_some(()).ok_or(FlashError::NotAligned)
}

impl ErrorType for ChipFlash {
    type Error = FlashError;
}

impl ReadNorFlash for ChipFlash {
    const READ_SIZE: usize = 1;

    /// A double word that was cut off reads as anything, after `faults` has cleared its error; checksums decide.
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        check(offset, bytes.len(), 1)?;
        for (at, byte) in (FLASH_BASE + offset..).zip(bytes) {
            // Safety: within flash, and read as it lies there at this moment.
            *byte = unsafe { (at as *const u8).read_volatile() };
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        FLASH_BYTES as usize
    }
}

impl NorFlash for ChipFlash {
    const WRITE_SIZE: usize = UNIT_BYTES;
    const ERASE_SIZE: usize = PAGE_BYTES as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        check(from, to.saturating_sub(from) as usize, PAGE_BYTES)?;
        unlocked(|| (from / PAGE_BYTES..to / PAGE_BYTES).try_for_each(erase_page))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        check(offset, bytes.len(), UNIT_BYTES as u32)?;
        let (units, _) = bytes.as_chunks::<UNIT_BYTES>();
        let mut places = (offset..).step_by(UNIT_BYTES).zip(units);
        unlocked(|| places.try_for_each(|(at, unit)| program(at, unit)))
    }
}

impl MappedFlash for ChipFlash {
    fn bytes(&self, from: u32, length: u32) -> &[u8] {
        match check(from, length as usize, 1) {
            // Safety: all of it is flash, which is always readable, and changes only through `&mut self`.
            Ok(()) => unsafe {
                let first = (FLASH_BASE + from) as *const u8;
                core::slice::from_raw_parts(first, length as usize)
            },
            Err(_) => &[],
        }
    }
}
