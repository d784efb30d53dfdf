//! Samples of one axis or of two.

use num_complex::Complex64;
use std::fmt::Debug;
use std::ops::{Add, Mul, Sub};

/// A sample of a series: a real number or a vector of two axes.
pub trait Sample:
    Copy + Debug + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self>
{
    /// Axes, each with noise of its own.
    const AXES: usize;
    /// The sample without a value.
    const ZERO: Self;

    /// Sum of the squares of its axes.
    fn square(self) -> f64;
}

impl Sample for f64 {
    const AXES: usize = 1;
    const ZERO: Self = 0.0;

    fn square(self) -> f64 {
        self * self
    }
}

impl Sample for Complex64 {
    const AXES: usize = 2;
    const ZERO: Self = Complex64::ZERO;

    fn square(self) -> f64 {
        self.norm_sqr()
    }
}

/// Adds a series behind another one, without room for more: a long recording's room may be more than fits.
pub fn append<T: Copy>(series: &mut Vec<T>, behind: &[T]) {
    series.reserve_exact(behind.len());
    series.extend_from_slice(behind);
}
