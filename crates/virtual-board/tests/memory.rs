//! The firmware's own copying and clearing of words (src/hardware/memory.rs), routine by routine on a bare processor.

mod common;

use common::{board as board_of, scenario};
use rand::{RngCore, SeedableRng};
use rand_pcg::Pcg32;
use unicorn_engine::{Arch, Mode, Prot, RegisterARM as R, Unicorn};

const FLASH: u32 = 0x0800_0000;
const FLASH_BYTES: usize = 0x4_0000;
const RAM: u64 = 0x2000_0000;
const RAM_BYTES: usize = 0x1_0000;
const STACK: u64 = RAM + 0xF000;
/// Where a routine returns to.
const RETURN: u64 = FLASH as u64 + 0x100;
/// Both places have room for the longest piece.
const FROM: usize = 0x100;
const TO: usize = 0x1000;
/// A few more than two times eight words, so that every way through the routines is gone, and long pieces as motors are.
const LENGTHS: [usize; 4] = [252, 332, 1_012, 1_100];
const KEPT: [R; 8] = [R::R4, R::R5, R::R6, R::R7, R::R8, R::R9, R::R10, R::R11];

struct Bare {
    core: Unicorn<'static, ()>,
    random: Pcg32,
}

impl Bare {
    fn new(flash: &[u8]) -> Self {
        let mut core = Unicorn::new(Arch::ARM, Mode::MCLASS).expect("a processor");
        core.mem_map(u64::from(FLASH), flash.len() as u64, Prot::ALL)
            .expect("flash");
        core.mem_write(u64::from(FLASH), flash).expect("a program");
        core.mem_map(RAM, RAM_BYTES as u64, Prot::ALL).expect("RAM");
        Bare {
            core,
            random: Pcg32::seed_from_u64(4),
        }
    }

    /// RAM before and behind a call of `routine` with these arguments, and whether registers are kept as the ABI asks.
    fn call(&mut self, routine: u32, arguments: &[u64]) -> [Vec<u8>; 2] {
        let mut before = vec![0; RAM_BYTES];
        self.random.fill_bytes(&mut before);
        self.core.mem_write(RAM, &before).expect("RAM");
        for (register, value) in [R::R0, R::R1, R::R2].into_iter().zip(arguments) {
            self.core.reg_write(register, *value).expect("a register");
        }
        for (k, register) in KEPT.into_iter().enumerate() {
            let value = 0xA5A5_0000 + k as u64;
            self.core.reg_write(register, value).expect("a register");
        }
        self.core.reg_write(R::SP, STACK).expect("a register");
        self.core.reg_write(R::LR, RETURN | 1).expect("a register");
        let begin = u64::from(routine) | 1;
        self.core
            .emu_start(begin, RETURN, 0, 100_000)
            .expect("a run");
        assert_eq!(self.core.reg_read(R::PC), Ok(RETURN), "it returns");
        assert_eq!(self.core.reg_read(R::SP), Ok(STACK), "the stack");
        for (k, register) in KEPT.into_iter().enumerate() {
            assert_eq!(self.core.reg_read(register), Ok(0xA5A5_0000 + k as u64));
        }
        let mut after = vec![0; RAM_BYTES];
        self.core.mem_read(RAM, &mut after).expect("RAM");
        // What lies below the stack pointer is nobody's.
        let stack = (STACK - RAM) as usize;
        for ram in [&mut before, &mut after] {
            ram[stack - 64..stack].fill(0);
        }
        [before, after]
    }
}

/// The routine of this name in the firmware, on a processor of its own.
fn firmware_with(routine: &str) -> (Bare, u32) {
    let mut board = board_of(&scenario(1.0));
    let address = board.symbol(routine).expect("a routine");
    let flash = board.read_flash(FLASH, FLASH_BYTES).expect("flash");
    (Bare::new(&flash), address)
}

fn lengths() -> impl Iterator<Item = usize> {
    (0..=2 * 32 + 9).chain(LENGTHS)
}

#[test]
fn words_are_copied_and_nothing_else() {
    for name in ["__aeabi_memcpy4", "__aeabi_memcpy8"] {
        let (mut bare, routine) = firmware_with(name);
        for length in lengths() {
            let arguments = [RAM + TO as u64, RAM + FROM as u64, length as u64];
            let [mut before, after] = bare.call(routine, &arguments);
            before.copy_within(FROM..FROM + length, TO);
            assert!(before == after, "{name}, {length} bytes");
        }
    }
}

#[test]
fn words_are_cleared_and_nothing_else() {
    for name in ["__aeabi_memclr4", "__aeabi_memclr8"] {
        let (mut bare, routine) = firmware_with(name);
        for length in lengths() {
            let [mut before, after] = bare.call(routine, &[RAM + TO as u64, length as u64]);
            before[TO..TO + length].fill(0);
            assert!(before == after, "{name}, {length} bytes");
        }
    }
}

/// Instructions of a copy, which the virtual board counts: five a word before.
#[test]
fn a_long_copy_takes_less_than_two_instructions_a_word() {
    let (mut bare, routine) = firmware_with("__aeabi_memcpy4");
    let bytes = 1_012_u64;
    let counted = std::rc::Rc::new(std::cell::Cell::new(0_u64));
    let count = counted.clone();
    bare.core
        .add_code_hook(1, 0, move |_, _, _| count.set(count.get() + 1))
        .expect("a hook");
    bare.call(routine, &[RAM + TO as u64, RAM + FROM as u64, bytes]);
    assert!(counted.get() < 2 * bytes / 4, "{}", counted.get());
}
