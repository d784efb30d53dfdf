//! A test point as rows of the fit: its own unknowns are eliminated by an orthogonal transformation.

use nalgebra::{DMatrix, DVector};

use crate::measured::point::{OWN, Own, Point};
use crate::measured::table::Test;
use crate::measured::unknowns::{Machine, OF_MOTOR, UNKNOWNS, Unknown, Unknowns};

/// Step of the differences.
const STEP: f64 = 1e-6;

/// A point linearised: what stays when its own unknowns have settled, and how they settle.
#[derive(Clone, Debug)]
pub(in crate::measured) struct PointRows {
    /// Sum of squares of all readings, as they are.
    pub cost: f64,
    /// Derivatives by the unknowns, in standard deviations.
    pub jacobian: DMatrix<f64>,
    /// Residuals, in standard deviations.
    pub residual: DVector<f64>,
    /// What an error of one unit in each reading adds to the residuals.
    pub readings: DMatrix<f64>,
    own: Settling,
}

#[derive(Clone, Debug)]
struct Settling {
    upper: DMatrix<f64>,
    jacobian: DMatrix<f64>,
    residual: DVector<f64>,
}

impl PointRows {
    /// `moved` are the machines with one unknown moved by [`STEP`] each.
    pub fn of(point: &Point, own: &Own, doubt: f64, machine: &Machine, moved: &[Machine]) -> Self {
        let count = point.readings.len();
        let weight = |k: usize| 1.0 / (point.readings[k].deviation * doubt.sqrt());
        let here = point.predicted(machine, own);
        let difference = |there: &[f64], k: usize| weight(k) * (there[k] - here[k]) / STEP;
        let mut by_own = DMatrix::zeros(count, point.own);
        for j in 0..point.own {
            let mut shifted = *own;
            shifted[j] += STEP;
            let there = point.predicted(machine, &shifted);
            by_own.set_column(j, &DVector::from_fn(count, |k, _| difference(&there, k)));
        }
        // Unknowns, residual, then one column for each reading.
        let mut all = DMatrix::zeros(count, UNKNOWNS + 1 + count);
        for (j, other) in moved.iter().enumerate() {
            let there = point.predicted(other, own);
            all.set_column(j, &DVector::from_fn(count, |k, _| difference(&there, k)));
        }
        gains(point, &mut all, weight);
        for k in 0..count {
            all[(k, UNKNOWNS)] = weight(k) * (here[k] - point.readings[k].value);
            all[(k, UNKNOWNS + 1 + k)] = weight(k);
        }
        let cost = all.column(UNKNOWNS).norm_squared();
        let factor = by_own.qr();
        factor.q_tr_mul(&mut all);
        let (own, left) = (point.own, count - point.own);
        PointRows {
            cost,
            jacobian: all.view((own, 0), (left, UNKNOWNS)).into_owned(),
            residual: all.view((own, UNKNOWNS), (left, 1)).column(0).into_owned(),
            readings: all.view((own, UNKNOWNS + 1), (left, count)).into_owned(),
            own: Settling {
                upper: factor.r(),
                jacobian: all.view((0, 0), (own, UNKNOWNS)).into_owned(),
                residual: all.view((0, UNKNOWNS), (own, 1)).column(0).into_owned(),
            },
        }
    }

    /// The point's own unknowns after a step of the others.
    pub fn settled(&self, test: Test, own: &Own, step: &Unknowns) -> Own {
        let right = -(&self.own.residual
            + &self.own.jacobian * DVector::from_column_slice(step.as_slice()));
        let change = self.own.upper.solve_upper_triangular(&right);
        let mut new = *own;
        for (k, change) in change.iter().flat_map(|c| c.iter()).enumerate() {
            let [low, high] = limits(test, k);
            let longest = 0.3 * own[k].abs().max(0.05);
            new[k] = (own[k] + change.clamp(-longest, longest)).clamp(low, high);
        }
        new
    }
}

/// Places that a point's own unknown may take.
fn limits(test: Test, k: usize) -> [f64; 2] {
    match (test, k) {
        (Test::DcResistance, _) => [-0.6, 2.6],
        (Test::Load, 1) => [1e-5, 0.95],
        (Test::NoLoad | Test::LockedRotor, 1) | (Test::Load, _) if k + 1 == own_of(test) => {
            [-0.6, 2.6]
        }
        _ => [1e-3, 20.0],
    }
}

fn own_of(test: Test) -> usize {
    match test {
        Test::Load => OWN,
        Test::NoLoad | Test::LockedRotor => 2,
        Test::DcResistance | Test::CoastDown => 1,
    }
}

/// Derivatives by the instruments' errors, which stand behind the motor's unknowns.
fn gains(point: &Point, all: &mut DMatrix<f64>, weight: impl Fn(usize) -> f64) {
    use crate::measured::table::Column;
    if point.test == Test::CoastDown {
        return;
    }
    for (k, reading) in point.readings.iter().enumerate() {
        let places: &[(Unknown, f64)] = match reading.column {
            Column::Voltage => &[(Unknown::VoltageGain, 1.0)],
            Column::Current => &[(Unknown::CurrentGain, 1.0)],
            Column::Power => &[
                (Unknown::PowerGain, 1.0),
                (Unknown::PowerAngle, point.tan_phi),
            ],
            Column::Torque => &[(Unknown::TorqueGain, 1.0)],
            Column::Resistance => &[(Unknown::ResistanceGain, 1.0)],
            _ => &[],
        };
        for &(unknown, share) in places {
            all[(k, unknown as usize)] = share * weight(k);
        }
    }
}

/// The machines with one unknown moved each.
pub(super) fn moved(unknowns: &Unknowns, completed: &crate::plate::Completed) -> Vec<Machine> {
    let one = |k: usize| {
        let mut moved = *unknowns;
        moved[k] += STEP;
        Machine::of(&moved, completed)
    };
    (0..OF_MOTOR).map(one).collect()
}
