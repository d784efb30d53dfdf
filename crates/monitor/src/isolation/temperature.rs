//! The winding's temperature from window to window: a winding cannot warm in a cycle, a fault can come in one.
//!
//! Before the first window the winding may have any temperature, and a fault that looks like heating is taken for it.
//! From then on its temperature is known as well as one window tells it, and may only move as fast as the current can
//! heat copper. So a resistance, a gain or a speed that jumps is no heating.
//!
//! Winding and cage seldom warm alike: a motor at light load has a warm winding and a cold cage. How far they are apart is followed
//! in the same way, but begins as it was in the calibration, and does not move while FAULT is lit.
//!
//! What a window leaves open is mostly what the calibration left open, and thousands of windows at the same load leave it open
//! in the same way. So they are not averaged: a window that tells less than what is known teaches nothing, and time widens what
//! was known until it tells as much. An hour at light load says little of the winding, which cools meanwhile.
//!
//! The first windows after a change count as steady while the rotor's flux still settles, and would show a temperature of their own. So
//! after a change as many judged windows teach nothing as were unsteady, at the most the cycles of one.

use super::Isolation;
use super::healthy::Healthy;

/// Relative rise of the resistances since the calibration, and how surely it is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Heating {
    /// Rise, 0.39 % per kelvin for copper.
    pub rise: f32,
    /// Standard deviation.
    pub deviation: f32,
}

impl Heating {
    /// Any temperature that the calibration foresees.
    pub fn any(healthy: &Healthy) -> Self {
        Heating {
            rise: 0.0,
            deviation: healthy.uncertainty.heating,
        }
    }
}

/// A rise that is followed from window to window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Followed {
    known: Heating,
    /// How far it may have moved since.
    slack: f32,
}

/// What is remembered of the temperature.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Temperature {
    /// Rise of both; `None` before the first window.
    both: Option<Followed>,
    /// Rise that the latest window implied.
    latest: f32,
    /// A fault that heating could be taken for is lit: time does not excuse it.
    is_frozen: bool,
    /// How much more the cage's resistance has risen than the winding's.
    apart: Followed,
    /// FAULT is lit.
    is_lit: bool,
    /// Windows that are still to be judged before one teaches.
    settling: usize,
}

/// Fastest relative rise of a winding's resistance at rated current, 1/s. Without cooling 7 A/mm2 heat copper by 0.3 K/s
/// (`J^2 rho/(density c)`), 9 A/mm2 by half a kelvin.
const RATE: f32 = 0.002;
/// Fastest relative change between the two resistances at rated current, 1/s: half of what one of them can do.
const APART_RATE: f32 = 0.001;
/// How far the resistances of winding and cage may part, a standard deviation: 25 K.
pub(super) const MOST_APART: f32 = 0.1;
/// Windows whose significance stays below this share of the lamp's are healthy enough to learn from.
const LEARNABLE: f32 = 0.5;
/// A window that tells the temperature so much better than what was known replaces it.
const BETTER: f32 = 0.67;
/// One that tells it so much worse teaches nothing: about the inverse of [`BETTER`], so that windows at one load, whose
/// deviations scatter, count as equally good.
const WORSE: f32 = 1.6;
/// Beyond so many standard deviations of its range nothing is taken for heating.
const FARTHEST: f32 = 2.0;

impl Followed {
    /// What is known by now; no more is open than `most`.
    fn expected(&self, most: f32) -> Heating {
        let Heating { rise, deviation } = self.known;
        let wider = processor::sqrtf(deviation * deviation + self.slack * self.slack);
        Heating {
            rise,
            deviation: wider.min(most),
        }
    }

    /// Takes in what a window told: at once where that is much more than what is known, else as far as it can have moved.
    fn follow(&mut self, seen: Heating, most: f32) {
        let Heating { rise, deviation } = self.known;
        let is_as_good = seen.deviation <= WORSE * deviation;
        if !is_as_good && seen.deviation > self.expected(most).deviation {
            return;
        }
        let is_better = seen.deviation <= BETTER * deviation;
        let moved = if is_better {
            seen.rise - rise
        } else {
            within(seen.rise - rise, self.slack)
        };
        self.known.rise = within(rise + moved, FARTHEST * most);
        if is_better || !is_as_good {
            self.known.deviation = seen.deviation;
        }
        self.slack = 0.0;
    }
}

impl Temperature {
    /// Lets `seconds` pass at a current that is this share of rated.
    pub fn pass(&mut self, seconds: f32, current: f32) {
        let heat = seconds * (current * current).max(1.0);
        if let Some(both) = self.both.as_mut().filter(|_| !self.is_frozen) {
            both.slack += RATE * heat;
        }
        if !self.is_lit {
            self.apart.slack += APART_RATE * heat;
        }
    }

    /// What is known before the next window.
    pub fn expected(&self, healthy: &Healthy) -> Heating {
        let any = Heating::any(healthy);
        self.both.map_or(any, |both| both.expected(any.deviation))
    }

    /// What is known before the next window of how much more the cage's resistance has risen than the winding's.
    pub fn expected_apart(&self) -> Heating {
        self.apart.expected(MOST_APART)
    }

    /// The rise near which the next window's residuals are best taken for straight lines: what the latest implied.
    pub fn latest(&self) -> f32 {
        self.latest
    }

    /// A window of so many cycles held a transient: as many that follow hold what is left of it, at the most its cycles.
    pub fn interrupt(&mut self, cycles: usize) {
        self.settling = (self.settling + 1).min(cycles);
    }

    /// Follows a window that was judged; `fault`: FAULT was lit when it came.
    pub fn follow(&mut self, isolation: &Isolation, healthy: &Healthy, fault: bool) {
        let most = healthy.uncertainty.heating;
        self.latest = within(isolation.heating.rise, FARTHEST * most);
        self.is_frozen = fault && isolation.at_any_temperature < healthy.significance;
        self.is_lit = fault;
        let settles = self.settling > 0;
        self.settling = self.settling.saturating_sub(1);
        if settles || self.is_frozen || isolation.significance > LEARNABLE * healthy.significance {
            return;
        }
        match &mut self.both {
            Some(both) => both.follow(isolation.heating, most),
            None => {
                let known = Heating {
                    rise: self.latest,
                    ..isolation.heating
                };
                self.both = Some(Followed { known, slack: 0.0 });
            }
        }
        if !fault {
            self.apart.follow(isolation.apart, MOST_APART);
        }
    }

    /// Lets `seconds` pass without a running motor: what it comes back with is anybody's guess after some minutes.
    pub fn rest(&mut self, seconds: f32) {
        self.is_frozen = false;
        self.is_lit = false;
        self.pass(seconds, 1.0);
    }
}

/// Within plus and minus `limit`; unlike `clamp` without a way to panic.
fn within(x: f32, limit: f32) -> f32 {
    x.max(-limit).min(limit)
}
