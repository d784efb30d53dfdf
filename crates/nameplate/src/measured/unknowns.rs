//! Everything that tests on one motor may change: values of the plate, circuit, what a plate does not know, instruments.

use nalgebra::{SMatrix, SVector};

use crate::circuit::{Circuit, Logs, PARAMETERS, Rating};
use crate::plate::{Completed, VALUES, Values};
use std::f64::consts::TAU;

/// How many unknowns there are.
pub const UNKNOWNS: usize = 29;
/// How many of them a plate knows: its values and the circuit.
pub(super) const OF_PLATE: usize = VALUES + PARAMETERS;
/// How many change the motor; the others are the instruments'.
pub(super) const OF_MOTOR: usize = 23;

/// All unknowns.
pub(super) type Unknowns = SVector<f64, UNKNOWNS>;
pub(super) type Square = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// Places of the unknowns behind those of the plate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub(super) enum Unknown {
    /// `ln` of the share of the magnetizing current at rated load that saturates.
    Saturation = OF_PLATE,
    /// `ln` of the exponent with which that share grows with the flux.
    SaturationExponent,
    /// Logit of the bearings' share of windage and friction at rated speed.
    Bearings,
    /// `ln` of the inertia in kg m2.
    Inertia,
    /// `ln` of the winding's resistance at rated load over the one at [`WARM_DEGC`].
    Warmth,
    /// Relative errors of the instruments, common to all readings.
    VoltageGain,
    CurrentGain,
    PowerGain,
    /// Angle by which the wattmeter shows the current late, rad.
    PowerAngle,
    TorqueGain,
    ResistanceGain,
}

/// Means and standard deviations of what a plate does not know, in the order of [`Unknown`] up to the inertia.
///
/// Saturation: rated motors need 1.1 to 1.7 times the ampere-turns of the air gap, half of that above a straight line is
/// the iron's; the exponents are those of the effect `magnetizing-saturation`. Bearings: from a twentieth to three quarters of
/// the mechanical loss. Both are wide assumptions, no measurements.
pub(super) const SATURATION: [f64; 2] = [-1.386, 0.6];
pub(super) const SATURATION_EXPONENT: [f64; 2] = [1.946, 0.35];
pub(super) const BEARINGS: [f64; 2] = [-0.85, 1.0];
/// The resistance at rated load, by a class B rise of 80 K above 20 degC, is uncertain by 13 K.
pub(super) const WARMTH: [f64; 2] = [0.0, 0.04];
/// Lowest and highest place of saturation and exponent: where the effect in a motor file holds.
pub(super) const EXTRA_BOUNDS: [(Unknown, [f64; 2]); 3] = [
    (Unknown::Saturation, [-4.6, -0.16]),
    (Unknown::SaturationExponent, [0.7, 2.77]),
    (Unknown::Bearings, [-6.0, 6.0]),
];

/// Temperature of a winding at rated load, degC.
pub(super) const WARM_DEGC: f64 = 100.0;
/// Temperature at which copper (IEC 60034-1) and aluminium would have no resistance, degC below zero.
const COPPER_DEGC: f64 = 235.0;
const ALUMINIUM_DEGC: f64 = 225.0;

/// The motor of a set of unknowns, and the instruments that show it.
#[derive(Clone, Debug)]
pub(super) struct Machine {
    pub unknowns: Unknowns,
    pub completed: Completed,
    pub circuit: Circuit,
    /// Base of current, A, impedance, ohm, speed, rad/s mechanical, and torque, N m.
    pub base: Base,
    /// Air-gap voltage at rated load, per unit.
    pub rated_flux: f64,
    /// Rated torque, per unit, and rated speed over synchronous speed.
    pub rated_torque: f64,
    pub rated_speed: f64,
}

/// What per unit is a multiple of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Base {
    pub volt: f64,
    pub amp: f64,
    pub ohm: f64,
    pub watt: f64,
    pub rad_s: f64,
    pub nm: f64,
}

/// The values of the plate among the unknowns.
pub(super) fn values(unknowns: &Unknowns) -> Values {
    unknowns.fixed_rows::<VALUES>(0).into_owned()
}

/// The circuit's logarithms among the unknowns.
pub(super) fn logs(unknowns: &Unknowns) -> Logs {
    unknowns.fixed_rows::<PARAMETERS>(VALUES).into_owned()
}

impl Machine {
    pub fn of(unknowns: &Unknowns, plate: &Completed) -> Machine {
        let completed = plate.with_values(&values(unknowns));
        let circuit = Circuit::from_logs(&logs(unknowns));
        let rating = completed.targets.rating();
        let true_slip = rating.slip * circuit.slip_ratio;
        Machine {
            unknowns: *unknowns,
            base: Base::of(&completed),
            rated_flux: circuit.rated_air_gap_voltage(&rating),
            rated_torque: rated_torque(&rating, true_slip),
            rated_speed: 1.0 - true_slip,
            completed,
            circuit,
        }
    }

    pub fn get(&self, unknown: Unknown) -> f64 {
        self.unknowns[unknown as usize]
    }

    /// Share of the magnetizing current at rated load that saturates, and its exponent.
    pub fn saturation(&self) -> [f64; 2] {
        [
            self.get(Unknown::Saturation).exp(),
            self.get(Unknown::SaturationExponent).exp(),
        ]
    }

    /// Bearings' share of windage and friction at rated speed.
    pub fn bearings(&self) -> f64 {
        1.0 / (1.0 + (-self.get(Unknown::Bearings)).exp())
    }

    /// Factors on the resistances of stator and rotor at a temperature of the winding, degC.
    pub fn warmth(&self, degc: f64) -> [f64; 2] {
        let warm = (COPPER_DEGC + WARM_DEGC) * self.get(Unknown::Warmth).exp();
        let stator = (COPPER_DEGC + degc) / warm;
        let rotor = (ALUMINIUM_DEGC + degc) / (warm - COPPER_DEGC + ALUMINIUM_DEGC);
        [stator.max(0.01), rotor.max(0.01)]
    }

    /// Torque of windage and friction at a speed over rated speed, per unit.
    pub fn friction(&self, speed: f64) -> f64 {
        let bearings = self.bearings();
        self.rated_torque * self.circuit.windage * (bearings + (1.0 - bearings) * speed * speed)
    }
}

fn rated_torque(rating: &Rating, true_slip: f64) -> f64 {
    rating.power / (1.0 - true_slip)
}

impl Base {
    fn of(completed: &Completed) -> Base {
        let (volt, amp) = (completed.voltage_volt, completed.base_current_amp());
        let watt = 3f64.sqrt() * volt * amp;
        let rad_s = TAU * completed.frequency_hz / f64::from(completed.pole_pairs);
        Base {
            volt,
            amp,
            ohm: completed.base_impedance_ohm(),
            watt,
            rad_s,
            nm: watt / rad_s,
        }
    }
}
