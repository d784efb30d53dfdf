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

fn of_order([run, r1, r2, r3, r4, sensor, line, load, fault]: [Lamp; LAMPS]) -> Lamps {
    Lamps {
        run,
        r: [r1, r2, r3, r4],
        sensor,
        line,
        load,
        fault,
    }
}

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

/// What the board knows beside the reports of the monitor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overrides {
    /// The board doubts its own converters or their supply: SENSOR and FAULT light.
    pub instrument_faulty: bool,
    /// Learning: r1..r4 blink.
    pub learning: bool,
    /// Learning was refused, and nobody has acknowledged it: FAULT blinks.
    pub refused: bool,
    /// The calibration in flash is ignored, and nobody has acknowledged it: SENSOR blinks.
    pub calibration_ignored: bool,
    /// There is a doubt about the board that stops nothing, and nobody has acknowledged it: SENSOR blinks.
    pub noticed: bool,
}

impl Overrides {
    fn over(&self, lamps: &Lamps) -> Lamps {
        let mut shown = *lamps;
        if self.learning {
            shown.r = [Lamp::Blink; 4];
        }
        if self.refused && shown.fault == Lamp::Off {
            shown.fault = Lamp::Blink;
        }
        if (self.calibration_ignored || self.noticed) && shown.sensor == Lamp::Off {
            shown.sensor = Lamp::Blink;
        }
        if self.instrument_faulty {
            (shown.sensor, shown.fault) = (Lamp::On, Lamp::On);
        }
        shown
    }
}

/// What the board says at one moment: the same on the wires, in frames, in registers and on the page.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shown {
    /// The lamps, with everything that lies over the monitor's.
    pub lamps: Lamps,
    /// The board doubts its own converters or their supply.
    pub instrument_faulty: bool,
}

impl Shown {
    /// The monitor's lamps with nothing over them.
    pub fn only(lamps: Lamps) -> Shown {
        Shown {
            lamps,
            instrument_faulty: false,
        }
    }
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

    /// What is shown now: the monitor's lamps, what lies over them, and what was lit before where lit lamps stay.
    pub fn show(&mut self, lamps: &Lamps, overrides: &Overrides) -> Shown {
        let mut now = in_order(&overrides.over(lamps));
        for (held, lamp) in self.held.iter_mut().zip(&mut now).skip(RUN + 1) {
            *held |= self.latched && *lamp == Lamp::On;
            if *held {
                *lamp = Lamp::On;
            }
        }
        Shown {
            lamps: of_order(now),
            instrument_faulty: overrides.instrument_faulty,
        }
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

    const NOTHING: Overrides = Overrides {
        instrument_faulty: false,
        learning: false,
        refused: false,
        calibration_ignored: false,
        noticed: false,
    };

    fn shown(display: &mut Display, lamps: &Lamps) -> Vec<&'static str> {
        lit(levels(&display.show(lamps, &NOTHING).lamps, false))
    }

    #[test]
    fn latched_lamps_stay_until_acknowledged_and_run_never_latches() {
        let mut display = Display::default();
        display.set_latched(true);
        shown(&mut display, &FAULTY);
        assert_eq!(
            shown(&mut display, &Lamps::default()),
            ["r1", "r4", "fault"]
        );
        display.acknowledge();
        assert_eq!(shown(&mut display, &Lamps::default()), [""; 0]);
    }

    #[test]
    fn acknowledging_does_not_hide_a_fault_that_is_still_there() {
        let mut display = Display::default();
        display.set_latched(true);
        shown(&mut display, &FAULTY);
        display.acknowledge();
        assert_eq!(shown(&mut display, &FAULTY), ["run", "r1", "r4", "fault"]);
    }

    #[test]
    fn live_lamps_remember_nothing() {
        let mut display = Display::default();
        shown(&mut display, &FAULTY);
        assert_eq!(shown(&mut display, &Lamps::default()), [""; 0]);
    }

    #[test]
    fn a_doubt_about_the_instrument_stays_too_where_lamps_stay() {
        let mut display = Display::default();
        display.set_latched(true);
        let doubt = Overrides {
            instrument_faulty: true,
            ..NOTHING
        };
        let shown = display.show(&Lamps::default(), &doubt);
        assert_eq!(lit(levels(&shown.lamps, false)), ["sensor", "fault"]);
        let later = display.show(&Lamps::default(), &NOTHING);
        assert_eq!((later.lamps, later.instrument_faulty), (shown.lamps, false));
    }

    #[test]
    fn learning_and_its_refusal_blink_where_nothing_burns() {
        let over = Overrides {
            learning: true,
            refused: true,
            calibration_ignored: true,
            ..NOTHING
        };
        let lamps = over.over(&Lamps::default());
        assert_eq!(
            (lamps.r, lamps.fault, lamps.sensor),
            ([Lamp::Blink; 4], Lamp::Blink, Lamp::Blink)
        );
        assert_eq!(over.over(&FAULTY).fault, Lamp::On);
        let noticed = Overrides {
            noticed: true,
            ..NOTHING
        };
        assert_eq!(noticed.over(&Lamps::default()).sensor, Lamp::Blink);
    }
}
