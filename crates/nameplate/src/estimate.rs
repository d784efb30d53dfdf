//! From a plate to a circuit with intervals, and what contradicts what.

use nalgebra::SMatrix;

use crate::circuit::{Circuit, Winding};
use crate::contradiction::{Contradiction, contradictions};
use crate::fit::{Fit, MEETS, Misfit, Misfits, Spread, solve};
use crate::interval::Interval;
use crate::physical::{PHYSICAL, RANGES, physical};
use crate::plate::{Completed, Plate, Problem, VALUES, Value};
use crate::prior::Prior;

/// How many numbers a plate may print.
pub const COLUMNS: usize = 10;

/// Keys of the numbers of a plate, in the order of [`Estimate::columns`].
pub const COLUMN_KEYS: [&str; COLUMNS] = [
    "power_kw",
    "voltage_volt",
    "frequency_hz",
    "speed_rpm",
    "efficiency_percent",
    "power_factor",
    "current_amp",
    "breakdown_torque_ratio",
    "locked_rotor_torque_ratio",
    "locked_rotor_current_ratio",
];

/// A worst error above, and values that were only expected give way to those printed.
const EXPECTED_GIVES_WAY: f64 = 0.02;
/// Seed of the further starts: the same plate gives the same circuit.
const SEED: u64 = 1;

/// The circuit of a plate.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// The plate with every value set.
    pub completed: Completed,
    /// The circuit and how well it meets the values.
    pub fit: Fit,
    /// Parameters in SI units, in the order of [`crate::physical::KEYS`].
    pub parameters: [Interval; PHYSICAL],
    /// Correlations of their logarithms.
    pub correlations: SMatrix<f64, PHYSICAL, PHYSICAL>,
    /// What the circuit gives for each number of a plate, printed or not.
    pub columns: [Interval; COLUMNS],
    /// Greatest relative error among the printed numbers.
    pub worst_error: f64,
    /// What contradicts what.
    pub contradictions: Vec<Contradiction>,
}

impl Estimate {
    /// The circuit of a plate, with what catalogues say of motors like it.
    ///
    /// # Errors
    /// Numbers missing that do not follow from the others, or that no motor has.
    pub fn of(plate: &Plate) -> Result<Estimate, Problem> {
        Estimate::with_prior(plate, &Prior::REAL_MOTORS)
    }

    /// As [`Estimate::of`], with another prior.
    ///
    /// # Errors
    /// As [`Estimate::of`].
    pub fn with_prior(plate: &Plate, prior: &Prior) -> Result<Estimate, Problem> {
        let completed = Completed::of(plate, prior)?;
        let fit = circuit_of(&completed);
        let spread = Spread::of(&completed, &fit);
        let (mut parameters, correlations) = spread.intervals(physical);
        parameters[PHYSICAL - 1] = completed.inertia;
        if completed.plate.dc_resistance.is_none() {
            parameters[0].high = parameters[0].high.max(all_in_copper_ohm(&completed));
        }
        for (interval, range) in parameters.iter_mut().zip(RANGES) {
            *interval = interval.inside(range);
        }
        let (columns, _) =
            spread.intervals(|circuit, completed| given_by(circuit, completed, fit.breakdown_slip));
        let contradictions = contradictions(&completed, &fit);
        Ok(Estimate {
            worst_error: worst_error(plate, &columns),
            parameters,
            correlations,
            columns,
            contradictions,
            fit,
            completed,
        })
    }
}

/// Stator resistance of a motor without any loss but copper's, roundings in its favour: makers do not print how the others
/// divide.
fn all_in_copper_ohm(completed: &Completed) -> f64 {
    let rating = completed.targets.rating();
    let rounding = |value: Value| completed.covariance[(value as usize, value as usize)].sqrt();
    let loss =
        (completed.targets.power_factor - rating.power) * (2.0 * rounding(Value::Loss)).exp();
    let rotor = rating.slip * rating.torque() * (-2.0 * rounding(Value::Slip)).exp();
    (loss - rotor).max(0.0) * completed.base_impedance_ohm()
}

/// Meets printed and expected values alike; where no circuit does, the expected ones give way within their spread.
fn circuit_of(completed: &Completed) -> Fit {
    let strict = Misfits::repeat(MEETS);
    let fit = solve(&completed.targets, &strict, SEED);
    if fit.worst <= EXPECTED_GIVES_WAY || completed.known == [true; VALUES] {
        return fit;
    }
    let mut meets = strict;
    let places = [
        (Value::Breakdown, Misfit::Breakdown),
        (Value::LockedRotorTorque, Misfit::LockedRotorTorque),
        (Value::LockedRotorCurrent, Misfit::LockedRotorCurrent),
        (Value::Loss, Misfit::Efficiency),
        (Value::TanPhi, Misfit::ReactivePower),
    ];
    for (value, misfit) in places {
        let k = value as usize;
        if !completed.known[k] {
            meets[misfit as usize] = completed.covariance[(k, k)].sqrt().max(MEETS);
        }
    }
    solve(&completed.targets, &meets, SEED)
}

/// The numbers of a plate as the circuit gives them.
fn given_by(circuit: &Circuit, completed: &Completed, breakdown_slip: f64) -> [f64; COLUMNS] {
    let rating = completed.targets.rating();
    let rated = circuit.at_rating(&rating);
    let slip = rating.slip * circuit.slip_ratio;
    let power = rated.torque * (1.0 - slip);
    let breakdown = circuit.at_slip(&rating, breakdown_slip, Winding::Cold);
    let locked = circuit.at_slip(&rating, 1.0, Winding::Cold);
    let synchronous_rpm = 60.0 * completed.frequency_hz / f64::from(completed.pole_pairs);
    let apparent = rated.active.hypot(rated.reactive);
    [
        completed.power_kw * power / rating.power,
        completed.voltage_volt,
        completed.frequency_hz,
        synchronous_rpm * (1.0 - slip),
        100.0 * power / rated.active,
        rated.active / apparent,
        completed.base_current_amp() * rated.current,
        breakdown.torque / rating.torque(),
        locked.torque / rating.torque(),
        locked.current / rated.current,
    ]
}

fn worst_error(plate: &Plate, columns: &[Interval; COLUMNS]) -> f64 {
    let error = |(printed, fitted): (Option<_>, &Interval)| {
        let printed: crate::plate::Printed = printed?;
        Some((fitted.value / printed.value - 1.0).abs())
    };
    plate
        .numbers()
        .into_iter()
        .zip(columns)
        .filter_map(error)
        .fold(0.0, f64::max)
}
