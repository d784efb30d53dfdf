//! The memory map, and what happens when the program reads, writes or executes there.

use unicorn_engine::{Prot, Unicorn, uc_error};
use update::layout::BANK_BYTES;

use super::{Core, FLASH, FLASH_SIZE, R, RAM, RAM_SIZE, RETURNS};
use crate::machine::Machine;
use crate::machine::bus::FACTORY_VALUES;
use crate::peripherals::flash::Step;
use crate::processor::block::{Block, Conditions};

/// What RAM holds at power-up. On silicon that is anything; here a word that was never written can be told apart.
const UNTOUCHED: u32 = 0xA5C3_965A;
/// Page of the constants that the factory leaves.
const FACTORY: u64 = 0x1FFF_7000;
const NOP: u16 = 0xBF00;

pub(super) fn map_memory(core: &mut Core) -> Result<(), uc_error> {
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

pub(super) fn map_peripherals(core: &mut Core) -> Result<(), uc_error> {
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
    machine.flash.erasures = machine.flash.erasures.wrapping_add(1);
    match (erased, kept) {
        (Err(error), _) => machine.failure = Some(format!("erasing at {page:#x}: {error:?}")),
        (Ok(()), 0) => machine.flash.mend_page(address),
        (Ok(()), _) => {}
    }
    stall(core, address);
}

/// Counts time, and leaves the emulation when something is due, before the block runs.
pub(super) fn hook_blocks(core: &mut Core) -> Result<(), uc_error> {
    let (mut known, mut erasures) = (std::collections::HashMap::new(), 0);
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
        if machine.flash.erasures != erasures {
            erasures = machine.flash.erasures;
            known.clear();
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
pub(super) fn hook_flash(core: &mut Core) -> Result<(), uc_error> {
    use unicorn_engine::{HookType, MemType};
    let write =
        |core: &mut Unicorn<'_, Machine>, _: MemType, address: u64, size: usize, value: i64| {
            let in_flash = (u64::from(FLASH)..u64::from(FLASH + FLASH_SIZE)).contains(&address);
            if !in_flash || !core.get_data().flash.is_programming() {
                core.get_data_mut().failure = Some(format!("write to {address:#x}"));
                return false;
            }
            let machine = core.get_data_mut();
            if machine.flash.is_busy(machine.now) {
                machine.failure = Some(format!("{address:#x} programmed while flash is busy"));
                return false;
            }
            match (size, address % 4) {
                (4, 0) => program(core, address, (value as u32).to_le_bytes()).is_ok(),
                _ => {
                    machine.failure = Some(format!("{size} bytes programmed at {address:#x}"));
                    false
                }
            }
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

/// Code stands still while its own bank is erased or programmed.
fn stall(core: &mut Unicorn<'_, Machine>, address: u32) {
    let pc = core.reg_read(R::PC).unwrap_or(0) as u32;
    let bank = |address: u32| address.wrapping_sub(FLASH) / BANK_BYTES;
    let machine = core.get_data_mut();
    if bank(pc) == bank(address) && machine.flash.is_busy(machine.now) {
        machine.now = machine.flash.busy_until();
        machine.next_event = machine.now;
    }
}

fn program(core: &mut Unicorn<'_, Machine>, address: u64, new: [u8; 4]) -> Result<(), uc_error> {
    let mut double = [0; 8];
    core.mem_read(address & !7, &mut double)?;
    if !core.get_data_mut().flash.takes(address as u32, double, new) {
        return Ok(());
    }
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
    machine.flash.programmed(address as u32, machine.now);
    if machine.flash.has_failed {
        machine.flash.break_word(address as u32);
        machine.next_event = machine.now;
    }
    core.mem_write(address, &result)?;
    stall(core, address as u32);
    Ok(())
}
