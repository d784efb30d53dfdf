//! What the plate and the prior say of the circuit, as rows of the fit.
//!
//! [`crate::fit::Spread`] takes the values as known up to their spread, and the circuit as what meets them and lies near the
//! prior's centre. The same here, linearised anew at every circuit: the rows weigh the circuit given the values and say nothing
//! of the values themselves.

use nalgebra::{SMatrix, SVector};

use super::begin::Begin;
use super::unknowns::{OF_PLATE, Unknowns, logs, values};
use crate::circuit::{Circuit, PARAMETERS, Place, breakdown_slip};
use crate::fit::{MEETS, MISFITS, Misfit, Misfits, prior_spread, start};
use crate::plate::{Completed, VALUES};

/// Rows for each unknown of the circuit.
pub(super) type Rows = SMatrix<f64, PARAMETERS, OF_PLATE>;
pub(super) type Residual = SVector<f64, PARAMETERS>;

const ROWS: usize = MISFITS + PARAMETERS;
type Whole = SMatrix<f64, ROWS, OF_PLATE>;

/// Step of the differences.
const STEP: f64 = 1e-6;
/// Precision of an unknown that is held: the slip's rounding counts among the values.
const HELD: f64 = 1e12;
/// A single motor's current may differ from the printed one by what its efficiency and power factor may.
const CURRENT: f64 = 0.05;

/// Factor on the standard deviations: losses share a sum, so that what a straight line says of their logarithms is too narrow
/// (measured on random motors: `tests/measured`).
const WIDER: f64 = 1.15;

/// The rows of one plate.
pub(super) struct PlateTerm {
    completed: Completed,
    meets: Misfits,
    /// What pushes the plate's own circuit against its bounds: a bound is no evidence.
    at_plate: Residual,
}

impl PlateTerm {
    pub fn of(begin: &Begin, unknowns: &Unknowns) -> PlateTerm {
        // What the plate's own circuit misses counts no more than once.
        let mut meets = begin.fit.misfits.map(|misfit| misfit.abs().max(MEETS));
        meets[Misfit::Current as usize] = CURRENT;
        let mut term = PlateTerm {
            completed: begin.completed.clone(),
            meets,
            at_plate: Residual::zeros(),
        };
        let (whole, residual) = term.whole(unknowns);
        term.at_plate = whole.fixed_columns::<PARAMETERS>(VALUES).tr_mul(&residual);
        term
    }

    /// The rows and their residuals, each of standard deviation one.
    pub fn rows(&self, unknowns: &Unknowns) -> Option<(Rows, Residual)> {
        let (whole, residual) = self.whole(unknowns);
        let circuit = whole.fixed_columns::<PARAMETERS>(VALUES).into_owned();
        let mut normal = circuit.tr_mul(&circuit);
        normal[(PARAMETERS - 1, PARAMETERS - 1)] += HELD;
        let gradient = circuit.tr_mul(&residual) - self.at_plate;
        let mut cross = circuit.tr_mul(&whole);
        cross[(PARAMETERS - 1, OF_PLATE - 1)] += HELD;
        let lower = normal.cholesky()?.l();
        Some((
            lower.solve_lower_triangular(&cross)? / WIDER,
            lower.solve_lower_triangular(&gradient)? / WIDER,
        ))
    }

    fn whole(&self, unknowns: &Unknowns) -> (Whole, SVector<f64, ROWS>) {
        let circuit = Circuit::from_logs(&logs(unknowns));
        let rating = self
            .completed
            .with_values(&values(unknowns))
            .targets
            .rating();
        let slip = breakdown_slip(&circuit, &rating);
        let here = self.residual(unknowns, slip);
        let mut whole = Whole::zeros();
        for k in (0..OF_PLATE).filter(|&k| k != VALUES + Place::SlipRatio as usize) {
            let mut moved = *unknowns;
            moved[k] += STEP;
            whole.set_column(k, &((self.residual(&moved, slip) - here) / STEP));
        }
        (whole, here)
    }

    fn residual(&self, unknowns: &Unknowns, breakdown_slip: f64) -> SVector<f64, ROWS> {
        let targets = self.completed.with_values(&values(unknowns)).targets;
        let logs = logs(unknowns);
        let misfits = targets.misfits(&Circuit::from_logs(&logs), breakdown_slip);
        let prior = (logs - start(&targets).logs()).component_div(&prior_spread(&targets));
        let mut residual = SVector::<f64, ROWS>::zeros();
        residual
            .fixed_rows_mut::<MISFITS>(0)
            .copy_from(&misfits.component_div(&self.meets));
        residual
            .fixed_rows_mut::<PARAMETERS>(MISFITS)
            .copy_from(&prior);
        residual[ROWS - 1] = 0.0;
        residual
    }
}
