//! What is believed before the tests of values, saturation, friction, inertia, temperature and instruments.

use crate::measured::begin::Begin;
use crate::measured::instruments::{Instruments, share};
use crate::measured::unknowns::{
    BEARINGS, SATURATION, SATURATION_EXPONENT, Square, Unknown, Unknowns, WARMTH,
};
use crate::plate::{Completed, VALUES, Value};
use crate::prior::Covariance;

/// Tolerances of a single motor against its plate (IEC 60034-1, table 20), as limits: slip 20 % (30 % below 1 kW), losses 15 %
/// (10 % above 150 kW), power factor a sixth of 1 - cos phi within 0.02 to 0.07, breakdown torque 10 %, locked-rotor torque
/// and current 20 %.
const SLIP: [f64; 2] = [0.3, 0.2];
const LOSS: [f64; 2] = [0.15, 0.1];
const POWER_FACTOR: [f64; 2] = [0.02, 0.07];
const BREAKDOWN: f64 = 0.1;
const LOCKED_ROTOR: f64 = 0.2;
/// Least variance of a value: no plate is exact.
const LEAST: f64 = 1e-8;
/// Standard deviation of the logarithm of an inertia that was told.
const TOLD: f64 = 0.02;

/// A normal distribution.
pub(in crate::measured) struct Prior {
    pub centre: Unknowns,
    /// Covariance of the values.
    pub values: Covariance,
    /// Standard deviations of what stands behind the plate's unknowns.
    pub spread: Unknowns,
}

impl Prior {
    pub fn of(begin: &Begin, instruments: &Instruments, inertia: Option<f64>) -> Prior {
        let completed = &begin.completed;
        let mut centre = Unknowns::zeros();
        centre
            .fixed_rows_mut::<VALUES>(0)
            .copy_from(&completed.targets.values());
        centre
            .fixed_rows_mut::<{ crate::circuit::PARAMETERS }>(VALUES)
            .copy_from(&begin.fit.circuit.logs());
        let mut spread = Unknowns::repeat(1.0);
        let mut set = |unknown: Unknown, [mean, deviation]: [f64; 2]| {
            centre[unknown as usize] = mean;
            spread[unknown as usize] = deviation;
        };
        let expected = completed.inertia;
        set(Unknown::Saturation, SATURATION);
        set(Unknown::SaturationExponent, SATURATION_EXPONENT);
        set(Unknown::Bearings, BEARINGS);
        set(Unknown::Warmth, WARMTH);
        set(
            Unknown::Inertia,
            inertia.map_or([expected.value.ln(), expected.log_spread()], |told| {
                [told.ln(), TOLD]
            }),
        );
        let i = instruments;
        set(Unknown::VoltageGain, [0.0, share(i.voltage_percent)]);
        set(Unknown::CurrentGain, [0.0, share(i.current_percent)]);
        set(Unknown::PowerGain, [0.0, share(i.power_percent)]);
        set(Unknown::PowerAngle, [0.0, share(i.power_percent)]);
        set(Unknown::TorqueGain, [0.0, share(i.torque_percent)]);
        set(Unknown::ResistanceGain, [0.0, share(i.resistance_percent)]);
        Prior {
            centre,
            values: completed.covariance + tolerances(completed),
            spread,
        }
    }

    /// Inverse of the covariance; the circuit's part is empty.
    pub fn precision(&self, doubts: &[f64; VALUES]) -> Square {
        let doubted =
            Covariance::from_fn(|a, b| self.values[(a, b)] * (doubts[a] * doubts[b]).sqrt());
        let inverse = doubted
            .cholesky()
            .map_or_else(Covariance::zeros, |factor| factor.inverse());
        let mut precision = Square::zeros();
        precision
            .fixed_view_mut::<VALUES, VALUES>(0, 0)
            .copy_from(&inverse);
        for k in crate::measured::unknowns::OF_PLATE..crate::measured::unknowns::UNKNOWNS {
            precision[(k, k)] = self.spread[k].powi(-2);
        }
        precision
    }
}

/// Variances by which a single motor differs from its plate; a limit is a rectangular distribution's.
pub(in crate::measured) fn tolerances(completed: &Completed) -> Covariance {
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
