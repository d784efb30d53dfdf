//! A small covariance matrix: its Cholesky factor, and vectors seen in units of their uncertainty.
//!
//! ```
//! use covariance::{Covariance, dot};
//!
//! // Two independent errors of 1 and 2, and one of 3 that moves both alike.
//! let mut errors = Covariance::of_independent(&[1.0, 2.0]);
//! errors.add(&[1.0, 1.0], 3.0);
//! let white = errors.factorise().whiten(&[3.0, 3.0]);
//! // Along what they have in common a departure of 3 is less than one standard deviation.
//! assert!(dot(&white, &white) < 1.0);
//! ```

#![no_std]

/// Lower Cholesky factor `L` of a covariance `C = L L'`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cholesky<const N: usize> {
    lower: [[f32; N]; N],
}

/// A covariance that is summed up from independent contributions; only the lower half is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Covariance<const N: usize> {
    lower: [[f32; N]; N],
}

impl<const N: usize> Covariance<N> {
    /// Independent rows with these standard deviations.
    pub fn of_independent(deviations: &[f32; N]) -> Self {
        let mut lower = [[0.0; N]; N];
        for (i, (row, s)) in lower.iter_mut().zip(deviations).enumerate() {
            if let Some(diagonal) = row.get_mut(i) {
                *diagonal = s * s;
            }
        }
        Covariance { lower }
    }

    /// Adds what one uncertain quantity contributes: its effect on each row, times its standard deviation.
    #[inline(never)]
    pub fn add(&mut self, direction: &[f32; N], deviation: f32) {
        let scaled = direction.map(|x| x * deviation);
        for (i, (row, a)) in self.lower.iter_mut().zip(&scaled).enumerate() {
            // Most quantities move few rows.
            if *a != 0.0 {
                let before = scaled.get(..=i).unwrap_or_default();
                for (c, b) in row.iter_mut().zip(before) {
                    *c += a * b;
                }
            }
        }
    }

    /// Factorises, row by row (Cholesky and Banachiewicz). Rounding may leave a row without uncertainty of its own: it
    /// keeps the smallest one that single precision carries.
    #[inline(never)]
    pub fn factorise(self) -> Cholesky<N> {
        let mut lower = [[0.0; N]; N];
        for (i, variances) in self.lower.iter().enumerate() {
            let row = factor_row(&lower, i, variances);
            if let Some(place) = lower.get_mut(i) {
                *place = row;
            }
        }
        Cholesky { lower }
    }
}

/// Row `i` of the factor from those before it.
#[inline(never)]
fn factor_row<const N: usize>(lower: &[[f32; N]; N], i: usize, variances: &[f32; N]) -> [f32; N] {
    let mut row = [0.0; N];
    for (j, (above, c)) in lower.iter().zip(variances).enumerate().take(i) {
        let x = (c - dot_of(j, &row, above)) / entry(above, j);
        set(&mut row, j, x);
    }
    let variance = entry(variances, i);
    let least = LEAST_SHARE * variance + f32::MIN_POSITIVE;
    let own = (variance - dot(&row, &row)).max(least);
    set(&mut row, i, processor::sqrtf(own));
    row
}

fn entry<const N: usize>(row: &[f32; N], k: usize) -> f32 {
    row.get(k).copied().unwrap_or(1.0)
}

fn set<const N: usize>(row: &mut [f32; N], k: usize, x: f32) {
    if let Some(place) = row.get_mut(k) {
        *place = x;
    }
}

/// Rounding leaves about this share of a variance that other rows explain completely.
const LEAST_SHARE: f32 = 1e-6;

impl<const N: usize> Cholesky<N> {
    /// Standard deviation of each row, given the rows before it.
    pub fn deviations(&self) -> impl Iterator<Item = f32> {
        let rows = self.lower.iter().enumerate();
        rows.map(|(i, row)| entry(row, i))
    }

    /// Variance of each row.
    pub fn variances(&self) -> impl Iterator<Item = f32> {
        self.lower.iter().map(|row| dot(row, row))
    }

    /// `L^-1 x`: white if `x` has this covariance.
    #[inline(never)]
    pub fn whiten(&self, x: &[f32; N]) -> [f32; N] {
        let mut white = [0.0; N];
        for (i, (row, x)) in self.lower.iter().zip(x).enumerate() {
            let known = dot_of(i, row, &white);
            set(&mut white, i, (x - known) / entry(row, i));
        }
        white
    }
}

/// Scalar product of the first `k` entries.
#[inline]
fn dot_of<const N: usize>(k: usize, a: &[f32; N], b: &[f32; N]) -> f32 {
    dot(a.get(..k).unwrap_or_default(), b)
}

/// Scalar product over as many entries as the shorter one has.
#[inline]
pub fn dot(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix4, Vector4};
    use proptest::prelude::*;

    proptest! {
        /// Against nalgebra in double precision. Tolerance: the condition number stays below 1e3 by
        /// construction, so twelve f32 roundings lose at most 1e-3 of the length.
        #[test]
        fn whitened_length_is_the_mahalanobis_distance(
            deviations in prop::array::uniform4(0.5f32..2.0),
            a in prop::array::uniform4(-2f32..2.0),
            b in prop::array::uniform4(-2f32..2.0),
            x in prop::array::uniform4(-5f32..5.0),
        ) {
            let mut c = Covariance::of_independent(&deviations);
            c.add(&a, 1.5);
            c.add(&b, 0.7);
            let white = c.factorise().whiten(&x);
            let wide = |v: [f32; 4]| Vector4::from(v.map(f64::from));
            let (a, b, x) = (wide(a), wide(b), wide(x));
            let full = Matrix4::from_diagonal(&wide(deviations).map(|s| s * s))
                + a * a.transpose() * 1.5f64.powi(2)
                + b * b.transpose() * f64::from(0.7f32).powi(2);
            let expected = x.dot(&full.try_inverse().expect("positive definite").mul_vec(x));
            let got = f64::from(dot(&white, &white));
            prop_assert!((got - expected).abs() < 1e-3 * (1.0 + expected), "{got} {expected}");
        }
    }

    trait MulVec {
        fn mul_vec(&self, x: Vector4<f64>) -> Vector4<f64>;
    }

    impl MulVec for Matrix4<f64> {
        fn mul_vec(&self, x: Vector4<f64>) -> Vector4<f64> {
            self * x
        }
    }

    #[test]
    fn a_row_that_others_explain_completely_stays_finite() {
        let mut c = Covariance::of_independent(&[0.0, 0.0, 0.0]);
        c.add(&[1.0, 2.0, 3.0], 1.0);
        assert!(
            c.factorise()
                .whiten(&[1.0, 2.0, 3.0])
                .iter()
                .all(|x| x.is_finite())
        );
    }
}
