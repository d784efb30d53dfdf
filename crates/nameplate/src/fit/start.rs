//! The circuit that the values suggest in closed form: start of the fit and centre of the prior.

use super::Targets;
use crate::circuit::{Circuit, Logs, PARAMETERS, Place, Rating};

/// Standard deviation of the logarithm of each unknown around [`start`], in the order of the circuit.
///
/// With it the intervals of a plate hold for makers left out of the prior (`tests/catalogue_motors.rs`).
pub const PRIOR_SPREAD: [f64; PARAMETERS] =
    [0.5, 0.5, 0.5, 0.4, 1.0, 1.0, 0.6, 0.6, 0.4, 0.2, 0.08, 0.1];
/// Standard deviation of the logarithm of a measured stator resistance: the winding's temperature at rated load is not measured.
const MEASURED_RESISTANCE: f64 = 0.04;
/// Lowest and highest value of each unknown that a motor has, in the order of the circuit.
pub const BOUNDS: [[f64; 2]; PARAMETERS] = [
    [2e-4, 0.4],
    [5e-3, 0.5],
    [0.3, 20.0],
    [5e-4, 0.5],
    [1e-4, 5.0],
    [1e-4, 3.0],
    [1e-5, 0.3],
    [1e-4, 0.08],
    [1e-3, 0.035],
    [0.5, 1.0],
    [0.76, 1.0],
    [0.8, 1.2],
];
/// A printed speed leaves at most this share of the slip open.
const WIDEST_SLIP: f64 = 0.2;

/// [`PRIOR_SPREAD`], narrower where an unknown was measured.
pub(crate) fn prior_spread(targets: &Targets) -> Logs {
    let mut spread = Logs::from(PRIOR_SPREAD);
    if targets.stator_resistance.is_some() {
        spread[Place::StatorResistance as usize] = MEASURED_RESISTANCE;
    }
    spread
}

/// Bounds of the logarithms; the slip's are those of the printed speed.
pub(crate) fn bounds(targets: &Targets) -> [Logs; 2] {
    let half = targets.slip_half_step.min(WIDEST_SLIP);
    [0, 1].map(|side| {
        let mut logs = Logs::from_fn(|k, _| BOUNDS[k][side].ln());
        logs[PARAMETERS - 1] = if side == 0 { -half } else { half };
        logs
    })
}

/// The circuit that the values suggest.
///
/// Half of the loss that slip leaves is stator copper, a fifth core, a tenth windage; stray-load loss falls with size (IEC
/// 60034-2-1, assigned allowance: 2.5 % of input power at 1 kW, 0.5 % less per decade).
pub fn start(targets: &Targets) -> Circuit {
    let Rating { power, slip } = targets.rating();
    let (torque, reactive, active) = (
        targets.rating().torque(),
        targets.reactive(),
        targets.power_factor,
    );
    let loss = active - power;
    let rest = (loss - slip * torque).max(0.25 * loss);
    let stator_resistance = targets.stator_resistance.unwrap_or(0.5 * rest);
    let locked = Locked::of(targets, stator_resistance);
    let at_breakdown = 1.0 / (2.1 * targets.breakdown_torque_ratio * torque);
    let total_leakage = at_breakdown
        .min(0.6 * reactive / (active * active))
        .max(locked.reactance);
    let leakage = 0.53 * locked.reactance.max(0.6 * total_leakage);
    let magnetizing_susceptance = (reactive - total_leakage * active * active).max(0.15 * reactive);
    let rotor_resistance =
        slip * torque / (torque * torque + (reactive - magnetizing_susceptance).powi(2));
    let decades = targets.power_kw.clamp(1.0, 1e4).log10();
    Circuit {
        stator_resistance,
        leakage,
        magnetizing: 1.0 / magnetizing_susceptance,
        inner_resistance: 1.1 * rotor_resistance,
        outer_excess: (3.0 * locked.resistance - rotor_resistance).max(rotor_resistance),
        inner_leakage: (total_leakage - 2.0 * leakage).max(0.15 * total_leakage),
        core_conductance: 0.22 * rest,
        windage: 0.12 * rest / power,
        stray: (0.6 * (0.025 - 0.005 * decades)).min(0.3 * rest / power),
        saturated_leakage: 0.75,
        cold_resistance: 0.95,
        slip_ratio: 1.0,
    }
}

/// Rotor resistance and leakage reactance at standstill.
struct Locked {
    resistance: f64,
    reactance: f64,
}

impl Locked {
    fn of(targets: &Targets, stator_resistance: f64) -> Locked {
        let current = targets.locked_rotor_current_ratio;
        let torque = targets.locked_rotor_torque_ratio * targets.rating().torque();
        let resistance = torque / (current * current);
        let impedance = 1.0 / (current * current);
        let squared = impedance - (stator_resistance + resistance).powi(2);
        Locked {
            resistance,
            reactance: squared.max(0.04 * impedance).sqrt(),
        }
    }
}
