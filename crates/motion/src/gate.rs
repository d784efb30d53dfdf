//! When a cycle cannot be judged in motion, and why.

use crate::circuit::Circuit;
use crate::rows::Sums;

/// Why a cycle is not judged in motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotInMotion {
    /// A voltage, a current or the speed is missing or no number.
    Missing,
    /// A channel touched its rail, now or so shortly ago that the flux is still wrong.
    Clipped,
    /// No supply between 5 and 100 Hz is followed.
    NoSupply,
    /// The motor draws no current.
    NoCurrent,
    /// The rotor flux is not known yet: the first cycles after switching on, or a recording that begins on a turning shaft.
    FluxUnknown,
    /// The shaft turns against the field (slip above 1), or did so shortly ago: the cage's skin effect is then not known well enough.
    AgainstField,
}

/// What the gate remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gate {
    /// Cycles that are still left out, and why.
    left: u16,
    reason: NotInMotion,
    /// Whether the flux was known at the beginning, or was set to its steady value since.
    pub is_seeded: bool,
}

impl Default for Gate {
    fn default() -> Self {
        Gate {
            left: 0,
            reason: NotInMotion::FluxUnknown,
            is_seeded: false,
        }
    }
}

/// What was seen of the instants of one cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// A rail was touched.
    pub clipped: bool,
    /// The supply was not followed.
    pub unlocked: bool,
    /// Current at the first instant, A.
    pub first_current: f32,
    /// Instants that were missing before.
    pub missing: f32,
}

/// Current below which the motor counts as switched off, share of rated.
const NO_CURRENT: f32 = 0.05;
/// Angle of a first cycle up to which a motor that drew no current began at rest, electrical rad.
const STILL: f32 = 0.6;
/// Slip from which on a motor brakes against the field.
const AGAINST: f32 = 1.1;
/// Cycles after switching on from rest: the torque's row takes three.
const FIRST_CYCLES: u16 = 1;
/// Rotor time constants after which a clip, and after which a guessed flux is forgotten.
const FORGOTTEN: [f32; 2] = [3.0, 4.0];

impl Gate {
    /// Whether the motor stood, without a current, when the first cycle began.
    pub fn began_at_rest(circuit: &Circuit, sums: &Sums, seen: &Seen) -> bool {
        let still = sums.turned(circuit.mechanics.n_p).abs() < STILL;
        still && seen.first_current < NO_CURRENT * circuit.rated.current
    }

    /// The flux was set at the end of a cycle.
    pub fn seed(&mut self, circuit: &Circuit, at_rest: bool) {
        self.is_seeded = true;
        let [_, guessed] = FORGOTTEN;
        let left = if at_rest {
            FIRST_CYCLES
        } else {
            cycles(circuit, guessed)
        };
        (self.left, self.reason) = (left.saturating_add(1), NotInMotion::FluxUnknown);
    }

    /// Why the cycle that ends now is not judged; `None` for one that is.
    pub fn close(
        &mut self,
        circuit: &Circuit,
        sums: &Sums,
        seen: &Seen,
        slip: f32,
    ) -> Option<NotInMotion> {
        let [clip, _] = FORGOTTEN;
        let hold = cycles(circuit, clip);
        if seen.clipped {
            self.hold(hold, NotInMotion::Clipped);
        }
        let none = sums.current() < NO_CURRENT * circuit.rated.current;
        if slip > AGAINST && !none && !seen.unlocked {
            self.hold(hold, NotInMotion::AgainstField);
        }
        let now = if seen.unlocked {
            Some(NotInMotion::NoSupply)
        } else {
            none.then_some(NotInMotion::NoCurrent)
        };
        if now.is_some() {
            // After switching on the rows begin anew.
            self.hold(1 + FIRST_CYCLES, NotInMotion::FluxUnknown);
        }
        let held = (self.left > 0).then_some(self.reason);
        self.left = self.left.saturating_sub(1);
        now.or(held)
    }

    fn hold(&mut self, cycles: u16, reason: NotInMotion) {
        if cycles >= self.left {
            (self.left, self.reason) = (cycles, reason);
        }
    }
}

/// Cycles in so many rotor time constants.
fn cycles(circuit: &Circuit, constants: f32) -> u16 {
    let cycle = circuit.cycle_samples() * circuit.t_sample;
    libm::ceilf(constants * circuit.rotor_time() / cycle) as u16
}
