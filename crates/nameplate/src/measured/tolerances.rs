//! How far a single motor may be from the plate of its type.

use crate::plate::{Completed, VALUES, Value};
use crate::prior::Covariance;

/// Tolerances of a single motor against its plate (IEC 60034-1, schedule of tolerances), as limits: slip 20 % (30 % below 1 kW), losses 15 %
/// (10 % above 150 kW), power factor a sixth of 1 - cos phi within 0.02 to 0.07, breakdown torque 10 %, locked-rotor torque
/// and current 20 %.
const SLIP: [f64; 2] = [0.3, 0.2];
const LOSS: [f64; 2] = [0.15, 0.1];
const POWER_FACTOR: [f64; 2] = [0.02, 0.07];
const BREAKDOWN: f64 = 0.1;
const LOCKED_ROTOR: f64 = 0.2;
/// Least variance of a value: no plate is exact.
const LEAST: f64 = 1e-8;

/// Variances by which a single motor differs from its plate; a limit is a rectangular distribution's.
pub(super) fn tolerances(completed: &Completed) -> Covariance {
    let kilowatts = completed.power_kw;
    let cos = completed.targets.power_factor;
    let power_factor = ((1.0 - cos) / 6.0).clamp(POWER_FACTOR[0], POWER_FACTOR[1]);
    let mut limits = [0.0; VALUES];
    limits[Value::Slip as usize] = SLIP[usize::from(kilowatts >= 1.0)];
    limits[Value::Loss as usize] = LOSS[usize::from(kilowatts > 150.0)];
    limits[Value::TanPhi as usize] = power_factor / (cos * (1.0 - cos * cos));
    limits[Value::Breakdown as usize] = BREAKDOWN;
    limits[Value::LockedRotorTorque as usize] = LOCKED_ROTOR;
    limits[Value::LockedRotorCurrent as usize] = LOCKED_ROTOR;
    Covariance::from_fn(|a, b| match (a == b, completed.known[a]) {
        (true, true) => limits[a] * limits[a] / 3.0 + LEAST,
        (true, false) => LEAST,
        (false, _) => 0.0,
    })
}
