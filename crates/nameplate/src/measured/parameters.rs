//! Parameters of a motor file, with what tests add: saturation and friction apart from windage.

use nalgebra::DMatrix;

use super::fit::Posterior;
use super::unknowns::{Machine, OF_MOTOR, Square, Unknown};
use crate::circuit::{Circuit, Place};
use crate::interval::Interval;
use crate::physical::{KEYS, PHYSICAL, physical_with_cages};
use crate::plate::{Completed, VALUES};

/// How many parameters tests may tell.
pub const ALL: usize = PHYSICAL + 3;

/// Keys of a motor file.
pub const NAMES: [&str; ALL] = {
    let mut names = [""; ALL];
    let mut k = 0;
    while k < PHYSICAL {
        names[k] = KEYS[k];
        k += 1;
    }
    names[PHYSICAL] = "saturation";
    names[PHYSICAL + 1] = "saturation_exponent";
    names[PHYSICAL + 2] = "coulomb_torque_nm";
    names
};

const MAGNETIZING: usize = 4;
const WINDAGE: usize = 9;
const STRAY: usize = 10;
const INERTIA: usize = 11;
const LEAKAGE_DROP: usize = 7;
/// A drop below does not count.
const LEAST_DROP: f64 = 1e-4;

/// Which effects the tests show: the parameters mean the motor with them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Form {
    /// Two cages and leakage saturation, seen at standstill.
    pub standstill: bool,
    /// Saturation of the magnetizing inductance, seen without load.
    pub saturates: bool,
    /// Bearings apart from windage, seen in a coast-down.
    pub bearings: bool,
}

impl Form {
    /// Whether a parameter is one of this form.
    pub fn has(&self, k: usize) -> bool {
        match k {
            5..=7 => self.standstill,
            12 | 13 => self.saturates,
            14 => self.bearings,
            _ => true,
        }
    }
}

/// Parameters in the order of [`NAMES`], SI units.
pub(super) fn parameters(machine: &Machine, form: &Form) -> [f64; ALL] {
    let of_circuit = physical_with_cages(&machine.circuit, &machine.completed, form.standstill);
    let mut all = [0.0; ALL];
    all[..PHYSICAL].copy_from_slice(&of_circuit);
    all[INERTIA] = machine.get(Unknown::Inertia).exp();
    // The motor file counts saturation from rated stator flux, the circuit from the air gap's at rated load.
    let [share, exponent] = machine.saturation();
    let grown = share * machine.rated_flux.powf(-exponent);
    let at_rated_flux = 1.0 - share + grown;
    all[PHYSICAL] = grown / at_rated_flux;
    all[PHYSICAL + 1] = exponent;
    if form.saturates {
        all[MAGNETIZING] /= at_rated_flux;
    }
    // The motor file counts stray load from the printed current.
    if let Some(printed) = machine.completed.plate.current_amp {
        all[STRAY] *= (printed.value / machine.base.amp).powi(2);
    }
    let bearings = machine.bearings();
    let torque = machine.rated_torque * machine.circuit.windage * machine.base.nm;
    all[PHYSICAL + 2] = torque * bearings;
    if form.bearings {
        all[WINDAGE] *= 1.0 - bearings;
    }
    all
}

/// Step of the differences.
const STEP: f64 = 1e-5;

/// Derivatives of the parameters' logarithms by the unknowns.
pub(super) fn derivatives(
    posterior: &Posterior,
    completed: &Completed,
    form: &Form,
) -> DMatrix<f64> {
    let here = parameters(&posterior.machine, form);
    let mut matrix = DMatrix::zeros(ALL, super::unknowns::UNKNOWNS);
    for j in 0..OF_MOTOR {
        let mut moved = posterior.unknowns;
        moved[j] += STEP;
        let there = parameters(&Machine::of(&moved, completed), form);
        for k in 0..ALL {
            matrix[(k, j)] = (there[k] / here[k]).ln() / STEP;
        }
    }
    matrix
}

/// Covariance of the parameters' logarithms.
pub(super) fn covariance(derivatives: &DMatrix<f64>, of_unknowns: &Square) -> DMatrix<f64> {
    let unknowns = DMatrix::from_column_slice(
        of_unknowns.nrows(),
        of_unknowns.ncols(),
        of_unknowns.as_slice(),
    );
    derivatives * unknowns * derivatives.transpose()
}

/// 95 % intervals.
pub(super) fn intervals(
    posterior: &Posterior,
    form: &Form,
    covariance: &DMatrix<f64>,
) -> [Interval; ALL] {
    let here = parameters(&posterior.machine, form);
    let mut all: [Interval; ALL] =
        core::array::from_fn(|k| Interval::around(here[k], covariance[(k, k)].max(0.0).sqrt()));
    all[LEAKAGE_DROP] = leakage_drop(posterior);
    for (interval, range) in all.iter_mut().zip(crate::physical::RANGES) {
        *interval = interval.inside(range);
    }
    all
}

/// The drop ends at nothing, where its logarithm has no end: its interval is that of the leakage that stays.
fn leakage_drop(posterior: &Posterior) -> Interval {
    let place = VALUES + Place::SaturatedLeakage as usize;
    let spread = posterior.covariance()[(place, place)].max(0.0).sqrt();
    let stays = Interval::around(posterior.machine.circuit.saturated_leakage, spread);
    let drop = |saturated_leakage: f64| {
        let circuit = Circuit {
            saturated_leakage: saturated_leakage.min(1.0),
            ..posterior.machine.circuit
        };
        circuit.leakage_drop().max(LEAST_DROP)
    };
    Interval {
        value: drop(stays.value),
        low: drop(stays.high),
        high: drop(stays.low),
    }
}
