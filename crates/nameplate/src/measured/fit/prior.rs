//! What is believed before the tests of values, saturation, friction, inertia, temperature and instruments.

use crate::measured::begin::Begin;
use crate::measured::instruments::{Instruments, share};
use crate::measured::tolerances::tolerances;
use crate::measured::unknowns::{
    BEARINGS, SATURATION, SATURATION_EXPONENT, Square, Unknown, Unknowns, WARMTH,
};
use crate::plate::VALUES;
use crate::prior::Covariance;

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
