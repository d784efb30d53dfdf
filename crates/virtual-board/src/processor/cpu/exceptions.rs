//! Entry into exceptions and return from them: frames on the stack, lazy floating-point state, vectors.
//!
//! After the ARMv7-M Architecture Reference Manual, B1.5.6 to B1.5.8.

use super::{BASIC, Cpu, FLASH, FLOATS, R, THUMB, uc_error};
use crate::error::BoardError;

/// xPSR: stack pointer was padded to 8 bytes.
const PADDED: u32 = 1 << 9;
/// CFSR: bus error on stacking.
const ON_STACKING: u32 = 1 << 12;
/// CONTROL: the interrupted code has used the floating-point unit.
const FPCA: u64 = 4;
/// What a handler finds in the floating-point registers that it has to treat as lost.
const POISON: u64 = 0x7FC0_DEAD;

impl Cpu {
    /// Takes the non-maskable interrupt of the flash, or a waiting interrupt unless PRIMASK forbids it.
    pub fn enter_exception(&mut self) -> Result<(), BoardError> {
        let machine = self.machine();
        if machine.non_maskable() && machine.nvic.take_non_maskable() {
            return self.enter(2);
        }
        if self.core.reg_read(R::PRIMASK)? & 1 == 1 {
            return Ok(());
        }
        let Some(irq) = self.machine().nvic.take() else {
            return Ok(());
        };
        self.enter(16 + irq as u32)
    }

    pub(super) fn enter(&mut self, exception: u32) -> Result<(), BoardError> {
        self.machine().tally.exceptions += 1;
        self.asleep = None;
        let with_floats = self.core.reg_read(R::CONTROL)? & FPCA != 0;
        if let Err(error) = self.push_frame(with_floats) {
            return self.fault_on_stacking(exception, error);
        }
        let handler = self.vector(exception)?;
        let exc_return: u32 = if with_floats {
            0xFFFF_FFE9
        } else {
            0xFFFF_FFF9
        };
        self.core.reg_write(R::LR, u64::from(exc_return))?;
        self.core.reg_write(R::PC, u64::from(handler))?;
        Ok(())
    }

    /// The stack is out of memory: the hard fault's handler begins without a frame.
    fn fault_on_stacking(&mut self, exception: u32, error: BoardError) -> Result<(), BoardError> {
        if !matches!(
            error,
            BoardError::Emulator(uc_error::WRITE_UNMAPPED | uc_error::WRITE_PROT)
        ) {
            return Err(error);
        }
        let pc = self.core.reg_read(R::PC)? as u32;
        self.machine().faults.push((ON_STACKING, pc));
        if exception != 3 && !self.machine().nvic.take_hard_fault(ON_STACKING, None) {
            self.locked_up = true;
            return Ok(());
        }
        let handler = self.vector(3)?;
        self.core.reg_write(R::LR, 0xFFFF_FFF9)?;
        self.core.reg_write(R::XPSR, u64::from(THUMB))?;
        self.core.reg_write(R::PC, u64::from(handler))?;
        Ok(())
    }

    fn vector(&mut self, exception: u32) -> Result<u32, BoardError> {
        let vector = self.machine().nvic.vector_table() + 4 * exception;
        self.word(if vector < FLASH {
            vector + FLASH
        } else {
            vector
        })
    }

    fn push_frame(&mut self, with_floats: bool) -> Result<(), BoardError> {
        let xpsr = self.core.reg_read(R::XPSR)? as u32;
        let sp = self.core.reg_read(R::SP)? as u32;
        let size = if with_floats { 0x68 } else { 0x20 };
        let padded = sp & 4 != 0;
        let base = (sp - size) & !7;
        let mut frame = Vec::with_capacity(26);
        for register in BASIC {
            frame.push(self.core.reg_read(register)? as u32);
        }
        frame.push(xpsr & !PADDED | if padded { PADDED } else { 0 });
        if with_floats {
            for register in FLOATS {
                frame.push(self.core.reg_read(register)? as u32);
                self.core.reg_write(register, POISON)?;
            }
            frame.extend([self.core.reg_read(R::FPSCR)? as u32, 0]);
            let control = self.core.reg_read(R::CONTROL)?;
            self.core.reg_write(R::CONTROL, control & !FPCA)?;
        }
        let bytes: Vec<u8> = frame.iter().flat_map(|word| word.to_le_bytes()).collect();
        self.core.reg_write(R::SP, u64::from(base))?;
        self.core.mem_write(u64::from(base), &bytes)?;
        // The handler starts outside any IT block.
        self.core
            .reg_write(R::XPSR, u64::from(xpsr & 0xF80F_0000 | THUMB))?;
        Ok(())
    }

    pub(super) fn leave_exception(&mut self, exc_return: u32) -> Result<(), BoardError> {
        let with_floats = match exc_return {
            0xFFFF_FFE9 => true,
            0xFFFF_FFF9 => false,
            _ => return Err(self.stopped(format!("return from exception with {exc_return:#x}"))),
        };
        if self.machine().nvic.leave().is_none() {
            return Err(self.stopped("return from an exception that was not taken".into()));
        }
        let base = self.core.reg_read(R::SP)? as u32;
        let words = if with_floats { 26 } else { 8 };
        let bytes = self.core.mem_read_as_vec(u64::from(base), 4 * words)?;
        let (chunks, _) = bytes.as_chunks::<4>();
        let frame: Vec<u32> = chunks
            .iter()
            .map(|word| u32::from_le_bytes(*word))
            .collect();
        let (basic, floats) = frame.split_at(8);
        let xpsr = basic[7];
        self.core.reg_write(R::XPSR, u64::from(xpsr & !PADDED))?;
        for (register, value) in BASIC.into_iter().zip(basic) {
            self.core.reg_write(register, u64::from(*value))?;
        }
        self.core.reg_write(R::PC, u64::from(basic[6]) | 1)?;
        let control = self.core.reg_read(R::CONTROL)? & !FPCA;
        self.core
            .reg_write(R::CONTROL, control | if with_floats { FPCA } else { 0 })?;
        if with_floats && self.stacks_floats {
            for (register, value) in FLOATS.into_iter().zip(floats) {
                self.core.reg_write(register, u64::from(*value))?;
            }
            self.core.reg_write(R::FPSCR, u64::from(floats[16]))?;
        }
        let padding = if xpsr & PADDED != 0 { 4 } else { 0 };
        let sp = base + 4 * words as u32 + padding;
        self.core.reg_write(R::SP, u64::from(sp))?;
        let machine = self.machine();
        machine.event_register = true;
        machine.update_lines();
        Ok(())
    }
}
