//! One value after the other is set free: the one that settles the rest by the least change against its tolerance is named.

use super::Contradiction;
use crate::fit::{Fit, MEETS, MISFITS, Misfit, Misfits, solve_with_starts};
use crate::plate::{Completed, Value};

/// Relative standard deviation of a value set free.
const FREE: f64 = 0.5;
/// The others must then be met within.
const SETTLED: f64 = 0.02;
const STARTS: usize = 4;

/// A value that may be set free, with its tolerance relative to it (IEC 60034-1, table of tolerances); the power factor is
/// none of them: free, it settles everything by a change that no motor has.
struct Candidate {
    value: Misfit,
    known: Value,
    tolerance: f64,
}

const CANDIDATES: [Candidate; 4] = [
    Candidate {
        value: Misfit::Breakdown,
        known: Value::Breakdown,
        tolerance: 0.10,
    },
    Candidate {
        value: Misfit::LockedRotorTorque,
        known: Value::LockedRotorTorque,
        tolerance: 0.20,
    },
    Candidate {
        value: Misfit::LockedRotorCurrent,
        known: Value::LockedRotorCurrent,
        tolerance: 0.20,
    },
    Candidate {
        value: Misfit::Efficiency,
        known: Value::Loss,
        tolerance: 0.15,
    },
];

/// The value whose change settles the others with the least of its tolerance.
pub(super) fn least_change(completed: &Completed, fit: &Fit) -> Contradiction {
    let known = |candidate: &&Candidate| completed.known[candidate.known as usize];
    CANDIDATES
        .iter()
        .filter(known)
        .filter_map(|candidate| change(completed, candidate))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or_else(|| farthest(fit), |(_, contradiction)| contradiction)
}

/// Change over tolerance, where setting this value free settles the others.
fn change(completed: &Completed, candidate: &Candidate) -> Option<(f64, Contradiction)> {
    let free = candidate.value as usize;
    let mut meets = Misfits::repeat(MEETS);
    meets[free] = FREE;
    let fit = solve_with_starts(&completed.targets, &meets, 1, STARTS);
    if fit.worst > SETTLED {
        return None;
    }
    let targets = &completed.targets;
    let printed = match candidate.value {
        Misfit::Breakdown => targets.breakdown_torque_ratio,
        Misfit::LockedRotorTorque => targets.locked_rotor_torque_ratio,
        Misfit::LockedRotorCurrent => targets.locked_rotor_current_ratio,
        _ => targets.efficiency,
    };
    let needed = printed * (1.0 + fit.misfits[free]);
    let tolerance = match candidate.value {
        Misfit::Efficiency => candidate.tolerance * (1.0 - printed),
        _ => candidate.tolerance * printed,
    };
    let contradiction = Contradiction::Odd {
        value: candidate.value,
        printed,
        needed,
    };
    Some(((needed - printed).abs() / tolerance, contradiction))
}

fn farthest(fit: &Fit) -> Contradiction {
    const ALL: [Misfit; MISFITS] = [
        Misfit::Power,
        Misfit::ReactivePower,
        Misfit::Breakdown,
        Misfit::LockedRotorTorque,
        Misfit::LockedRotorCurrent,
        Misfit::Efficiency,
        Misfit::Current,
    ];
    let error = |value: Misfit| fit.misfits[value as usize];
    let value = ALL
        .into_iter()
        .max_by(|a, b| error(*a).abs().total_cmp(&error(*b).abs()))
        .unwrap_or(Misfit::Power);
    Contradiction::Unsettled {
        value,
        error: error(value),
    }
}
