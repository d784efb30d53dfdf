//! GPIO ports A..G: plain registers, set/reset, and levels that a person or a wire applies.

use crate::peripherals::registers::{Registers, Unmodelled};

/// A pin: port letter index (0 is A) and number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pin(pub usize, pub u32);

const MODER: u32 = 0x00;
const PUPDR: u32 = 0x0C;
const IDR: u32 = 0x10;
const ODR: u32 = 0x14;
const BSRR: u32 = 0x18;
const BRR: u32 = 0x28;
/// MODER resets to analogue; ports A and B differ for the debug pins.
const RESET: &[(u32, u32)] = &[
    (MODER, 0xFFFF_FFFF),
    (0x04, 0),
    (0x08, 0),
    (0x0C, 0),
    (ODR, 0),
    (0x1C, 0),
    (0x20, 0),
    (0x24, 0),
];

/// One port.
#[derive(Clone, Debug)]
pub struct Port {
    registers: Registers,
    outside: u32,
    /// Pins to which something outside gives a level.
    applied: u32,
    /// Pins whose wire is shorted to a level, whatever drives them.
    shorted: u32,
    shorts: u32,
}

impl Port {
    /// A port after reset.
    pub fn new() -> Self {
        Port {
            registers: Registers::new("GPIO", RESET),
            outside: 0,
            applied: 0,
            shorted: 0,
            shorts: 0,
        }
    }

    /// A reset of the chip; what is applied from outside stays.
    pub fn reset(&mut self) {
        self.registers.reset();
    }

    /// Applies a level from outside.
    pub fn apply(&mut self, pin: u32, high: bool) {
        self.outside = self.outside & !(1 << pin) | u32::from(high) << pin;
        self.applied |= 1 << pin;
    }

    /// Level that an output pin drives; `None` while it is not an output.
    pub fn driven(&self, pin: u32) -> Option<bool> {
        let is_output = self.registers.get(MODER) >> (2 * pin) & 3 == 1;
        is_output.then(|| self.registers.get(ODR) >> pin & 1 == 1)
    }

    /// The level of a pin's wire: shorted, driven, applied from outside, pulled, in this order.
    fn level(&self, pin: u32) -> bool {
        let bit = |word: u32| word >> pin & 1 == 1;
        match self.driven(pin) {
            _ if bit(self.shorted) => bit(self.shorts),
            Some(level) => level,
            None if bit(self.applied) => bit(self.outside),
            None => self.registers.get(PUPDR) >> (2 * pin) & 3 == 1,
        }
    }

    /// Shorts a pin's wire to a level, or takes the short away.
    pub fn short(&mut self, pin: u32, to: Option<bool>) {
        self.shorted = self.shorted & !(1 << pin) | u32::from(to.is_some()) << pin;
        self.shorts = self.shorts & !(1 << pin) | u32::from(to == Some(true)) << pin;
    }

    /// What a wire shows: its short, or what drives it.
    pub fn shown(&self, pin: u32) -> bool {
        match self.shorted >> pin & 1 {
            1 => self.shorts >> pin & 1 == 1,
            _ => self.driven(pin) == Some(true),
        }
    }

    /// A bus read.
    pub fn read(&self, offset: u32) -> Result<u32, Unmodelled> {
        match offset {
            IDR => Ok((0..16).fold(0, |bits, pin| bits | u32::from(self.level(pin)) << pin)),
            _ => self.registers.read(offset),
        }
    }

    /// A bus write.
    pub fn write(&mut self, offset: u32, value: u32) -> Result<(), Unmodelled> {
        let odr = self.registers.get(ODR);
        match offset {
            // A bit in both halves sets.
            BSRR => self
                .registers
                .set(ODR, odr & !(value >> 16) | value & 0xFFFF),
            BRR => self.registers.set(ODR, odr & !value),
            _ => return self.registers.write(offset, value),
        }
        Ok(())
    }
}
