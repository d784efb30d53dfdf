//! Copying and clearing whole words, eight at a time.
//!
//! The compiler calls these for every structure that it moves. Its own take five instructions for each word, which was a tenth
//! of what a calibrated motor's sample costs; they are weak, so that the linker takes these in their place.
// Assembly: names and registers that the ABI lays down (Run-time ABI for the Arm Architecture, 4.3.4).
#![allow(unsafe_code)]

use core::arch::global_asm;

// r0: to; r1: from; r2: bytes. r0 to r3 and r12 need not be kept.
global_asm!(
    ".section .text.__aeabi_memcpy4, \"ax\"
     .global __aeabi_memcpy4
     .global __aeabi_memcpy8
     .type __aeabi_memcpy4,%function
     .type __aeabi_memcpy8,%function
     .thumb_func
     __aeabi_memcpy8:
     .thumb_func
     __aeabi_memcpy4:
     subs r2, #32
     blo 2f
     push {{r4-r9}}
     1:
     ldmia r1!, {{r3-r9, r12}}
     subs r2, #32
     stmia r0!, {{r3-r9, r12}}
     bhs 1b
     pop {{r4-r9}}
     2:
     adds r2, #28
     bmi 4f
     3:
     ldr r3, [r1], #4
     subs r2, #4
     str r3, [r0], #4
     bpl 3b
     4:
     adds r2, #4
     beq 6f
     5:
     ldrb r3, [r1], #1
     subs r2, #1
     strb r3, [r0], #1
     bne 5b
     6:
     bx lr
     .size __aeabi_memcpy4, . - __aeabi_memcpy4"
);

// r0: to; r1: bytes.
global_asm!(
    ".section .text.__aeabi_memclr4, \"ax\"
     .global __aeabi_memclr4
     .global __aeabi_memclr8
     .type __aeabi_memclr4,%function
     .type __aeabi_memclr8,%function
     .thumb_func
     __aeabi_memclr8:
     .thumb_func
     __aeabi_memclr4:
     movs r2, #0
     subs r1, #32
     blo 2f
     push {{r4-r8}}
     movs r3, #0
     movs r4, #0
     movs r5, #0
     movs r6, #0
     movs r7, #0
     mov r8, r2
     mov r12, r2
     1:
     stmia r0!, {{r2-r8, r12}}
     subs r1, #32
     bhs 1b
     pop {{r4-r8}}
     2:
     adds r1, #28
     bmi 4f
     3:
     str r2, [r0], #4
     subs r1, #4
     bpl 3b
     4:
     adds r1, #4
     beq 6f
     5:
     strb r2, [r0], #1
     subs r1, #1
     bne 5b
     6:
     bx lr
     .size __aeabi_memclr4, . - __aeabi_memclr4"
);
