//! Memory protection, and how deep the stack has been.
// Addresses of the linker, and memory that is looked at while it is in use.
#![allow(unsafe_code)]

use cortex_m::peripheral::MPU;
use embassy_stm32::pac;

/// Bytes of the stack's memory.
const STACK_BYTES: u32 = 20 * 1024;
/// What cortex-m-rt paints it with.
const PAINT: u32 = 0xCCCC_CCCC;
/// Above three quarters it is nearly full.
const ALARM_BYTES: u32 = STACK_BYTES / 4 * 3;

/// Attributes of a region: size as a power of two, no execution, full access or none (ARMv7-M, B3.5).
const fn attributes(log2_bytes: u32, access: u32) -> u32 {
    let internal_ram = 1 << 18 | 1 << 17;
    1 << 28 | access << 24 | internal_ram | (log2_bytes - 1) << 1 | 1
}

const NO_ACCESS: u32 = 0;
const FULL_ACCESS: u32 = 3;

/// Base and attributes: nothing is executed from RAM; nothing is reached through a null pointer.
const REGIONS: [(u32, u32); 2] = [
    (0x2000_0000, attributes(17, FULL_ACCESS)),
    (0x0000_0000, attributes(27, NO_ACCESS)),
];

/// Lets the parity of the RAM be asked about, and switches memory protection on; whatever no region names is as without it.
pub fn start() {
    // The handler of a parity error reads its flag there.
    pac::RCC.apb2enr().modify(|w| w.set_syscfgen(true));
    // Safety: the program never executes from RAM and never reads below the flash's own address.
    unsafe {
        let mpu = &*MPU::PTR;
        for (k, (base, attributes)) in (0..).zip(REGIONS) {
            mpu.rnr.write(k);
            mpu.rbar.write(base);
            mpu.rasr.write(attributes);
        }
        // Enabled, with the default map for the privileged program.
        mpu.ctrl.write(1 | 1 << 2);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

unsafe extern "C" {
    static _stack_end: u32;
}

/// Words that one look takes: the whole stack is seen in ten.
const LOOK_WORDS: u32 = 512;

/// Looks for the deepest word of the stack that was ever written, some words at a time.
#[derive(Clone, Copy, Debug)]
pub struct StackMark {
    /// Words from the stack's end on that still hold their paint, as far as was seen.
    painted: u32,
    /// The next word to look at.
    at: u32,
}

impl StackMark {
    /// The mark at the start: everything seems free.
    pub fn new() -> Self {
        StackMark {
            painted: STACK_BYTES / 4,
            at: 0,
        }
    }

    /// Bytes that were used at most.
    pub fn deepest_bytes(&self) -> u32 {
        STACK_BYTES - 4 * self.painted
    }

    /// Whether the stack is nearly full.
    pub fn is_nearly_full(&self) -> bool {
        self.deepest_bytes() > ALARM_BYTES
    }

    /// Goes on looking, from the stack's end towards what is known to be used.
    pub fn look(&mut self) {
        let end = &raw const _stack_end;
        let to = (self.at + LOOK_WORDS).min(self.painted);
        // Safety: words of the stack's memory, below whatever is in use.
        let is_used = |k: &u32| unsafe { end.add(*k as usize).read_volatile() } != PAINT;
        self.painted = (self.at..to).find(is_used).unwrap_or(self.painted);
        self.at = if to < self.painted { to } else { 0 };
    }
}
