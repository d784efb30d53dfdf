//! The relay's output: energised while the board monitors and finds no fault, so that a dead board opens it too.

use monitor::Lamp;

use crate::door::display::Shown;

/// Blocks of 3.2 ms without a judgement after which a board counts as blind (60 s).
const BLIND_BLOCKS: u32 = 18_750;
/// Blocks that the contact may take to follow (0.2 s).
const SETTLING_BLOCKS: u32 = 62;

/// What opens the relay beside FAULT, a doubt about the board, and no power.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u16)]
pub enum RelayMode {
    /// Nothing else.
    #[default]
    Fault = 0,
    /// A minute without a judged window: a motor that stands, too.
    FaultOrBlind = 1,
}

impl RelayMode {
    /// By its number in the configuration.
    pub fn by_number(number: u16) -> Option<Self> {
        [RelayMode::Fault, RelayMode::FaultOrBlind]
            .into_iter()
            .find(|mode| *mode as u16 == number)
    }
}

/// The relay's memory. Its pin is toggled, not set: a charge pump energises it, so that a pin that is stuck opens it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Relay {
    /// What opens it.
    pub mode: RelayMode,
    level: bool,
    wanted: bool,
    settled: u32,
    blind: u32,
    contact_seen: bool,
}

impl Relay {
    /// Not energised yet.
    pub fn new(mode: RelayMode) -> Self {
        Relay {
            mode,
            ..Relay::default()
        }
    }

    /// Takes one block: what the door shows, whether a window was judged in it, whether the contact is closed. Says which
    /// level the pin gets, and whether the contact contradicts.
    pub fn step(&mut self, shown: &Shown, judged: bool, closed: bool) -> (bool, bool) {
        self.blind = if judged {
            0
        } else {
            self.blind.saturating_add(1)
        };
        let wanted = self.is_wanted(shown);
        self.settled = match wanted == self.wanted {
            true => self.settled.saturating_add(1),
            false => 0,
        };
        self.wanted = wanted;
        self.level = wanted && !self.level;
        (self.level, self.contradicts(closed))
    }

    /// Whether the board wants the relay energised.
    pub fn is_energised(&self) -> bool {
        self.wanted
    }

    fn is_wanted(&self, shown: &Shown) -> bool {
        let blind = self.mode == RelayMode::FaultOrBlind && self.blind > BLIND_BLOCKS;
        shown.lamps.fault != Lamp::On && !shown.instrument_faulty && !blind
    }

    /// A contact counts once it was seen closed: a board without one is sound, too.
    fn contradicts(&mut self, closed: bool) -> bool {
        if self.settled < SETTLING_BLOCKS {
            return false;
        }
        self.contact_seen |= closed && self.wanted;
        self.contact_seen && closed != self.wanted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faulty() -> Shown {
        let mut shown = Shown::default();
        shown.lamps.fault = Lamp::On;
        shown
    }

    /// Levels of so many blocks.
    fn levels(relay: &mut Relay, shown: &Shown, blocks: u32) -> Vec<bool> {
        (0..blocks)
            .map(|_| relay.step(shown, true, true).0)
            .collect()
    }

    #[test]
    fn a_healthy_board_toggles_and_a_faulty_one_stands_low() {
        let mut relay = Relay::default();
        assert_eq!(
            levels(&mut relay, &Shown::default(), 4),
            [true, false, true, false]
        );
        assert_eq!(levels(&mut relay, &faulty(), 3), [false; 3]);
        let doubted = Shown {
            instrument_faulty: true,
            ..Shown::default()
        };
        assert_eq!(levels(&mut relay, &doubted, 3), [false; 3]);
    }

    #[test]
    fn a_blind_board_opens_only_where_it_was_asked_to() {
        for mode in [RelayMode::Fault, RelayMode::FaultOrBlind] {
            let mut relay = Relay {
                mode,
                ..Relay::default()
            };
            for _ in 0..=BLIND_BLOCKS {
                relay.step(&Shown::default(), false, false);
            }
            relay.step(&Shown::default(), false, false);
            assert_eq!(relay.is_energised(), mode == RelayMode::Fault);
            relay.step(&Shown::default(), true, false);
            assert!(relay.is_energised());
        }
    }

    #[test]
    fn a_contact_that_does_not_follow_is_told_and_a_missing_one_is_not() {
        let mut relay = Relay::default();
        let mut run = |shown: &Shown, closed| {
            (0..2 * SETTLING_BLOCKS).any(|_| relay.step(shown, true, closed).1)
        };
        assert!(!run(&Shown::default(), false), "no contact is wired");
        assert!(!run(&Shown::default(), true));
        assert!(run(&Shown::default(), false), "it opened by itself");
        assert!(run(&faulty(), true), "it is welded");
        assert!(!run(&faulty(), false));
    }
}
