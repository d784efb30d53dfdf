//! The lamps on the panel door.

use crate::model::residuals::RESIDUALS;

/// What one lamp shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lamp {
    /// Dark.
    #[default]
    Off,
    /// Steady light.
    On,
    /// Slow blinking, 1 Hz: waiting or not judged.
    Blink,
}

impl Lamp {
    /// On or off.
    pub const fn lit(on: bool) -> Self {
        if on { Lamp::On } else { Lamp::Off }
    }

    /// Stable name used in files: `off`, `on` or `blink`.
    pub const fn name(self) -> &'static str {
        match self {
            Lamp::Off => "off",
            Lamp::On => "on",
            Lamp::Blink => "blink",
        }
    }
}

/// All lamps at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lamps {
    /// On: the motor is being judged. Blink: powered, but not judged now.
    pub run: Lamp,
    /// On: residual r1..r4 beyond its threshold.
    pub r: [Lamp; RESIDUALS],
    /// On: a sensor is dead, contradicts the others, or is the likeliest cause. Blink: a channel clips or is invalid.
    pub sensor: Lamp,
    /// On: supply lost, out of range or unbalanced. Blink: searching for the supply's frequency.
    pub line: Lamp,
    /// On: the load differs from the one declared (load kind `free`). Blink: transient, not judged.
    pub load: Lamp,
    /// On: a fault persists.
    pub fault: Lamp,
}

impl Lamps {
    /// Nothing but RUN shows.
    pub fn is_quiet(&self) -> bool {
        self.lit_names().next().is_none()
    }

    /// Names of the lamps that are on, RUN apart.
    pub fn lit_names(&self) -> impl Iterator<Item = &'static str> + use<> {
        let [r1, r2, r3, r4] = self.r;
        let all = [
            r1,
            r2,
            r3,
            r4,
            self.sensor,
            self.line,
            self.load,
            self.fault,
        ];
        let names = ["r1", "r2", "r3", "r4", "sensor", "line", "load", "fault"];
        let lit = names
            .into_iter()
            .zip(all)
            .filter(|(_, lamp)| *lamp == Lamp::On);
        lit.map(|(name, _)| name)
    }

    /// Which of r1..r4 are on.
    pub fn pattern(&self) -> [bool; RESIDUALS] {
        self.r.map(|lamp| lamp == Lamp::On)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lit_lamps_are_named_and_blinking_ones_are_not() {
        let mut lamps = Lamps {
            run: Lamp::On,
            sensor: Lamp::Blink,
            ..Lamps::default()
        };
        assert!(lamps.is_quiet());
        lamps.r = [Lamp::On, Lamp::Off, Lamp::Blink, Lamp::On];
        lamps.line = Lamp::On;
        assert!(!lamps.is_quiet());
        let names: Vec<_> = lamps.lit_names().collect();
        assert_eq!(names, ["r1", "r4", "line"]);
        assert_eq!(lamps.pattern(), [true, false, false, true]);
    }

    #[test]
    fn lamps_have_stable_names() {
        let names = [Lamp::lit(false), Lamp::lit(true), Lamp::Blink].map(Lamp::name);
        assert_eq!(names, ["off", "on", "blink"]);
    }
}
