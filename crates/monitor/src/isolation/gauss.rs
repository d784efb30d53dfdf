//! A small covariance matrix: its Cholesky factor, and vectors seen in units of their uncertainty.

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
    pub fn add(&mut self, direction: &[f32; N], deviation: f32) {
        let scaled = direction.map(|x| x * deviation);
        for (i, (row, a)) in self.lower.iter_mut().zip(&scaled).enumerate() {
            for (c, b) in row.iter_mut().zip(scaled.iter().take(i + 1)) {
                *c += a * b;
            }
        }
    }

    /// Factorises; a row without any uncertainty of its own gets the smallest one that single precision carries.
    pub fn factorise(self) -> Cholesky<N> {
        let mut lower = self.lower;
        for i in 0..N {
            let (done, rest) = lower.split_at_mut(i);
            let Some(row) = rest.first_mut() else { break };
            factorise_row(done, row);
        }
        Cholesky { lower }
    }
}

/// Row `i = done.len()` of the factor, in place: Cholesky-Banachiewicz.
fn factorise_row<const N: usize>(done: &[[f32; N]], row: &mut [f32; N]) {
    let i = done.len();
    for (j, above) in done.iter().enumerate() {
        let (known, open) = row.split_at_mut(j);
        let (Some(x), Some(pivot)) = (open.first_mut(), above.get(j)) else {
            return;
        };
        *x = (*x - dot(known, above)) / pivot;
    }
    let (known, open) = row.split_at_mut(i);
    if let Some(x) = open.first_mut() {
        let square = dot(known, known);
        let least = LEAST_SHARE * (*x + square) + f32::MIN_POSITIVE;
        *x = libm::sqrtf((*x - square).max(least));
    }
}

/// Rounding leaves about this share of a variance that other rows explain completely.
const LEAST_SHARE: f32 = 1e-6;

impl<const N: usize> Cholesky<N> {
    /// `L^-1 x`: white if `x` has this covariance.
    pub fn whiten(&self, x: &[f32; N]) -> [f32; N] {
        let mut white = *x;
        for (i, row) in self.lower.iter().enumerate() {
            let (known, open) = white.split_at_mut(i);
            if let (Some(x), Some(pivot)) = (open.first_mut(), row.get(i)) {
                *x = (*x - dot(known, row)) / pivot;
            }
        }
        white
    }
}

/// Scalar product over the shorter length.
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
