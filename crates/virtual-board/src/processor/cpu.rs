//! The processor: Unicorn's Cortex-M4F with exception entry and return, WFE and SEV added around it.
//!
//! Unicorn executes instructions; everything that the architecture does between instructions is here,
//! after the ARMv7-M Architecture Reference Manual, B1.5.

mod exceptions;
mod injected;
mod memory;

use memory::{hook_blocks, hook_flash, map_memory, map_peripherals};
use unicorn_engine::{Arch, Mode, RegisterARM as R, Unicorn, uc_error};

use crate::TICK_HZ;
use crate::error::BoardError;
use crate::machine::Machine;

pub(crate) type Core = Unicorn<'static, Machine>;

pub(crate) const FLASH: u32 = 0x0800_0000;
pub(crate) const FLASH_SIZE: u32 = 512 * 1024;
pub(crate) const RAM: u32 = 0x2000_0000;
pub(crate) const RAM_SIZE: u32 = 128 * 1024;
/// Where a return from an exception "jumps" to; a page of NOPs, so that the jump itself succeeds.
const RETURNS: u64 = 0xFFFF_F000;
const WFE: u16 = 0xBF20;
const THUMB: u32 = 1 << 24;
/// CFSR: precise bus error with its address, on fetching; execution forbidden; undefined instruction.
const PRECISE: u32 = 1 << 9 | 1 << 15;
const ON_FETCH: u32 = 1 << 8;
const FORBIDDEN: u32 = 1;
const UNDEFINED: u32 = 1 << 16;
const BASIC: [R; 7] = [R::R0, R::R1, R::R2, R::R3, R::R12, R::LR, R::PC];
const FLOATS: [R; 16] = [
    R::S0,
    R::S1,
    R::S2,
    R::S3,
    R::S4,
    R::S5,
    R::S6,
    R::S7,
    R::S8,
    R::S9,
    R::S10,
    R::S11,
    R::S12,
    R::S13,
    R::S14,
    R::S15,
];

/// The processor and how its exceptions behave.
pub(crate) struct Cpu {
    pub core: Core,
    /// Off only to show that its absence is noticed.
    pub stacks_floats: bool,
    /// Address of the WFE at which the program sleeps.
    asleep: Option<u32>,
    /// Pages of flash that were erased when the translation was forgotten last.
    erasures: u32,
    /// A fault within the handler of a fault: nothing runs until a reset.
    pub locked_up: bool,
}

impl Cpu {
    pub fn new(machine: Machine) -> Result<Self, BoardError> {
        let mut core = Unicorn::new_with_data(Arch::ARM, Mode::THUMB | Mode::MCLASS, machine)?;
        core.ctl_set_cpu_model(unicorn_engine::ArmCpuModel::CORTEX_M4 as i32)?;
        map_memory(&mut core)?;
        map_peripherals(&mut core)?;
        hook_blocks(&mut core)?;
        hook_flash(&mut core)?;
        Ok(Cpu {
            core,
            stacks_floats: true,
            asleep: None,
            erasures: 0,
            locked_up: false,
        })
    }

    /// Loads stack pointer and program counter from the vector table.
    pub fn reset(&mut self) -> Result<(), BoardError> {
        self.asleep = None;
        self.locked_up = false;
        for register in BASIC.into_iter().chain(FLOATS) {
            self.core.reg_write(register, 0)?;
        }
        self.core.reg_write(R::PRIMASK, 0)?;
        self.core.reg_write(R::CONTROL, 0)?;
        self.core.reg_write(R::XPSR, u64::from(THUMB))?;
        let (stack, entry) = (self.word(FLASH)?, self.word(FLASH + 4)?);
        self.core.reg_write(R::SP, u64::from(stack))?;
        self.core.reg_write(R::PC, u64::from(entry))?;
        self.core.reg_write(R::FPEXC, 0x4000_0000)?;
        Ok(())
    }

    pub fn machine(&mut self) -> &mut Machine {
        self.core.get_data_mut()
    }

    /// Executes until something happens that is not an instruction.
    pub fn run(&mut self) -> Result<(), BoardError> {
        if self.locked_up || self.core.get_data().cycle.is_none() {
            return self.stand_still();
        }
        if let Some(pc) = self.asleep {
            return self.wait_for_event(pc);
        }
        let begin = self.core.reg_read(R::PC)? | 1;
        let ended = self.core.emu_start(begin, u64::MAX, 0, 0);
        if let Some(failure) = self.machine().failure.take() {
            return Err(self.stopped(failure));
        }
        let pc = self.core.reg_read(R::PC)? as u32;
        if std::mem::take(&mut self.machine().executed_forbidden) {
            return self.fault(uc_error::FETCH_PROT);
        }
        if u64::from(pc) >= RETURNS {
            return self.leave_exception(pc | 1);
        }
        match ended {
            Ok(()) => Ok(()),
            // The emulator gives up behind the instruction.
            Err(_) if self.is_wait(pc - 2) => self.wait_for_event(pc - 2),
            Err(error) => self.fault(error),
        }
    }

    /// Whether the program waits for an event at `pc`. What went astray may have no memory there.
    fn is_wait(&self, pc: u32) -> bool {
        self.halfword(pc)
            .is_ok_and(|instruction| instruction == WFE)
    }

    /// An instruction that cannot be executed: a hard fault, because no other handler is enabled.
    fn fault(&mut self, error: uc_error) -> Result<(), BoardError> {
        let pc = self.core.reg_read(R::PC)? as u32;
        let status = match error {
            uc_error::READ_UNMAPPED | uc_error::WRITE_UNMAPPED => PRECISE,
            uc_error::FETCH_UNMAPPED => ON_FETCH,
            uc_error::FETCH_PROT => FORBIDDEN,
            uc_error::INSN_INVALID | uc_error::EXCEPTION => UNDEFINED,
            _ => return Err(self.stopped(format!("{error:?}"))),
        };
        let address = self.machine().unreachable.take();
        self.hard_fault(status, address.filter(|_| status == PRECISE), pc)
    }

    fn hard_fault(&mut self, status: u32, address: Option<u32>, pc: u32) -> Result<(), BoardError> {
        self.machine().faults.push((status, pc));
        if self.machine().nvic.take_hard_fault(status, address) {
            return self.enter(3);
        }
        self.locked_up = true;
        Ok(())
    }

    /// Nothing is executed: time goes on to whatever happens without the program.
    fn stand_still(&mut self) -> Result<(), BoardError> {
        let machine = self.machine();
        machine.now = machine
            .horizon()
            .clamp(machine.now + 1, machine.now + TICK_HZ / 1_000);
        Ok(())
    }

    fn stopped(&mut self, what: String) -> BoardError {
        let [pc, lr] = [R::PC, R::LR].map(|r| self.core.reg_read(r).unwrap_or(0) as u32);
        BoardError::Stopped { what, pc, lr }
    }

    /// Sleeps until the next thing happens; the instruction stays the next one unless it is through.
    fn wait_for_event(&mut self, pc: u32) -> Result<(), BoardError> {
        let machine = self.machine();
        let wakes = machine.event_register || machine.nvic.is_waiting();
        if wakes {
            machine.event_register = false;
        } else {
            if machine.next_happening() == u64::MAX {
                return Err(self.stopped("sleeps for ever".into()));
            }
            machine.now = machine.horizon();
        }
        if self.asleep.is_none() || wakes {
            let next = if wakes { pc + 2 } else { pc };
            self.core.reg_write(R::PC, u64::from(next) | 1)?;
        }
        self.asleep = (!wakes).then_some(pc);
        Ok(())
    }

    /// Lets the peripherals catch up.
    pub fn happen(&mut self) -> Result<(), BoardError> {
        if let Err(unmodelled) = self.machine().advance() {
            return Err(self.stopped(unmodelled.to_string()));
        }
        for (address, bytes) in std::mem::take(&mut self.machine().writes).0 {
            self.core.mem_write(u64::from(address), &bytes)?;
        }
        let erasures = self.machine().flash.erasures;
        if std::mem::replace(&mut self.erasures, erasures) != erasures {
            self.core.ctl_flush_tb()?;
        }
        self.feed()
    }

    /// Carries what DMA brings from memory to ports.
    fn feed(&mut self) -> Result<(), BoardError> {
        loop {
            let transfer = match self.machine().next_feed() {
                Ok(Some(transfer)) => transfer,
                Ok(None) => return Ok(()),
                Err(unmodelled) => return Err(self.stopped(unmodelled.to_string())),
            };
            let mut byte = [0];
            self.core.mem_read(u64::from(transfer.memory), &mut byte)?;
            let written = self
                .machine()
                .write(transfer.peripheral, u32::from(byte[0]));
            if let Err(unmodelled) = written {
                return Err(self.stopped(unmodelled.to_string()));
            }
        }
    }

    pub fn word(&self, address: u32) -> Result<u32, BoardError> {
        let mut bytes = [0; 4];
        self.core.mem_read(u64::from(address), &mut bytes)?;
        Ok(u32::from_le_bytes(bytes))
    }

    fn halfword(&self, address: u32) -> Result<u16, BoardError> {
        let mut bytes = [0; 2];
        self.core.mem_read(u64::from(address), &mut bytes)?;
        Ok(u16::from_le_bytes(bytes))
    }
}
