//! What runs before anything else, on registers alone: the test of the RAM.
//!
//! March C- with 0x5555_5555 and its complement (van de Goor): finds cells that stick, addresses that share a cell, and most
//! couplings. It leaves zeros, so that every word has been written and its parity holds. 50 ms at 16 MHz.
//!
//! A defective cell: its address goes to the backup registers, SENSOR and FAULT light, and the watchdog starts the board
//! again, where its option byte is set.
// Assembly: there is no RAM yet.
#![allow(unsafe_code)]

use core::arch::global_asm;

/// In the backup registers where a defective cell was found; its address is in the next one.
pub const RAM_DEFECT: u32 = 0x444D_5241;
/// Number of that register.
pub const RAM_DEFECT_WORD: usize = 20;

global_asm!(
    ".section .text.__pre_init, \"ax\"
     .global __pre_init
     .type __pre_init,%function
     .thumb_func
     __pre_init:
     ldr r0, =0x20000000
     ldr r1, =0x20018000
     ldr r2, =0x55555555
     mvn r3, r2
     mov r4, r0
     1:
     str r2, [r4], #4
     cmp r4, r1
     bne 1b
     mov r4, r0
     2:
     ldr r5, [r4]
     cmp r5, r2
     bne 9f
     str r3, [r4], #4
     cmp r4, r1
     bne 2b
     mov r4, r0
     3:
     ldr r5, [r4]
     cmp r5, r3
     bne 9f
     str r2, [r4], #4
     cmp r4, r1
     bne 3b
     4:
     ldr r5, [r4, #-4]!
     cmp r5, r2
     bne 9f
     str r3, [r4]
     cmp r4, r0
     bne 4b
     mov r4, r1
     5:
     ldr r5, [r4, #-4]!
     cmp r5, r3
     bne 9f
     str r2, [r4]
     cmp r4, r0
     bne 5b
     movs r6, #0
     6:
     ldr r5, [r4]
     cmp r5, r2
     bne 9f
     str r6, [r4], #4
     cmp r4, r1
     bne 6b
     bx lr
     9:
     // RCC_APB1ENR1: power control; PWR_CR1: backup registers may be written; TAMP_BKP20, 21.
     ldr r0, =0x40021058
     ldr r1, [r0]
     orr r1, r1, #0x10000000
     str r1, [r0]
     ldr r1, [r0]
     ldr r0, =0x40007000
     ldr r1, [r0]
     orr r1, r1, #0x100
     str r1, [r0]
     ldr r0, =0x40002550
     ldr r1, =0x444d5241
     str r1, [r0]
     str r4, [r0, #4]
     // RCC_AHB2ENR: ports B and C; PB15 and PC5 are outputs and high.
     ldr r0, =0x4002104c
     ldr r1, [r0]
     orr r1, r1, #6
     str r1, [r0]
     ldr r1, [r0]
     ldr r0, =0x48000400
     ldr r1, =0x7fffffff
     str r1, [r0]
     mov r1, #0x8000
     str r1, [r0, #0x18]
     ldr r0, =0x48000800
     ldr r1, =0xfffff7ff
     str r1, [r0]
     mov r1, #0x20
     str r1, [r0, #0x18]
     7:
     b 7b
     .ltorg
     .size __pre_init, . - __pre_init"
);
