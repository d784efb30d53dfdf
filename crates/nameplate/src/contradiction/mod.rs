//! Which printed values cannot belong to one motor.

mod bounds;
mod release;

use std::fmt;

use crate::fit::{Fit, Misfit};
use crate::plate::Completed;

pub use bounds::Bound;

/// A worst error above is no rounding: the values contradict each other.
pub const BEYOND: f64 = 0.05;

/// Why the values of a plate do not go together.
#[derive(Clone, Debug, PartialEq)]
pub enum Contradiction {
    /// No passive circuit with two cages has these values.
    Impossible {
        /// The law that is broken.
        bound: Bound,
        /// How far beyond, relative.
        excess: f64,
    },
    /// With one value changed the circuit meets all others.
    Odd {
        /// The value that goes with no other.
        value: Misfit,
        /// As printed.
        printed: f64,
        /// The value that goes with the others.
        needed: f64,
    },
    /// No single value settles it.
    Unsettled {
        /// The value farthest from its circuit.
        value: Misfit,
        /// Its relative error.
        error: f64,
    },
    /// Power, voltage, current, efficiency and power factor do not multiply.
    Current {
        /// Printed current, A.
        printed: f64,
        /// The current of the other four, A.
        needed: f64,
    },
}

/// Share by which a printed current may miss that of power, efficiency and power factor.
const CURRENT_TOLERANCE: f64 = 0.03;

/// What contradicts what on a plate whose circuit is `fit`; empty where the circuit meets every value.
pub fn contradictions(completed: &Completed, fit: &Fit) -> Vec<Contradiction> {
    let current = odd_current(completed);
    let bounds = bounds::broken(completed);
    if fit.worst <= BEYOND && bounds.is_empty() {
        return current.into_iter().collect();
    }
    let named = (fit.worst > BEYOND).then(|| release::least_change(completed, fit));
    current.into_iter().chain(bounds).chain(named).collect()
}

fn odd_current(completed: &Completed) -> Option<Contradiction> {
    let printed = completed.plate.current_amp?;
    let needed = completed.base_current_amp();
    let allowed = CURRENT_TOLERANCE.max(2.0 * printed.relative());
    ((printed.value / needed - 1.0).abs() > allowed).then_some(Contradiction::Current {
        printed: printed.value,
        needed,
    })
}

/// Name of a value, as a plate prints it.
pub fn name(value: Misfit) -> &'static str {
    match value {
        Misfit::Power => "power",
        Misfit::ReactivePower => "power factor",
        Misfit::Breakdown => "breakdown torque",
        Misfit::LockedRotorTorque => "locked-rotor torque",
        Misfit::LockedRotorCurrent => "locked-rotor current",
        Misfit::Efficiency => "efficiency",
        Misfit::Current => "current",
    }
}

impl fmt::Display for Contradiction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Contradiction::Impossible { bound, excess } => {
                write!(f, "{bound}, by {:.1} %", 100.0 * excess)
            }
            Contradiction::Odd {
                value,
                printed,
                needed,
            } => write!(
                f,
                "{} {printed:.4} does not go with the other values; with those kept, {needed:.4} fits",
                name(*value)
            ),
            Contradiction::Unsettled { value, error } => write!(
                f,
                "no single value settles it; from the circuit that meets all of them best, {} is farthest, {:.0} %",
                name(*value),
                100.0 * error.abs()
            ),
            Contradiction::Current { printed, needed } => write!(
                f,
                "current {printed:.4} A does not go with power, voltage, efficiency and power factor, which give {needed:.4} A"
            ),
        }
    }
}
