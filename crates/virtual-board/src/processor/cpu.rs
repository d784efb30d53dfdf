//! The processor: Unicorn's Cortex-M4F with exception entry and return, WFE and SEV added around it.
//!
//! Unicorn executes instructions; everything that the architecture does between instructions is here,
//! after the ARMv7-M Architecture Reference Manual, B1.5.

use unicorn_engine::{Arch, Mode, Prot, RegisterARM as R, Unicorn, uc_error};

use crate::TICK_HZ;
use crate::error::BoardError;
use crate::machine::Machine;
use crate::machine::bus::FACTORY_VALUES;
use crate::peripherals::flash::Step;
use crate::processor::block::{Block, Conditions};

pub(crate) type Core = Unicorn<'static, Machine>;

pub(crate) const FLASH: u32 = 0x0800_0000;
pub(crate) const FLASH_SIZE: u32 = 512 * 1024;
/// The last two pages, which the program erases and programs.
const CALIBRATION: u32 = FLASH + FLASH_SIZE - 2 * crate::peripherals::flash::PAGE;
const CALIBRATION_SIZE: u64 = 2 * crate::peripherals::flash::PAGE as u64;
pub(crate) const RAM: u32 = 0x2000_0000;
pub(crate) const RAM_SIZE: u32 = 128 * 1024;
/// What RAM holds at power-up. On silicon that is anything; here a word that was never written can be told apart.
pub(crate) const UNTOUCHED: u32 = 0xA5C3_965A;
/// Page of the constants that the factory leaves.
const FACTORY: u64 = 0x1FFF_7000;
/// Where a return from an exception "jumps" to; a page of NOPs, so that the jump itself succeeds.
const RETURNS: u64 = 0xFFFF_F000;
const WFE: u16 = 0xBF20;
const NOP: u16 = 0xBF00;
/// xPSR: stack pointer was padded to 8 bytes.
const PADDED: u32 = 1 << 9;
const THUMB: u32 = 1 << 24;
/// CFSR: precise bus error with its address, on stacking, on fetching; execution forbidden; undefined instruction.
const PRECISE: u32 = 1 << 9 | 1 << 15;
const ON_STACKING: u32 = 1 << 12;
const ON_FETCH: u32 = 1 << 8;
const FORBIDDEN: u32 = 1;
const UNDEFINED: u32 = 1 << 16;
/// CONTROL: the interrupted code has used the floating-point unit.
const FPCA: u64 = 4;
const BASIC: [R; 7] = [R::R0, R::R1, R::R2, R::R3, R::R12, R::LR, R::PC];
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
/// What a handler finds in the floating-point registers that it has to treat as lost.
const POISON: u64 = 0x7FC0_DEAD;

/// The processor and how its exceptions behave.
pub(crate) struct Cpu {
    pub core: Core,
    /// Off only to show that its absence is noticed.
    pub stacks_floats: bool,
    /// Address of the WFE at which the program sleeps.
    asleep: Option<u32>,
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
            Err(_) if self.halfword(pc - 2)? == WFE => self.wait_for_event(pc - 2),
            Err(error) => self.fault(error),
        }
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
            machine.now = machine.horizon();
            if machine.now == u64::MAX {
                return Err(self.stopped("sleeps for ever".into()));
            }
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
        let writes = match self.machine().advance() {
            Ok(writes) => writes,
            Err(unmodelled) => return Err(self.stopped(unmodelled.to_string())),
        };
        for (address, value) in writes {
            self.core
                .mem_write(u64::from(address), &value.to_le_bytes())?;
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

    fn enter(&mut self, exception: u32) -> Result<(), BoardError> {
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

    fn leave_exception(&mut self, exc_return: u32) -> Result<(), BoardError> {
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

    /// Makes reads of the calibration's pages visible while a double word in flash is broken: a hook on every read would
    /// slow all of them down.
    pub fn guard_flash(&mut self) -> Result<(), BoardError> {
        let readable = if self.machine().flash.has_broken() {
            Prot::NONE
        } else {
            Prot::READ
        };
        self.core
            .mem_protect(u64::from(CALIBRATION), CALIBRATION_SIZE, readable)?;
        Ok(())
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

fn map_memory(core: &mut Core) -> Result<(), uc_error> {
    core.mem_map(
        u64::from(FLASH),
        u64::from(FLASH_SIZE),
        Prot::READ | Prot::EXEC,
    )?;
    core.mem_map(u64::from(RAM), u64::from(RAM_SIZE), Prot::ALL)?;
    let untouched = UNTOUCHED.to_le_bytes().repeat(RAM_SIZE as usize / 4);
    core.mem_write(u64::from(RAM), &untouched)?;
    let erased = vec![0xFF; FLASH_SIZE as usize];
    core.mem_write(u64::from(FLASH), &erased)?;
    core.mem_map(FACTORY, 0x1000, Prot::READ)?;
    for (address, value) in FACTORY_VALUES {
        core.mem_write(u64::from(address), &value.to_le_bytes())?;
    }
    core.mem_map(RETURNS, 0x1000, Prot::READ | Prot::EXEC)?;
    let nops: Vec<u8> = NOP.to_le_bytes().repeat(0x800);
    core.mem_write(RETURNS, &nops)
}

fn map_peripherals(core: &mut Core) -> Result<(), uc_error> {
    let regions = [
        (0x4000_0000, 0x3_0000),
        (0x4800_0000, 0x2000),
        (0x5000_0000, 0x1000),
        (0xE000_0000, 0x10_0000),
    ];
    for (first, size) in regions {
        let read = move |core: &mut Unicorn<'_, Machine>, offset: u64, size: usize| {
            read_bus(core, (first + offset) as u32, size)
        };
        let write = move |core: &mut Unicorn<'_, Machine>, offset: u64, size: usize, value: u64| {
            write_bus(core, (first + offset) as u32, size, value as u32);
        };
        core.mmio_map(first, size, Some(read), Some(write))?;
    }
    Ok(())
}

fn read_bus(core: &mut Unicorn<'_, Machine>, address: u32, size: usize) -> u64 {
    let machine = core.get_data_mut();
    match machine.read(address) {
        Ok(value) if size < 4 => u64::from(value & ((1 << (8 * size)) - 1)),
        Ok(value) => u64::from(value),
        Err(unmodelled) => {
            machine.failure.get_or_insert(unmodelled.to_string());
            let _ = core.emu_stop();
            0
        }
    }
}

fn write_bus(core: &mut Unicorn<'_, Machine>, address: u32, _size: usize, value: u32) {
    let machine = core.get_data_mut();
    match machine.write(address, value) {
        Ok(None) => machine.next_event = machine.horizon(),
        Ok(Some(page)) => erase(core, page),
        Err(unmodelled) => {
            machine.failure.get_or_insert(unmodelled.to_string());
            let _ = core.emu_stop();
            return;
        }
    }
    if core.get_data().nvic.reset_requested {
        let _ = core.emu_stop();
    }
}

fn erase(core: &mut Unicorn<'_, Machine>, page: u32) {
    let kept = match core.get_data_mut().flash.step() {
        Step::Whole => 0,
        Step::Torn(kept) => kept,
        Step::Nothing => return,
    };
    let address = FLASH + page;
    let size = crate::peripherals::flash::PAGE as usize;
    let erased = core
        .mem_read_as_vec(u64::from(address), size)
        .and_then(|mut bytes| {
            for (k, byte) in bytes.iter_mut().enumerate() {
                *byte |= !kept.rotate_left(k as u32) as u8;
            }
            core.mem_write(u64::from(address), &bytes)
        });
    let machine = core.get_data_mut();
    match (erased, kept) {
        (Err(error), _) => machine.failure = Some(format!("erasing at {page:#x}: {error:?}")),
        (Ok(()), 0) => machine.flash.mend_page(address),
        (Ok(()), _) => {}
    }
}

/// Counts time, and leaves the emulation when something is due, before the block runs.
fn hook_blocks(core: &mut Core) -> Result<(), uc_error> {
    let mut known = std::collections::HashMap::new();
    let mut conditions = Conditions::default();
    let hook = move |core: &mut Unicorn<'_, Machine>, address: u64, size: u32| {
        let waiting = core.get_data().nvic.is_waiting();
        let masked = waiting && core.reg_read(R::PRIMASK).unwrap_or(0) & 1 == 1;
        let machine = core.get_data_mut();
        let due = machine.now >= machine.next_event || machine.stop;
        let interruptible = !conditions.reach_into(address);
        if interruptible && (due || (waiting && !masked) || address >= RETURNS) {
            let _ = core.emu_stop();
            return;
        }
        let outside = !(u64::from(FLASH)..u64::from(RAM)).contains(&address);
        if outside && machine.nvic.forbids_execution(address as u32) {
            machine.executed_forbidden = true;
            let _ = core.emu_stop();
            return;
        }
        let block = known.entry((address, size)).or_insert_with(|| {
            let bytes = core.mem_read_as_vec(address, size as usize);
            Block::of(&bytes.unwrap_or_default())
        });
        conditions.pass(block, address + u64::from(size));
        let machine = core.get_data_mut();
        let cycle = machine.cycle.unwrap_or(0);
        machine.now += u64::from(block.instructions) * cycle * machine.half_cycles / 2;
        machine.tally.instructions += u64::from(block.instructions);
        machine.event_register |= block.sends;
        if let Some(profile) = &mut machine.profile {
            *profile.entry(address).or_default() += u64::from(block.instructions);
        }
    };
    core.add_block_hook(1, 0, hook).map(|_| ())
}

/// The array is written by the program only while the interface is open, and only from 1 to 0.
fn hook_flash(core: &mut Core) -> Result<(), uc_error> {
    use unicorn_engine::{HookType, MemType};
    let write =
        |core: &mut Unicorn<'_, Machine>, _: MemType, address: u64, size: usize, value: i64| {
            let in_flash = (u64::from(FLASH)..u64::from(FLASH + FLASH_SIZE)).contains(&address);
            if !in_flash || !core.get_data().flash.is_programming() {
                core.get_data_mut().failure = Some(format!("write to {address:#x}"));
                return false;
            }
            program(core, address, &value.to_le_bytes()[..size.min(8)]).is_ok()
        };
    core.add_mem_hook(HookType::MEM_WRITE_PROT, 1, 0, write)?;
    let unreachable =
        |core: &mut Unicorn<'_, Machine>, _: MemType, address: u64, _: usize, _: i64| {
            core.get_data_mut().unreachable = Some(address as u32);
            false
        };
    core.add_mem_hook(HookType::MEM_UNMAPPED, 1, 0, unreachable)?;
    let read = |core: &mut Unicorn<'_, Machine>, _: MemType, address: u64, _: usize, _: i64| {
        let machine = core.get_data_mut();
        if machine.flash.check(address as u32) {
            machine.next_event = machine.now;
        }
        true
    };
    core.add_mem_hook(HookType::MEM_READ_PROT, 1, 0, read)
        .map(|_| ())
}

fn program(core: &mut Unicorn<'_, Machine>, address: u64, new: &[u8]) -> Result<(), uc_error> {
    let old = core.mem_read_as_vec(address, new.len())?;
    let kept = match core.get_data_mut().flash.step() {
        Step::Whole => 0,
        Step::Torn(kept) => kept,
        Step::Nothing => u32::MAX,
    };
    let bits = old.iter().zip(new).enumerate();
    let result: Vec<u8> = bits
        .map(|(k, (old, new))| old & (new | kept.rotate_left(8 * k as u32) as u8))
        .collect();
    let machine = core.get_data_mut();
    machine.flash.programmed();
    if machine.flash.has_failed {
        machine.flash.break_word(address as u32);
        machine.next_event = machine.now;
    }
    core.mem_write(address, &result)
}
