//! What else turns six channels into phasors: the yardsticks beside which the core is timed.
//!
//! Both know the supply's frequency beforehand and do nothing but phasors: no angle tracking, no encoder, no
//! calibration, no clipping, no verdict. The core does all of these, so it may cost more; how much more is the figure.

use crate::signals::CYCLE_SAMPLES;
use monitor::{CHANNELS, Sample};
use nalgebra::{Matrix3, SMatrix, Vector3};
use num_complex::Complex32;
use std::f32::consts::TAU;

/// Values of the six channels, 0 where one is missing.
pub fn channels(sample: &Sample) -> [f32; CHANNELS] {
    let u = sample.u_s_abc.unwrap_or_default();
    let i = sample.i_s_abc.unwrap_or_default();
    [u.a, u.b, u.c, i.a, i.b, i.c]
}

/// The textbook sliding DFT, fundamental bin of one cycle (Jacobsen and Lyons, "The sliding DFT", IEEE Signal
/// Processing Magazine 20(2), 2003, doi:10.1109/MSP.2003.1184347): two additions and a rotation per channel and sample.
#[derive(Clone, Debug)]
pub struct SlidingDft {
    buffer: [[f32; CHANNELS]; CYCLE_SAMPLES],
    next: usize,
    bins: [Complex32; CHANNELS],
    twiddle: Complex32,
}

impl Default for SlidingDft {
    fn default() -> Self {
        SlidingDft {
            buffer: [[0.0; CHANNELS]; CYCLE_SAMPLES],
            next: 0,
            bins: [Complex32::ZERO; CHANNELS],
            twiddle: Complex32::from_polar(1.0, TAU / CYCLE_SAMPLES as f32),
        }
    }
}

impl SlidingDft {
    /// Adds one instant.
    pub fn update(&mut self, x: &[f32; CHANNELS]) {
        let oldest = &mut self.buffer[self.next];
        for ((bin, x), old) in self.bins.iter_mut().zip(x).zip(oldest.iter()) {
            *bin = (*bin + (x - old)) * self.twiddle;
        }
        *oldest = *x;
        self.next = if self.next + 1 == CYCLE_SAMPLES {
            0
        } else {
            self.next + 1
        };
    }

    /// Phasors of the latest cycle, peak values.
    pub fn phasors(&self) -> [Complex32; CHANNELS] {
        self.bins.map(|bin| bin * (2.0 / CYCLE_SAMPLES as f32))
    }
}

/// The core's own method written with a matrix library: normal equations of offset, cosine and sine, solved by
/// Cholesky once per cycle.
#[derive(Clone, Debug)]
pub struct NalgebraLeastSquares {
    axis: Complex32,
    twiddle: Complex32,
    samples: usize,
    gram: Matrix3<f32>,
    moments: SMatrix<f32, 3, CHANNELS>,
    solution: SMatrix<f32, 3, CHANNELS>,
}

impl Default for NalgebraLeastSquares {
    fn default() -> Self {
        NalgebraLeastSquares {
            axis: Complex32::ONE,
            twiddle: Complex32::from_polar(1.0, TAU / CYCLE_SAMPLES as f32),
            samples: 0,
            gram: Matrix3::zeros(),
            moments: SMatrix::zeros(),
            solution: SMatrix::zeros(),
        }
    }
}

impl NalgebraLeastSquares {
    /// Adds one instant.
    pub fn update(&mut self, x: &[f32; CHANNELS]) {
        let basis = Vector3::new(1.0, self.axis.re, self.axis.im);
        let values = SMatrix::<f32, 1, CHANNELS>::from_row_slice(x);
        self.gram += basis * basis.transpose();
        self.moments += basis * values;
        self.axis *= self.twiddle;
        self.samples += 1;
        if self.samples == CYCLE_SAMPLES {
            self.close();
        }
    }

    fn close(&mut self) {
        if let Some(cholesky) = self.gram.cholesky() {
            self.solution = cholesky.solve(&self.moments);
        }
        *self = NalgebraLeastSquares {
            solution: self.solution,
            ..NalgebraLeastSquares::default()
        };
    }

    /// Phasors of the latest complete cycle, peak values.
    pub fn phasors(&self) -> [Complex32; CHANNELS] {
        std::array::from_fn(|k| Complex32::new(self.solution[(1, k)], -self.solution[(2, k)]))
    }
}
