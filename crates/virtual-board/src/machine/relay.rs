//! The relay on the door: a charge pump that needs edges, a coil, a contact to ground.

use super::Machine;
use crate::TICK_HZ;

/// Port and pin of pump and contact (docs/wiring.md).
pub(super) const PUMP: (usize, u32) = (0, 8);
pub(super) const CONTACT: (usize, u32) = (1, 10);
/// How long the pump's charge holds the coil.
const HOLDS: u64 = 20 * TICK_HZ / 1_000;

/// How the contact behaves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Contact {
    /// It is closed while the coil is energised.
    #[default]
    Sound,
    /// It never opens.
    Welded,
    /// It never closes, or is not wired.
    Absent,
}

/// Coil and contact.
#[derive(Clone, Copy, Debug, Default)]
pub struct Relay {
    level: bool,
    edge_at: Option<u64>,
    pub contact: Contact,
}

impl Relay {
    /// Whether the coil is energised.
    pub fn is_energised(&self, now: u64) -> bool {
        self.edge_at.is_some_and(|at| now < at + HOLDS)
    }
}

impl Machine {
    /// Takes over what the program did to the pump's pin.
    pub(super) fn follow_relay(&mut self) {
        let (port, pin) = PUMP;
        let level = self.ports[port].shown(pin);
        if level != self.relay.level {
            self.relay.level = level;
            self.relay.edge_at = Some(self.now);
        }
    }

    /// Puts the contact's level on its wire.
    pub(super) fn apply_contact(&mut self) {
        let closed = match self.relay.contact {
            Contact::Sound => self.relay.is_energised(self.now),
            Contact::Welded => true,
            Contact::Absent => false,
        };
        let (port, pin) = CONTACT;
        self.ports[port].apply(pin, !closed);
    }
}
