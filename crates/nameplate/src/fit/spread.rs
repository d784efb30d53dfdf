//! How far the circuit may be from the one found: what the values leave open to the prior, and what the values are off by.

use nalgebra::{SMatrix, SVector};

use super::least_squares::jacobian;
use super::misfit::{Misfits, Targets};
use super::start::{bounds, prior_spread, start};
use super::{Fit, MEETS};
use crate::circuit::{Circuit, Logs, PARAMETERS, Place};
use crate::interval::Interval;
use crate::plate::{Completed, VALUES, Values};

type Square = SMatrix<f64, PARAMETERS, PARAMETERS>;
type ByValue = SMatrix<f64, PARAMETERS, VALUES>;

/// Step of the differences by a value's logarithm.
const STEP: f64 = 1e-5;
/// Precision of an unknown that is held: its rounding counts as that of the printed slip.
const HELD: f64 = 1e12;

/// The covariance of a circuit's unknowns, and how they follow the values.
#[derive(Clone, Debug)]
pub struct Spread<'c> {
    completed: &'c Completed,
    logs: Logs,
    own: Square,
    by_value: ByValue,
}

impl<'c> Spread<'c> {
    /// The spread around the circuit that was found for a plate.
    pub fn of(completed: &'c Completed, fit: &Fit) -> Spread<'c> {
        let logs = fit.circuit.logs();
        let at = |values: &Values| completed.with_values(values);
        let weights = Misfits::repeat(MEETS.powi(-2));
        let upper = bounds(&completed.targets)[1];
        let jacobian = jacobian(&completed.targets, &logs, fit.breakdown_slip, &upper);
        let mut weighted = jacobian;
        for (mut row, weight) in weighted.row_iter_mut().zip(weights.iter()) {
            row *= *weight;
        }
        let precision = precision(&completed.targets);
        let own = (jacobian.tr_mul(&weighted) + Square::from_diagonal(&precision))
            .cholesky()
            .map_or_else(Square::zeros, |factor| factor.inverse());
        let here = completed.targets.values();
        let mut pull = ByValue::zeros();
        for k in 0..VALUES {
            let mut moved = here;
            moved[k] += STEP;
            let targets = at(&moved).targets;
            let misfits = targets.misfits(&fit.circuit, fit.breakdown_slip) - fit.misfits;
            let centre = start(&targets).logs() - start(&completed.targets).logs();
            let gradient = weighted.tr_mul(&misfits) - precision.component_mul(&centre);
            pull.set_column(k, &(gradient / STEP));
        }
        Spread {
            completed,
            logs,
            own,
            by_value: -(own * pull),
        }
    }

    /// 95 % intervals of positive quantities of a circuit and its plate, and the correlations of their logarithms.
    pub fn intervals<const N: usize>(
        &self,
        of: impl Fn(&Circuit, &Completed) -> [f64; N],
    ) -> ([Interval; N], SMatrix<f64, N, N>) {
        let logs = |circuit: &Logs, completed: &Completed| {
            SVector::<f64, N>::from(of(&Circuit::from_logs(circuit), completed)).map(f64::ln)
        };
        let here = logs(&self.logs, self.completed);
        let mut by_circuit = SMatrix::<f64, N, PARAMETERS>::zeros();
        for k in 0..PARAMETERS {
            let mut moved = self.logs;
            moved[k] += STEP;
            by_circuit.set_column(k, &((logs(&moved, self.completed) - here) / STEP));
        }
        let values = self.completed.targets.values();
        let mut by_value = by_circuit * self.by_value;
        for k in 0..VALUES {
            let mut moved = values;
            moved[k] += STEP;
            let direct = (logs(&self.logs, &self.completed.with_values(&moved)) - here) / STEP;
            by_value.set_column(k, &(by_value.column(k) + direct));
        }
        let covariance = by_circuit * self.own * by_circuit.transpose()
            + by_value * self.completed.covariance * by_value.transpose();
        let interval = |k: usize| Interval::around(here[k].exp(), covariance[(k, k)].sqrt());
        let correlation = SMatrix::from_fn(|a, b| {
            covariance[(a, b)] / (covariance[(a, a)] * covariance[(b, b)]).sqrt().max(1e-300)
        });
        (core::array::from_fn(interval), correlation)
    }
}

fn precision(targets: &Targets) -> Logs {
    let mut precision = prior_spread(targets).map(|sd| sd.powi(-2));
    precision[Place::SlipRatio as usize] = HELD;
    precision
}
