//! The lamps' wires.

use board::LAMPS;
use embassy_stm32::gpio::{Level, Output};

/// All lamps in the order of [`board::LAMP_NAMES`].
pub struct Lamps {
    wires: [Output<'static>; LAMPS],
}

impl Lamps {
    /// Takes the wires, in the order of [`board::LAMP_NAMES`].
    pub fn new(wires: [Output<'static>; LAMPS]) -> Self {
        Lamps { wires }
    }

    /// Puts a level on each wire.
    pub fn set(&mut self, levels: [bool; LAMPS]) {
        for (wire, level) in self.wires.iter_mut().zip(levels) {
            wire.set_level(Level::from(level));
        }
    }
}
