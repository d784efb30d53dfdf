//! From lamps to levels on wires: blinking, and the latched mode in which a lamp stays lit until acknowledged.

use monitor::{Lamp, Lamps};

/// Number of lamps on the panel.
pub const LAMPS: usize = 9;

/// Lamps in the order of the wiring table.
pub const LAMP_NAMES: [&str; LAMPS] = [
    "run", "r1", "r2", "r3", "r4", "sensor", "line", "load", "fault",
];

/// Index of RUN, which is never latched.
const RUN: usize = 0;

/// What each wire carries; `blink_phase` is the common bright half of all blinking lamps.
pub fn levels(lamps: &Lamps, blink_phase: bool) -> [bool; LAMPS] {
    in_order(lamps).map(|lamp| match lamp {
        Lamp::Off => false,
        Lamp::On => true,
        Lamp::Blink => blink_phase,
    })
}

pub(crate) fn in_order(lamps: &Lamps) -> [Lamp; LAMPS] {
    let [r1, r2, r3, r4] = lamps.r;
    [
        lamps.run,
        r1,
        r2,
        r3,
        r4,
        lamps.sensor,
        lamps.line,
        lamps.load,
        lamps.fault,
    ]
}

/// The panel's memory: live (lamps follow the monitor) or latched (a lit lamp stays until acknowledged).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Display {
    latched: bool,
    held: [bool; LAMPS],
}

impl Display {
    /// Whether lit lamps stay lit.
    pub fn is_latched(&self) -> bool {
        self.latched
    }

    /// Switches between live and latched; what was held is forgotten.
    pub fn set_latched(&mut self, latched: bool) {
        *self = Display {
            latched,
            held: [false; LAMPS],
        };
    }

    /// Forgets what was held; a lamp whose cause persists lights again at once.
    pub fn acknowledge(&mut self) {
        self.held = [false; LAMPS];
    }

    /// Takes the lamps after a report and remembers those that are on.
    pub fn observe(&mut self, lamps: &Lamps) {
        for (held, lamp) in self.held.iter_mut().zip(in_order(lamps)).skip(RUN + 1) {
            *held |= self.latched && lamp == Lamp::On;
        }
    }

    /// What each wire carries now.
    pub fn levels(&self, lamps: &Lamps, blink_phase: bool) -> [bool; LAMPS] {
        let mut levels = levels(lamps, blink_phase);
        for (level, held) in levels.iter_mut().zip(self.held) {
            *level |= held;
        }
        levels
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAULTY: Lamps = Lamps {
        run: Lamp::On,
        r: [Lamp::On, Lamp::Off, Lamp::Off, Lamp::On],
        sensor: Lamp::Blink,
        line: Lamp::Off,
        load: Lamp::Off,
        fault: Lamp::On,
    };

    fn lit(levels: [bool; LAMPS]) -> Vec<&'static str> {
        let names = LAMP_NAMES.into_iter().zip(levels);
        names.filter(|(_, on)| *on).map(|(name, _)| name).collect()
    }

    #[test]
    fn a_blinking_lamp_follows_the_phase_and_the_others_do_not() {
        assert_eq!(
            lit(levels(&FAULTY, true)),
            ["run", "r1", "r4", "sensor", "fault"]
        );
        assert_eq!(lit(levels(&FAULTY, false)), ["run", "r1", "r4", "fault"]);
    }

    #[test]
    fn latched_lamps_stay_until_acknowledged_and_run_never_latches() {
        let mut display = Display::default();
        display.set_latched(true);
        display.observe(&FAULTY);
        assert_eq!(
            lit(display.levels(&Lamps::default(), false)),
            ["r1", "r4", "fault"]
        );
        display.acknowledge();
        assert_eq!(lit(display.levels(&Lamps::default(), false)), [""; 0]);
    }

    #[test]
    fn acknowledging_does_not_hide_a_fault_that_is_still_there() {
        let mut display = Display::default();
        display.set_latched(true);
        display.observe(&FAULTY);
        display.acknowledge();
        assert_eq!(
            lit(display.levels(&FAULTY, false)),
            ["run", "r1", "r4", "fault"]
        );
    }

    #[test]
    fn live_lamps_remember_nothing() {
        let mut display = Display::default();
        display.observe(&FAULTY);
        assert_eq!(lit(display.levels(&Lamps::default(), true)), [""; 0]);
    }
}
