//! From the loader to the program.
// The processor's own registers.
#![allow(unsafe_code)]

use core::arch::asm;

use cortex_m::peripheral::SCB;
use update::layout::{FLASH_BASE, PROGRAM};

const VECTOR_TABLE: u32 = FLASH_BASE + PROGRAM;

/// Starts it as a reset starts a program: stack pointer and beginning from its vector table.
pub fn start() -> ! {
    // Safety: `update::start` has seen that the first two words are a stack in RAM and a beginning in the program. No
    // interrupt was ever enabled, and nothing of the loader is used from here on.
    unsafe {
        (*SCB::PTR).vtor.write(VECTOR_TABLE);
        cortex_m::asm::dsb();
        let table = VECTOR_TABLE as *const u32;
        let (stack, beginning) = (table.read_volatile(), table.add(1).read_volatile());
        asm!(
            "msr control, r2",
            "isb",
            "msr msp, r0",
            "mvn lr, r2",
            "bx r1",
            // Named, so that none of them is `lr`, which is written before the jump.
            in("r0") stack,
            in("r1") beginning,
            in("r2") 0,
            options(noreturn, nomem, nostack),
        )
    }
}
