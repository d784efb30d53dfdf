//! The wires to the door: lamps and relay.

use board::LAMPS;
use embassy_stm32::gpio::{Input, Level, Output};
use embassy_stm32::pac;

/// The lamps' pins of ports B and C (src/hardware/board.rs).
const ON_PORT_B: u16 = 0xF800;
const ON_PORT_C: u16 = 1 << 4 | 1 << 5 | 1 << 8 | 1 << 9;
/// Looks in a row, a block apart, after which a wire does not follow.
const LOOKS: u32 = 10;

/// All lamps in the order of [`board::LAMP_NAMES`].
pub struct Lamps {
    wires: [Output<'static>; LAMPS],
    against: u32,
}

impl Lamps {
    /// Takes the wires, in the order of [`board::LAMP_NAMES`].
    pub fn new(wires: [Output<'static>; LAMPS]) -> Self {
        Lamps { wires, against: 0 }
    }

    /// Puts a level on each wire.
    pub fn set(&mut self, levels: [bool; LAMPS]) {
        for (wire, level) in self.wires.iter_mut().zip(levels) {
            wire.set_level(Level::from(level));
        }
    }

    /// Reads the wires back, before new levels come: whether one does not follow.
    pub fn contradict(&mut self) -> bool {
        let differs = |port: pac::gpio::Gpio| (port.idr().read().0 ^ port.odr().read().0) as u16;
        let wrong = differs(pac::GPIOB) & ON_PORT_B | differs(pac::GPIOC) & ON_PORT_C;
        self.against = match wrong {
            0 => 0,
            _ => self.against.saturating_add(1),
        };
        self.against >= LOOKS
    }
}

/// The relay: a pin for its charge pump, and its contact, which closes to ground.
pub struct RelayWires {
    pump: Output<'static>,
    contact: Input<'static>,
}

impl RelayWires {
    /// Takes both.
    pub fn new(pump: Output<'static>, contact: Input<'static>) -> Self {
        RelayWires { pump, contact }
    }

    /// Whether the contact is closed.
    pub fn is_closed(&self) -> bool {
        self.contact.is_low()
    }

    /// Puts a level on the pump's pin.
    pub fn set(&mut self, level: bool) {
        self.pump.set_level(Level::from(level));
    }
}
