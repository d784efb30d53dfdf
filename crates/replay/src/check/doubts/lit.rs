//! Lamps r1..r4 that light while FAULT is dark: the motor departs from its calibration by less than FAULT asks for.

use monitor::{Lamp, Report};

use super::CheckDoubt;

/// Judged windows with a lamp lit from which on it is no chance: a lamp waits for that many, too.
const LEAST: u64 = 5;
/// Share of the judged windows that they make, at least ...
const LEAST_SHARE: u64 = 20;
/// ... or windows one after the other, of a recording of any length: half a second at 50 Hz.
const LASTING: u64 = 25;

/// Judged windows, and those in which a lamp was lit.
#[derive(Clone, Debug, Default)]
pub(super) struct Lit {
    judged: u64,
    windows: u64,
    /// One after the other, up to now and at most.
    running: u64,
    longest: u64,
    /// Of each lamp.
    lamps: [u64; 4],
}

impl Lit {
    /// Adds a window.
    pub fn add(&mut self, report: &Report) {
        if report.not_judged.is_none() {
            self.judged(report.lamps.r.map(|lamp| lamp == Lamp::On));
        }
    }

    fn judged(&mut self, on: [bool; 4]) {
        self.judged += 1;
        if !on.contains(&true) {
            self.running = 0;
            return;
        }
        self.windows += 1;
        self.running += 1;
        self.longest = self.longest.max(self.running);
        for (windows, on) in self.lamps.iter_mut().zip(on) {
            *windows += u64::from(on);
        }
    }

    /// What it says of a calibrated motor whose FAULT stayed dark.
    pub fn doubt(&self) -> Option<CheckDoubt> {
        let often = self.windows >= LEAST && self.windows * LEAST_SHARE >= self.judged;
        (often || self.longest >= LASTING).then(|| CheckDoubt {
            seen: format!(
                "{} in {} of {} judged windows while FAULT was dark: the motor departs from its calibration, by less than FAULT asks for",
                self.names(),
                self.windows,
                self.judged
            ),
            remedy: "record once more at the load at which they light; if they light again, look at what else has changed since the calibration, and \
                     calibrate again on the motor in good order, with three loads at two voltages: FAULT then lights for smaller faults"
                .to_owned(),
        })
    }

    /// The lamps that were lit as often as the most frequent one, or half as often.
    fn names(&self) -> String {
        let most = self.lamps.into_iter().max().unwrap_or_default();
        let lit = (1..).zip(self.lamps).filter(|(_, n)| 2 * n >= most);
        let names: Vec<String> = lit.map(|(k, _)| format!("r{k}")).collect();
        match names.split_last() {
            Some((last, [])) => format!("{last} was lit"),
            Some((last, first)) => format!("{} and {last} were lit", first.join(", ")),
            None => String::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(windows: &[(usize, [bool; 4])]) -> Lit {
        let mut lit = Lit::default();
        for (times, on) in windows {
            (0..*times).for_each(|_| lit.judged(*on));
        }
        lit
    }

    #[test]
    fn lamps_that_light_for_long_are_a_doubt_and_a_flash_is_none() {
        let (dark, both, one) = (
            [false; 4],
            [true, false, false, true],
            [false, true, false, false],
        );
        assert_eq!(after(&[(100, dark)]).doubt(), None);
        assert_eq!(after(&[(50, dark), (4, both), (50, dark)]).doubt(), None);
        let seen = |windows: &[(usize, [bool; 4])]| after(windows).doubt().expect("a doubt").seen;
        let begins = "r1 and r4 were lit in 34 of 89 judged windows";
        assert!(seen(&[(55, dark), (34, both)]).starts_with(begins));
        assert!(seen(&[(10, one)]).starts_with("r2 was lit in 10 of 10"));
        // In an hour: flashes here and there are none, half a second without a pause is one.
        let flashes = [(3000, dark), (4, both)].repeat(50);
        assert_eq!(after(&flashes).doubt(), None);
        assert!(
            after(&[flashes, vec![(25, both)]].concat())
                .doubt()
                .is_some()
        );
    }
}
