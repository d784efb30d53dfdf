//! The winding's temperature from window to window: a winding cannot warm in a cycle, a fault can come in one.
//!
//! Before the first window the winding may have any temperature, and a fault that looks like heating is taken for it.
//! From then on its temperature is known as well as one window tells it, and may only move as fast as the current can
//! heat copper. So a resistance, a gain or a speed that jumps is no heating.
//!
//! Winding and cage seldom warm alike: a motor at light load has a warm winding and a cold cage. How far they are apart is followed
//! in the same way, but begins as it was in the calibration, and does not move while FAULT is lit.

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

/// What is remembered of the temperature.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Temperature {
    known: Option<Heating>,
    /// How far the rise may have moved since.
    slack: f32,
    /// Rise that the latest window implied.
    latest: f32,
    /// A fault that heating could be taken for is lit: time does not excuse it.
    is_frozen: bool,
    /// How much more the cage's resistance has risen than the winding's.
    apart: Heating,
    /// How far that may have moved since.
    apart_slack: f32,
    /// FAULT is lit.
    is_lit: bool,
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
/// Beyond so many standard deviations of its range nothing is taken for heating.
const FARTHEST: f32 = 2.0;

impl Temperature {
    /// Lets `seconds` pass at a current that is this share of rated.
    pub fn pass(&mut self, seconds: f32, current: f32) {
        let heat = seconds * (current * current).max(1.0);
        if !self.is_frozen {
            self.slack += RATE * heat;
        }
        if !self.is_lit {
            self.apart_slack += APART_RATE * heat;
        }
    }

    /// What is known before the next window.
    pub fn expected(&self, healthy: &Healthy) -> Heating {
        let any = Heating::any(healthy);
        let Some(known) = self.known else {
            return any;
        };
        let deviation = libm::sqrtf(known.deviation * known.deviation + self.slack * self.slack);
        Heating {
            rise: known.rise,
            deviation: deviation.min(any.deviation),
        }
    }

    /// What is known before the next window of how much more the cage's resistance has risen than the winding's.
    pub fn expected_apart(&self) -> Heating {
        let Heating { rise, deviation } = self.apart;
        let wider = libm::sqrtf(deviation * deviation + self.apart_slack * self.apart_slack);
        Heating {
            rise,
            deviation: wider.min(MOST_APART),
        }
    }

    /// The rise near which the next window's residuals are best taken for straight lines: what the latest implied.
    pub fn latest(&self) -> f32 {
        self.latest
    }

    /// Follows a window that was judged; `fault`: FAULT was lit when it came.
    pub fn follow(&mut self, isolation: &Isolation, healthy: &Healthy, fault: bool) {
        let farthest = FARTHEST * healthy.uncertainty.heating;
        self.latest = within(isolation.heating.rise, farthest);
        self.is_frozen = fault && isolation.at_any_temperature < healthy.significance;
        self.is_lit = fault;
        if self.is_frozen || isolation.significance > LEARNABLE * healthy.significance {
            return;
        }
        let seen = isolation.heating;
        let old = self
            .known
            .filter(|known| seen.deviation > BETTER * known.deviation);
        let mut new = old.unwrap_or(seen);
        if old.is_some() {
            new.rise += within(seen.rise - new.rise, self.slack);
        }
        new.rise = within(new.rise, farthest);
        self.known = Some(new);
        self.slack = 0.0;
        if !fault {
            self.part(isolation.apart);
        }
    }

    fn part(&mut self, seen: Heating) {
        let moved = within(seen.rise - self.apart.rise, self.apart_slack);
        self.apart = Heating {
            rise: within(self.apart.rise + moved, FARTHEST * MOST_APART),
            deviation: self.expected_apart().deviation.min(seen.deviation),
        };
        self.apart_slack = 0.0;
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
