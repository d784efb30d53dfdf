//! What a test does to the processor and its memory from outside: faults, calls, broken flash.

use std::ops::Range;

use unicorn_engine::{Prot, Unicorn};
use update::layout::{JOURNAL, PROGRAM, WAITING};

use super::{Cpu, FLASH, FLASH_SIZE, R, RAM, RAM_SIZE};
use crate::error::BoardError;
use crate::machine::Machine;

/// What is erased and programmed, and what may go on unseen beside a broken double word: the journal of updates, the program,
/// which runs; in bank 2 what waits, configuration, event log and calibration.
const CHANGED: [(Range<u32>, Prot); 3] = [
    (FLASH + JOURNAL..FLASH + PROGRAM, Prot::NONE),
    (FLASH + PROGRAM..FLASH + WAITING, Prot::EXEC),
    (FLASH + WAITING..FLASH + FLASH_SIZE, Prot::NONE),
];
const CORE_REGISTERS: [R; 13] = [
    R::R0,
    R::R1,
    R::R2,
    R::R3,
    R::R4,
    R::R5,
    R::R6,
    R::R7,
    R::R8,
    R::R9,
    R::R10,
    R::R11,
    R::R12,
];

impl Cpu {
    /// Goes on at `address` with registers from r0 on.
    pub fn divert(&mut self, address: u32, registers: &[u32]) -> Result<(), BoardError> {
        self.asleep = None;
        for (register, value) in CORE_REGISTERS.into_iter().zip(registers) {
            self.core.reg_write(register, u64::from(*value))?;
        }
        self.core.reg_write(R::PC, u64::from(address) | 1)?;
        Ok(())
    }

    /// Moves the stack pointer.
    pub fn move_stack(&mut self, address: u32) -> Result<(), BoardError> {
        Ok(self.core.reg_write(R::SP, u64::from(address))?)
    }

    /// Code that was translated before a hook was added does not call it.
    fn forget_translation(&mut self) -> Result<(), BoardError> {
        self.core.ctl_flush_tb()?;
        Ok(self.core.ctl_flush_tlb()?)
    }

    /// Holds a bit of memory at a level.
    pub fn stick_ram_bit(&mut self, address: u32, bit: u32, level: bool) -> Result<(), BoardError> {
        use unicorn_engine::{HookType, MemType};
        let first = u64::from(address & !3);
        let hook = move |core: &mut Unicorn<'_, Machine>, _: MemType, _: u64, _: usize, _: i64| {
            let mut bytes = [0; 4];
            if core.mem_read(first, &mut bytes).is_ok() {
                let word = u32::from_le_bytes(bytes) & !(1 << bit) | u32::from(level) << bit;
                let _ = core.mem_write(first, &word.to_le_bytes());
            }
            true
        };
        self.core
            .add_mem_hook(HookType::MEM_READ, first, first + 3, hook)?;
        self.forget_translation()
    }

    /// Returns from the function at `address` before it does anything.
    pub fn leave_out(&mut self, address: u32) -> Result<(), BoardError> {
        let at = u64::from(address & !1);
        let hook = |core: &mut Unicorn<'_, Machine>, _: u64, _: u32| {
            let back = core.reg_read(R::LR).unwrap_or(0);
            let _ = core.reg_write(R::PC, back);
        };
        self.core.add_code_hook(at, at, hook)?;
        self.forget_translation()
    }

    /// Writes a word of RAM or a register.
    pub fn poke(&mut self, address: u32, value: u32) -> Result<(), BoardError> {
        if (RAM..RAM + RAM_SIZE).contains(&address) {
            return Ok(self
                .core
                .mem_write(u64::from(address), &value.to_le_bytes())?);
        }
        match self.machine().write(address, value) {
            Ok(_) => Ok(()),
            Err(unmodelled) => Err(self.stopped(unmodelled.to_string())),
        }
    }

    /// Flips bits of a register before the instruction at `address`.
    pub fn flip_register(
        &mut self,
        address: u32,
        register: usize,
        bits: u32,
    ) -> Result<(), BoardError> {
        let register = CORE_REGISTERS[register.min(12)];
        let at = u64::from(address & !1);
        let hook = move |core: &mut Unicorn<'_, Machine>, _: u64, _: u32| {
            let value = core.reg_read(register).unwrap_or(0) ^ u64::from(bits);
            let _ = core.reg_write(register, value);
        };
        self.core.add_code_hook(at, at, hook)?;
        self.forget_translation()
    }

    /// Goes on from registers and memory that were put in place from outside.
    pub fn forget_sleep(&mut self) {
        self.asleep = None;
    }

    /// Makes reads of flash visible beside double words that are broken: a hook on every read would slow all of them down.
    pub fn guard_flash(&mut self) -> Result<(), BoardError> {
        for (places, beside) in CHANGED {
            let allowed = match self.machine().flash.has_broken(&places) {
                true => beside,
                false => beside | Prot::READ,
            };
            let size = u64::from(places.end - places.start);
            self.core
                .mem_protect(u64::from(places.start), size, allowed)?;
        }
        Ok(())
    }
}
