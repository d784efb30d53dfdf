//! A rotating vector carried on from the samples of one side of an instant.
//!
//! Least squares of mean, cosine and sine over some samples tell the value at an instant beside them. The weights of those
//! samples depend on their distances alone; they are real, and the same on both sides.

use crate::measure::normal::{cholesky, normal, solve};
use num_complex::Complex64;

/// Share of a column beside the others that rounding leaves: a few samples of a slow supply are nearly a parabola, and told apart.
const ROUNDING: f64 = 1e-12;

/// Weights of samples at the distances `first`, `first + 1`, ... from an instant.
pub(super) struct Weights {
    first: usize,
    weights: Vec<f64>,
}

impl Weights {
    /// Of `samples` samples, the nearest `first` and a half steps away, of what turns by `angle`, rad, from one to the next.
    pub fn new(first: usize, samples: usize, angle: f64) -> Option<Weights> {
        let rows: Vec<[f64; 3]> = (first..first + samples)
            .map(|k| row(k as f64 + 0.5, angle, (first + samples) as f64))
            .collect();
        // At the instant itself the columns are 1, 0, 0.
        let at = solve(&cholesky(normal(&rows), ROUNDING)?, [1.0, 0.0, 0.0]);
        let dot = |row: &[f64; 3]| row.iter().zip(&at).map(|(x, y)| x * y).sum();
        Some(Weights {
            first,
            weights: rows.iter().map(dot).collect(),
        })
    }

    /// Samples on one side that are used or passed over.
    pub fn reach(&self) -> usize {
        self.first + self.weights.len()
    }

    /// What the samples before and from sample `at` on say of the instant between `at - 1` and `at`; both sides reach as far as
    /// [`Weights::reach`].
    pub fn both(&self, z: &[Complex64], at: usize) -> [Complex64; 2] {
        let before = z[at - self.reach()..at - self.first].iter().rev();
        let behind = z[at + self.first..at + self.reach()].iter();
        [
            before.zip(&self.weights).map(|(z, w)| z * w).sum(),
            behind.zip(&self.weights).map(|(z, w)| z * w).sum(),
        ]
    }
}

/// Mean, `1 - cos` and `sin`, each over its size at the far end.
fn row(distance: f64, angle: f64, far: f64) -> [f64; 3] {
    let (sin, far_sin) = ((angle * distance).sin(), (angle * far).min(1.5).sin());
    let versed = |x: f64| 1.0 - x.cos();
    [
        1.0,
        versed(angle * distance) / versed((angle * far).min(1.5)),
        sin / far_sin,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both senses of rotation and a mean are carried on exactly, next to the instant and some samples away from it.
    #[test]
    fn a_rotating_vector_is_carried_on() {
        let at = |x: f64| {
            Complex64::cis(x) + Complex64::from_polar(0.2, 0.4 - x) + Complex64::new(0.1, -0.3)
        };
        for (angle, samples, first) in [(0.02, 30, 0), (0.06, 4, 0), (0.6, 5, 2), (0.3, 8, 2)] {
            let z: Vec<Complex64> = (0..100).map(|k| at(angle * f64::from(k))).collect();
            let weights = Weights::new(first, samples, angle).expect("weights");
            let [before, behind] = weights.both(&z, 50);
            let truth = at(angle * 49.5);
            assert!((before - truth).norm() < 1e-6, "{angle} {before} {truth}");
            assert!((behind - truth).norm() < 1e-6, "{angle} {behind} {truth}");
        }
    }
}
