//! What real motors of a size have in common: a joint normal distribution of six values.

mod real_motors;

use nalgebra::{DMatrix, DVector, SMatrix};

use crate::interval::Interval;
use crate::plate::{VALUES, Values};

/// Covariance of the six values.
pub type Covariance = SMatrix<f64, VALUES, VALUES>;

/// The six values of motors of one size, before anything is known but the power.
#[derive(Clone, Debug, PartialEq)]
pub struct Population {
    /// Means.
    pub mean: Values,
    /// Covariance between motors, differences between makers included.
    pub covariance: Covariance,
}

/// Small motors differ more than the pooled spread says; limits of the factor.
const WIDENING: [f64; 2] = [1.0, 1.5];
/// Widening per factor e of power below 10 kW.
const WIDENING_RATE: f64 = 0.1;

/// Terms of a mean: 1, `l`, `l^2` with `l = ln(P / 10 kW)`.
pub const MEAN_TERMS: usize = 3;
/// Terms of the inertia: those of a mean and the logarithm of the pole pairs over two.
pub const INERTIA_TERMS: usize = 4;

/// What is known of motors before one of them is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Prior {
    /// Means of the six values by size.
    pub mean: [[f64; MEAN_TERMS]; VALUES],
    /// Standard deviations around the means.
    pub spread: [f64; VALUES],
    /// Correlations of the deviations.
    pub correlation: [[f64; VALUES]; VALUES],
    /// Factor on the spread: motors of a maker that is not in the data differ more.
    pub between_makers: f64,
    /// Logarithm of the inertia in kg m2 by size and pole pairs.
    pub inertia: [f64; INERTIA_TERMS],
    /// Standard deviation of the inertia's logarithm.
    pub inertia_spread: f64,
}

/// Terms of the means at a power, kW; beyond 0.05 to 5000 kW the nearest.
pub fn mean_terms(power_kw: f64) -> [f64; MEAN_TERMS] {
    let l = (power_kw.clamp(0.05, 5000.0) / 10.0).ln();
    [1.0, l, l * l]
}

/// Factor on the spread for a power, kW: small motors differ more.
fn widening(power_kw: f64) -> f64 {
    let [_, l, _] = mean_terms(power_kw);
    (-WIDENING_RATE * l).exp().clamp(WIDENING[0], WIDENING[1])
}

impl Prior {
    /// Fitted to published catalogues.
    pub const REAL_MOTORS: Prior = real_motors::REAL_MOTORS;

    /// Motors of a power, kW.
    pub fn of_size(&self, power_kw: f64) -> Population {
        let terms = mean_terms(power_kw);
        let mean = |k: usize| (0..MEAN_TERMS).map(|j| self.mean[k][j] * terms[j]).sum();
        let factor = (widening(power_kw) * self.between_makers).powi(2);
        Population {
            mean: Values::from_fn(|k, _| mean(k)),
            covariance: Covariance::from_fn(|a, b| {
                factor * self.spread[a] * self.spread[b] * self.correlation[a][b]
            }),
        }
    }

    /// Inertia of a motor's own rotor, kg m2, by power (kW), pole pairs and frequency (Hz): the synchronous speed counts.
    pub fn inertia_kg_m2(&self, power_kw: f64, pole_pairs: u32, frequency_hz: f64) -> Interval {
        let pairs_at_50_hz = f64::from(pole_pairs) * 50.0 / frequency_hz;
        let terms = inertia_terms(power_kw, pairs_at_50_hz);
        let log: f64 = (0..INERTIA_TERMS).map(|k| self.inertia[k] * terms[k]).sum();
        Interval::around(log.exp(), self.inertia_spread * widening(power_kw))
    }
}

/// Terms of the inertia's logarithm.
pub fn inertia_terms(power_kw: f64, pairs_at_50_hz: f64) -> [f64; INERTIA_TERMS] {
    let [one, l, squared] = mean_terms(power_kw);
    [one, l, squared, (pairs_at_50_hz / 2.0).ln()]
}

impl Population {
    /// The values with the known ones (`Some`) at their place and the others as expected beside them; the covariance of the
    /// unknown ones given the known, zero elsewhere.
    pub fn given(&self, known: &[Option<f64>; VALUES]) -> (Values, Covariance) {
        let (set, unset): (Vec<usize>, Vec<usize>) = (0..VALUES).partition(|&k| known[k].is_some());
        let block = |rows: &[usize], columns: &[usize]| {
            DMatrix::from_fn(rows.len(), columns.len(), |a, b| {
                self.covariance[(rows[a], columns[b])]
            })
        };
        let surprise = DVector::from_fn(set.len(), |a, _| {
            known[set[a]].unwrap_or(self.mean[set[a]]) - self.mean[set[a]]
        });
        let cross = block(&unset, &set);
        let gain = block(&set, &set).cholesky().map_or_else(
            || DMatrix::zeros(unset.len(), set.len()),
            |factor| factor.solve(&cross.transpose()).transpose(),
        );
        let shift = &gain * surprise;
        let left = block(&unset, &unset) - &gain * cross.transpose();
        let mut mean = Values::from_fn(|k, _| known[k].unwrap_or(self.mean[k]));
        let mut covariance = Covariance::zeros();
        for (a, &k) in unset.iter().enumerate() {
            mean[k] += shift[a];
            for (b, &other) in unset.iter().enumerate() {
                covariance[(k, other)] = left[(a, b)];
            }
        }
        (mean, covariance)
    }
}
