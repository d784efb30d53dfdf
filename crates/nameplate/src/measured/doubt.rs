//! Which test point or number of the plate contradicts all others, and by how much.
//!
//! A row's chi-square is that of what the other rows predict of it (deletion identity of least squares): its residual weighed
//! with the covariance that the fit leaves to it. A contradiction is not averaged away: the uncertainty of what takes part in
//! it grows until it fits.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::fit::{PointRows, Posterior, Problem};
use super::point::Point;
use super::table::{Column, Test};
use super::unknowns::Square;
use crate::plate::VALUES;

/// Standard deviations of a normal distribution that one row in 10 000 exceeds.
const BEYOND: f64 = 3.719;
/// A direction in which a row alone decides shows no contradiction.
const ALONE: f64 = 1e-7;
/// Rows with at least this share of the worst contradiction take part in it.
const TAKES_PART: f64 = 0.5;
/// A temperature is the culprit only where it explains clearly more than any other reading.
const LESS_LIKELY: f64 = 0.8;

/// A contradiction.
#[derive(Clone, Debug, PartialEq)]
pub struct Doubt {
    /// The test, or the place of a plate's value in [`crate::plate::Value`].
    pub what: What,
    /// How far it is from what all others say.
    pub chi_square: f64,
    /// Its degrees of freedom.
    pub freedom: usize,
    /// What one row in 10 000 exceeds by chance.
    pub limit: f64,
    /// The reading that would settle it.
    pub culprit: Option<Culprit>,
}

/// What contradicts.
#[derive(Clone, Debug, PartialEq)]
pub enum What {
    /// Rows of the tables, by their number.
    Rows(Test, Vec<usize>),
    /// A value of the plate.
    Plate(usize),
}

/// A reading, and the value that would fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Culprit {
    /// The quantity.
    pub column: Column,
    /// As measured, in the table's SI unit (W, rpm, degC).
    pub measured: f64,
    /// The value that fits all others.
    pub fits: f64,
}

/// Chi-square that one in 10 000 exceeds (Wilson and Hilferty).
fn limit(freedom: usize) -> f64 {
    let part = 2.0 / (9.0 * freedom.max(1) as f64);
    freedom as f64 * (1.0 - part + BEYOND * part.sqrt()).powi(3)
}

/// What contradicts and, where something does, the factors by which variances must grow.
pub(super) fn doubts(problem: &Problem<'_>, posterior: &Posterior) -> Vec<Doubt> {
    let covariance = posterior.covariance();
    let points = problem.points.iter().zip(&posterior.rows);
    let points = points.filter_map(|(point, rows)| of_point(point, rows, &covariance, posterior));
    let values = (0..VALUES).filter_map(|k| of_value(problem, posterior, &covariance, k));
    let all: Vec<Doubt> = points.chain(values).collect();
    let worst = all.iter().map(excess).fold(1.0, f64::max);
    let takes_part = |doubt: &Doubt| excess(doubt) > 1.0 && excess(doubt) >= TAKES_PART * worst;
    all.into_iter().filter(takes_part).collect()
}

/// How often the limit is exceeded.
pub(super) fn excess(doubt: &Doubt) -> f64 {
    doubt.chi_square / doubt.limit
}

fn of_value(
    problem: &Problem<'_>,
    posterior: &Posterior,
    covariance: &Square,
    k: usize,
) -> Option<Doubt> {
    let variance = problem.prior.values[(k, k)] * problem.doubts.values[k];
    let left = variance - covariance[(k, k)];
    if !problem.completed.known[k] || left < 1e-3 * variance {
        return None;
    }
    let off = posterior.unknowns[k] - problem.prior.centre[k];
    Some(Doubt {
        what: What::Plate(k),
        chi_square: off * off / left,
        freedom: 1,
        limit: limit(1),
        culprit: None,
    })
}

fn of_point(
    point: &Point,
    rows: &PointRows,
    covariance: &Square,
    posterior: &Posterior,
) -> Option<Doubt> {
    let count = rows.residual.len();
    if count == 0 {
        return None;
    }
    let covariance = DMatrix::from_column_slice(
        covariance.nrows(),
        covariance.ncols(),
        covariance.as_slice(),
    );
    let left =
        DMatrix::identity(count, count) - &rows.jacobian * covariance * rows.jacobian.transpose();
    let eigen = SymmetricEigen::new(left);
    let inverse = |x: f64| if x > ALONE { 1.0 / x } else { 0.0 };
    let freedom = eigen.eigenvalues.iter().filter(|x| **x > ALONE).count();
    let scaled = DMatrix::from_diagonal(&eigen.eigenvalues.map(inverse));
    let weight = &eigen.eigenvectors * scaled * eigen.eigenvectors.transpose();
    let chi_square = rows.residual.dot(&(&weight * &rows.residual));
    (freedom > 0).then(|| Doubt {
        what: What::Rows(point.test, point.rows.clone()),
        chi_square,
        freedom,
        limit: limit(freedom),
        culprit: culprit(point, rows, &weight, posterior),
    })
}

/// The reading that, had it been another, would lower the chi-square most.
fn culprit(
    point: &Point,
    rows: &PointRows,
    weight: &DMatrix<f64>,
    posterior: &Posterior,
) -> Option<Culprit> {
    let pulled = weight * &rows.residual;
    let one = |k: usize| {
        let column: DVector<f64> = rows.readings.column(k).into_owned();
        let (along, square) = (column.dot(&pulled), column.dot(&(weight * &column)));
        let likely = match point.readings[k].column {
            Column::Temperature => LESS_LIKELY,
            _ => 1.0,
        };
        (square > 0.0).then(|| (k, likely * along * along / square, along / square))
    };
    let all = (0..point.readings.len()).filter_map(one);
    let (k, _, change) = all.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let reading = point.readings[k];
    Some(Culprit {
        column: reading.column,
        measured: reading.measured,
        fits: meant(point, reading.column, reading.value + change, posterior),
    })
}

/// The measured quantity of a compared value.
fn meant(point: &Point, column: Column, value: f64, posterior: &Posterior) -> f64 {
    let base = &posterior.machine.base;
    let rpm = 60.0 / std::f64::consts::TAU;
    match (point.test, column) {
        (Test::CoastDown, _) => value * posterior.machine.rated_speed * base.rad_s * rpm,
        (_, Column::Speed) => (1.0 - value) * point.nu * base.rad_s * rpm,
        (_, Column::Temperature) => value * super::point::KELVINS,
        _ => value.exp(),
    }
}
