//! The discrete Fourier transform of complex samples: [`rustfft`] for double precision, compiled once.
//!
//! ```
//! use num_complex::Complex64;
//!
//! let turn = |k: usize| Complex64::cis(std::f64::consts::TAU * k as f64 / 4.0);
//! let mut samples: Vec<Complex64> = (0..4).map(turn).collect();
//! fourier::Transform::of(4).forward(&mut samples);
//! assert!((samples[1].re - 4.0).abs() < 1e-12 && samples[2].norm() < 1e-12);
//! ```

use num_complex::Complex64;
use rustfft::{Fft, FftPlanner};
use std::sync::Arc;

/// A planned transform of a number of samples.
#[derive(Clone)]
pub struct Transform(Arc<dyn Fft<f64>>);

impl Transform {
    /// Plans a transform of so many samples.
    pub fn of(count: usize) -> Self {
        Self(FftPlanner::new().plan_fft_forward(count))
    }

    /// Samples that it transforms at once.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Turns samples into lines: `X_k = sum_n x_n exp(-2 pi j k n / N)`, not scaled.
    ///
    /// # Panics
    /// If the number of samples is no multiple of [`count`](Self::count).
    pub fn forward(&self, samples: &mut [Complex64]) {
        self.0.process(samples);
    }
}
