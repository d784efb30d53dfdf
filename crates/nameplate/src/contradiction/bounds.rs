//! What no passive circuit does: leakage does not grow and rotor resistance does not fall from running to standstill.

use std::fmt;

use super::Contradiction;
use crate::circuit::Rating;
use crate::fit::Targets;
use crate::plate::{Completed, Value};

/// A law that holds for every squirrel-cage motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// The rotor's copper loss alone exceeds the total loss.
    SlipAndEfficiency,
    /// Air-gap power at standstill exceeds voltage times current.
    LockedRotorTorqueAndCurrent,
    /// The locked-rotor current's reactance does not let that much torque through.
    BreakdownTorqueAndLockedRotorCurrent,
    /// The running rotor resistance gives more torque at standstill.
    SlipAndLockedRotor,
}

/// Lowest ratio of cold to warm resistance that a motor has.
const COLDEST: f64 = 0.76;
/// Excess below which rounding of the computation may be meant.
const ROUNDING: f64 = 1e-9;
/// Points over the unknown stator resistance, and over the unknown share of the magnetizing current.
const RESISTANCES: usize = 21;
const SHARES: usize = 41;

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Bound::SlipAndEfficiency => {
                "slip and efficiency contradict each other: the rotor's copper loss at this slip exceeds the total loss"
            }
            Bound::LockedRotorTorqueAndCurrent => {
                "locked-rotor torque and locked-rotor current contradict each other: the torque needs more than voltage times current"
            }
            Bound::BreakdownTorqueAndLockedRotorCurrent => {
                "breakdown torque and locked-rotor current contradict each other: the breakdown torque is too high for the current"
            }
            Bound::SlipAndLockedRotor => {
                "slip, locked-rotor torque and locked-rotor current contradict each other: the torque is too low for this slip"
            }
        })
    }
}

/// The bounds that printed values break, every rounding taken in their favour.
pub(super) fn broken(completed: &Completed) -> Vec<Contradiction> {
    let known = |values: &[Value]| values.iter().all(|&value| completed.known[value as usize]);
    let targets = favourable(completed);
    let tests: [(Bound, &[Value], f64); 4] = [
        (
            Bound::SlipAndEfficiency,
            &[Value::Slip, Value::Loss],
            slip_and_efficiency(&targets),
        ),
        (
            Bound::LockedRotorTorqueAndCurrent,
            &[
                Value::LockedRotorTorque,
                Value::LockedRotorCurrent,
                Value::Loss,
                Value::TanPhi,
            ],
            locked_torque(&targets) / targets.locked_rotor_current_ratio - 1.0,
        ),
        (
            Bound::BreakdownTorqueAndLockedRotorCurrent,
            &[
                Value::Breakdown,
                Value::LockedRotorTorque,
                Value::LockedRotorCurrent,
                Value::Loss,
                Value::TanPhi,
                Value::Slip,
            ],
            breakdown(&targets),
        ),
        (
            Bound::SlipAndLockedRotor,
            &[
                Value::Slip,
                Value::LockedRotorTorque,
                Value::LockedRotorCurrent,
                Value::Loss,
                Value::TanPhi,
            ],
            slip_and_locked_rotor(&targets),
        ),
    ];
    tests
        .into_iter()
        .filter(|(_, values, excess)| known(values) && *excess > ROUNDING)
        .map(|(bound, _, excess)| Contradiction::Impossible { bound, excess })
        .collect()
}

/// The least slip that the printed speed allows: every bound is hardest to break there.
fn favourable(completed: &Completed) -> Targets {
    let targets = completed.targets;
    Targets {
        slip: targets.slip * (1.0 - targets.slip_half_step.min(0.5)),
        ..targets
    }
}

fn locked_torque(targets: &Targets) -> f64 {
    targets.locked_rotor_torque_ratio * targets.rating().torque()
}

/// Rotor copper loss `s/(1-s) P` over the total loss, less one.
fn slip_and_efficiency(targets: &Targets) -> f64 {
    let Rating { power, slip } = targets.rating();
    slip / (1.0 - slip) * power / (targets.power_factor - power) - 1.0
}

/// Stator resistances from none to all of the loss that slip leaves.
fn stator_resistances(targets: &Targets) -> impl Iterator<Item = f64> {
    let Rating { power, slip } = targets.rating();
    let most = (targets.power_factor - power - slip / (1.0 - slip) * power).max(0.0);
    (0..RESISTANCES).map(move |k| most * k as f64 / (RESISTANCES - 1) as f64)
}

/// `T_b <= 1/(2 (R_s + sqrt(R_s^2 + X^2)))` with the reactance at standstill, at the most favourable stator resistance.
fn breakdown(targets: &Targets) -> f64 {
    let current = targets.locked_rotor_current_ratio;
    let rotor = locked_torque(targets) / (current * current);
    let highest = stator_resistances(targets)
        .map(|warm| {
            let reactance = (1.0 / (current * current) - (warm + rotor).powi(2)).max(1e-9);
            let cold = warm * COLDEST;
            0.5 / (cold + (cold * cold + reactance).sqrt())
        })
        .fold(0.0, f64::max);
    targets.breakdown_torque_ratio * targets.rating().torque() / highest - 1.0
}

/// The least locked-rotor torque of the running rotor resistance over the printed one, less one (Gamma form).
fn slip_and_locked_rotor(targets: &Targets) -> f64 {
    let least = stator_resistances(targets)
        .flat_map(|resistance| {
            (0..SHARES).map(move |k| {
                let magnetizing = targets.reactive() * k as f64 / (SHARES - 1) as f64;
                least_locked_torque(targets, resistance, magnetizing)
            })
        })
        .fold(f64::INFINITY, f64::min);
    least / locked_torque(targets) - 1.0
}

fn least_locked_torque(targets: &Targets, resistance: f64, magnetizing: f64) -> f64 {
    let current = targets.locked_rotor_current_ratio;
    let torque = locked_torque(targets);
    let active = torque + resistance * current * current;
    let reactive = (current * current - active * active).max(0.0).sqrt();
    let rotor_squared = torque * torque + (reactive - magnetizing).max(0.0).powi(2);
    let voltage = (1.0 - resistance).max(0.3);
    let rated = targets.rating().torque();
    let running = [rated, (targets.power_factor - resistance).max(rated)].map(|air_gap| {
        let squared =
            (air_gap / voltage).powi(2) + (targets.reactive() - magnetizing).max(0.0).powi(2);
        targets.slip * air_gap / squared
    });
    running[0].min(running[1]) * COLDEST * rotor_squared
}
