//! Clocks, power and reset flags: oscillators are ready at once, and enables are enforced elsewhere.

use crate::peripherals::registers::{Registers, Unmodelled};

const CR: u32 = 0x00;
const CFGR: u32 = 0x08;
const BDCR: u32 = 0x90;
const CSR: u32 = 0x94;
const CRRCR: u32 = 0x98;
/// Why the chip was reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Power came: the supply was absent or too low.
    Power,
    /// The watchdog.
    Watchdog,
    /// The program.
    Software,
}

impl Cause {
    /// Flags in RCC_CSR; the pin is pulled by every internal reset.
    pub(crate) fn flags(self) -> u32 {
        1 << 26
            | match self {
                Cause::Power => 1 << 27,
                Cause::Watchdog => 1 << 29,
                Cause::Software => 1 << 28,
            }
    }
}

/// Peripheral clock enables.
pub const AHB1ENR: u32 = 0x48;
/// See [`AHB1ENR`].
pub const AHB2ENR: u32 = 0x4C;
/// See [`AHB1ENR`].
pub const APB1ENR1: u32 = 0x58;
/// See [`AHB1ENR`].
pub const APB1ENR2: u32 = 0x5C;
/// See [`AHB1ENR`].
pub const APB2ENR: u32 = 0x60;
const RESET: &[(u32, u32)] = &[
    (CR, 0x0000_0500),
    (0x04, 0x4000_0000), // ICSCR
    (CFGR, 0x5),
    (0x0C, 0x0000_1000), // PLLCFGR
    (0x18, 0),           // CIER
    (0x20, 0),           // CICR
    (0x28, 0),           // AHB1RSTR
    (0x2C, 0),
    (0x30, 0),
    (0x38, 0),
    (0x3C, 0),
    (0x40, 0),
    (AHB1ENR, 0x100),
    (AHB2ENR, 0),
    (0x50, 0),
    (APB1ENR1, 0x400),
    (APB1ENR2, 0),
    (APB2ENR, 0),
    (0x88, 0), // CCIPR
    (BDCR, 0),
    (CSR, 0),
    (CRRCR, 0),
    (0x9C, 0), // CCIPR2
];

/// Reset and clock control.
#[derive(Clone, Debug)]
pub struct Rcc {
    registers: Registers,
}

impl Rcc {
    /// After a reset for `cause`; flags of earlier resets in `flags` stay until they are cleared.
    pub fn new(cause: Cause, flags: u32) -> Self {
        let mut registers = Registers::new("RCC", RESET);
        registers.set(CSR, flags | cause.flags());
        Rcc { registers }
    }

    /// Reset flags, to be carried over the next reset.
    pub fn flags(&self) -> u32 {
        self.registers.get(CSR) & 0xFE00_0000
    }

    /// Whether the enable bit of a peripheral is set.
    pub fn is_enabled(&self, (register, bit): (u32, u32)) -> bool {
        self.registers.get(register) >> bit & 1 == 1
    }

    /// Which reset lines of a register are held.
    pub fn held_in_reset(&self, register: u32) -> u32 {
        self.registers.get(register)
    }

    /// A bus read.
    pub fn read(&self, offset: u32) -> Result<u32, Unmodelled> {
        self.registers.read(offset)
    }

    /// A bus write; ready flags follow the switches.
    pub fn write(&mut self, offset: u32, value: u32) -> Result<(), Unmodelled> {
        let follow =
            |value: u32, on: u32, ready: u32| value & !(1 << ready) | (value >> on & 1) << ready;
        let value = match offset {
            // HSI, HSE, PLL.
            CR => follow(follow(follow(value, 8, 10), 16, 17), 24, 25),
            // The switch takes at once.
            CFGR => value & !0xC | (value & 3) << 2,
            BDCR => follow(value, 0, 1),
            CRRCR => follow(value, 0, 1),
            CSR => {
                let kept = if value >> 23 & 1 == 1 {
                    0
                } else {
                    self.flags()
                };
                follow(value, 0, 1) & 0x3 | kept
            }
            _ => value,
        };
        self.registers.write(offset, value)
    }
}
