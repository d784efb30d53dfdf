//! The processor's registers: patterns in, patterns out. It finds bits that stick, not every fault of the arithmetic.
// Assembly: every register by its name.
#![allow(unsafe_code)]

use core::arch::global_asm;

global_asm!(
    ".section .text.test_registers, \"ax\"
     .global test_registers
     .type test_registers,%function
     .thumb_func
     test_registers:
     push {{r4-r11, lr}}
     // Each register gets a word of its own; r0 is the pattern. Then all are summed again.
     mvn r1, r0
     mov r2, r0
     mvn r3, r0
     mov r4, r0
     mvn r5, r0
     mov r6, r0
     mvn r7, r0
     mov r8, r0
     mvn r9, r0
     mov r10, r0
     mvn r11, r0
     mov r12, r0
     mvn lr, r0
     .global test_registers_loaded
     test_registers_loaded:
     cmp r0, r2
     bne 9f
     cmp r0, r4
     bne 9f
     cmp r0, r6
     bne 9f
     cmp r0, r8
     bne 9f
     cmp r0, r10
     bne 9f
     cmp r0, r12
     bne 9f
     cmp r1, r3
     bne 9f
     cmp r1, r5
     bne 9f
     cmp r1, r7
     bne 9f
     cmp r1, r9
     bne 9f
     cmp r1, r11
     bne 9f
     cmp r1, lr
     bne 9f
     mvn r1, r1
     cmp r0, r1
     bne 9f
     movs r0, #1
     pop {{r4-r11, pc}}
     9:
     movs r0, #0
     pop {{r4-r11, pc}}
     .size test_registers, . - test_registers"
);

global_asm!(
    ".section .text.test_floats, \"ax\"
     .global test_floats
     .type test_floats,%function
     .thumb_func
     test_floats:
     vpush {{s16-s31}}
     mvn r1, r0
     .irp n, 0,2,4,6,8,10,12,14,16,18,20,22,24,26,28,30
     vmov s\\n, r0
     .endr
     .irp n, 1,3,5,7,9,11,13,15,17,19,21,23,25,27,29,31
     vmov s\\n, r1
     .endr
     movs r3, #0
     .irp n, 0,2,4,6,8,10,12,14,16,18,20,22,24,26,28,30
     vmov r2, s\\n
     eor r2, r2, r0
     orr r3, r3, r2
     .endr
     .irp n, 1,3,5,7,9,11,13,15,17,19,21,23,25,27,29,31
     vmov r2, s\\n
     eor r2, r2, r1
     orr r3, r3, r2
     .endr
     vpop {{s16-s31}}
     mov r0, r3
     bx lr
     .size test_floats, . - test_floats"
);

unsafe extern "C" {
    /// 1 where all core registers held `pattern` or its complement.
    fn test_registers(pattern: u32) -> u32;
    /// Bits that a floating-point register did not hold.
    fn test_floats(pattern: u32) -> u32;
}

const PATTERNS: [u32; 2] = [0x5555_5555, 0x3333_3333];

/// Whether all registers hold what is put into them.
pub fn passes() -> bool {
    // Safety: both follow the calling convention, and use nothing but registers and their own stack.
    PATTERNS
        .iter()
        .all(|pattern| unsafe { test_registers(*pattern) == 1 && test_floats(*pattern) == 0 })
}
