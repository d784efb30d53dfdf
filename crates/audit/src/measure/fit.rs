//! Least-squares fit of one sinusoid to a block of samples.
//!
//! Model: `x(t) = mean + Re[(phasor + slope tau) e^{j omega (t - centre)}]`, tau from -1 to 1 over the
//! block. Unlike a discrete Fourier sum it needs neither whole periods nor even sampling, and its
//! slope gives the frequency error and the change of the amplitude.

use crate::measure::normal::{cholesky, normal, solve};
use crate::measure::turn::Turns;
use num_complex::Complex64;

/// One sinusoid in one channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fit {
    /// Mean over the block, in the channel's unit.
    pub mean: f64,
    /// Amplitude and phase in the middle of the block.
    pub phasor: Complex64,
    /// Change of the phasor over half a block.
    pub slope: Complex64,
    /// Variance of the samples about their mean.
    pub variance: f64,
    /// Variance that the sinusoid leaves.
    pub rest: f64,
}

/// Columns of the model: 1, cos, sin, tau cos, tau sin.
const N: usize = 5;
type Row = [f64; N];

/// The model's columns over a block, with their normal matrix factored.
pub(crate) struct Basis {
    rows: Vec<Row>,
    factor: [Row; N],
    half: f64,
}

impl Basis {
    /// The columns at the times `t`, s, for `omega`, rad/s. `None` when they cannot be told apart:
    /// too few samples or less than about one period.
    pub fn new(t: &[f64], omega: f64) -> Option<Basis> {
        let (first, last) = (*t.first()?, *t.last()?);
        let (centre, half) = (0.5 * (first + last), 0.5 * (last - first));
        let mut turns = Turns::new(t, omega, centre);
        let rows: Vec<Row> = t
            .iter()
            .map(|t| {
                let (sin, cos) = turns.at(*t);
                let tau = (t - centre) / half;
                [1.0, cos, sin, tau * cos, tau * sin]
            })
            .collect();
        let factor = cholesky(normal(&rows), INDEPENDENT)?;
        Some(Basis { rows, factor, half })
    }

    /// Fits one channel over the block; `x` is as long as the block.
    pub fn fit(&self, x: &[f64]) -> Fit {
        let [fit] = self.fit_each([x]);
        fit
    }

    /// Fits several channels in one pass over the block, each by itself.
    pub fn fit_each<const K: usize>(&self, x: [&[f64]; K]) -> [Fit; K] {
        let mut sums = [Sums::default(); K];
        let length = x.iter().map(|x| x.len()).min().unwrap_or(0);
        let x = x.map(|x| &x[..length]);
        for (k, row) in self.rows.iter().take(length).enumerate() {
            for (sums, x) in sums.iter_mut().zip(x) {
                sums.add(row, x[k]);
            }
        }
        sums.map(|sums| self.solved(sums))
    }

    fn solved(&self, sums: Sums) -> Fit {
        let n = self.rows.len() as f64;
        let Sums { rhs, sum, square } = sums;
        let s = solve(&self.factor, rhs);
        let explained: f64 = s.iter().zip(&rhs).map(|(s, r)| s * r).sum();
        Fit {
            mean: s[0],
            phasor: Complex64::new(s[1], -s[2]),
            slope: Complex64::new(s[3], -s[4]),
            variance: (square - sum * sum / n) / n,
            rest: ((square - explained) / n).max(0.0),
        }
    }

    /// The frequency error that the slopes of several channels show together, rad/s.
    pub fn frequency_error(&self, fits: &[Fit]) -> f64 {
        let turning: f64 = fits
            .iter()
            .map(|fit| (fit.slope * fit.phasor.conj()).im)
            .sum();
        let power: f64 = fits.iter().map(|fit| fit.phasor.norm_sqr()).sum();
        turning / (power * self.half)
    }
}

/// What a channel adds up to over a block.
#[derive(Clone, Copy, Default)]
struct Sums {
    rhs: Row,
    sum: f64,
    square: f64,
}

impl Sums {
    fn add(&mut self, row: &Row, x: f64) {
        self.rhs = std::array::from_fn(|k| self.rhs[k] + row[k] * x);
        self.sum += x;
        self.square += x * x;
    }
}

/// Smallest share of a column that the columns before it may leave: below, the block is too short.
const INDEPENDENT: f64 = 0.02;

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// 2.6 periods, uneven sampling, a growing amplitude and an offset: exact to rounding.
    #[test]
    fn a_growing_sinusoid_is_recovered_from_a_broken_number_of_periods() {
        let omega = TAU * 50.0;
        let t: Vec<f64> = (0..520)
            .map(|k| f64::from(k) * 1e-4 + f64::from(k % 3) * 1e-5)
            .collect();
        let (centre, half) = (0.5 * t[519], 0.5 * t[519]);
        let (phasor, slope) = (
            Complex64::from_polar(325.0, 0.7),
            Complex64::from_polar(10.0, 0.7),
        );
        let signal = |t: &f64| {
            let tau = (t - centre) / half;
            3.0 + ((phasor + slope * tau) * Complex64::cis(omega * (t - centre))).re
        };
        let x: Vec<f64> = t.iter().map(signal).collect();
        let fit = Basis::new(&t, omega).unwrap().fit(&x);
        assert!((fit.phasor - phasor).norm() < 1e-9);
        assert!((fit.slope - slope).norm() < 1e-9);
        assert!((fit.mean - 3.0).abs() < 1e-9);
        assert!(fit.rest < 1e-9 * fit.variance);
    }

    #[test]
    fn the_slope_shows_the_frequency_error() {
        let t: Vec<f64> = (0..600).map(|k| f64::from(k) * 1e-4).collect();
        let x: Vec<f64> = t.iter().map(|t| (TAU * 50.2 * t).cos()).collect();
        let basis = Basis::new(&t, TAU * 50.0).unwrap();
        let error = basis.frequency_error(&[basis.fit(&x)]);
        // First order in the phase error at the ends of the block (0.038 rad).
        assert!((error - TAU * 0.2).abs() < 0.01 * TAU * 0.2, "{error}");
    }

    #[test]
    fn half_a_period_is_too_short() {
        let t: Vec<f64> = (0..100).map(|k| f64::from(k) * 1e-4).collect();
        assert!(Basis::new(&t, TAU * 50.0).is_none());
        assert!(Basis::new(&t[..2], TAU * 50.0).is_none());
        assert!(Basis::new(&[], 1.0).is_none());
    }
}
