//! Rotor flux by the current model, and what the voltage leaves unexplained of the stator flux, sample by sample.
//!
//! In coordinates of the rotor the flux needs no speed, only the shaft's angle:
//!
//! ```text
//! x' = -(R_r/L_r) x + (R_r L_m/L_r) y        y = i e*     psi_r = x e
//! d_k = T/2 (u_k + u_(k-1)) - R_s T/2 (i_k + i_(k-1)) - (lambda_k - lambda_(k-1))      lambda = L_a i + k_r psi_r
//! ```
//!
//! `d` is the stator's equation integrated over one sampling time: no derivative is taken, neither of a current nor of a flux.

use num_complex::Complex32;

use crate::circuit::Coefficients;
use monitor::{Abc, AlphaBeta, renormalise, small_rotation};

/// One instant as the observer takes it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instant {
    /// Phase voltages, V.
    pub u: Abc,
    /// Phase currents, A.
    pub i: Abc,
    /// How far the rotor turned since the instant before, electrical rad.
    pub turned: f32,
    /// Measured torque of the load, N m.
    pub tau_load: f32,
    /// Axis of the supply's oscillator, of length 1.
    pub axis: Complex32,
}

/// What is kept from one instant to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer {
    /// Axis of the rotor `e`.
    pub rotor: Complex32,
    /// Rotor flux in coordinates of the rotor, V s.
    pub flux: Complex32,
    /// Stator flux, V s.
    pub linkage: Complex32,
    y: Complex32,
    y_mirrored: Complex32,
    u: Complex32,
    i: Complex32,
    axis: Complex32,
    before: Option<Abc2>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Abc2 {
    u: Abc,
    i: Abc,
}

/// What one sampling interval says; means of its two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// `d_k`, V s.
    pub unexplained: Complex32,
    /// Weight `e^{-j theta}` in the middle of the interval.
    pub weight: Complex32,
    /// Voltages a, b, c, then currents a, b, c.
    pub channels: [f32; 6],
    /// Current at the interval's end, A.
    pub i: Complex32,
    /// Voltage at the interval's end, V.
    pub u: Complex32,
    /// Rotor flux at the interval's end, V s.
    pub psi_r: Complex32,
    /// Means of flux and current in coordinates of the rotor.
    pub x: Complex32,
    /// See `x`.
    pub y: Complex32,
    /// The same of the current's mirror image `conj(i)`, which splits it into its channels.
    pub y_mirrored: Complex32,
}

impl Default for Observer {
    fn default() -> Self {
        Observer {
            rotor: Complex32::ONE,
            flux: Complex32::ZERO,
            linkage: Complex32::ZERO,
            y: Complex32::ZERO,
            y_mirrored: Complex32::ZERO,
            u: Complex32::ZERO,
            i: Complex32::ZERO,
            axis: Complex32::ONE,
            before: None,
        }
    }
}

/// The space vector.
pub fn vector(x: Abc) -> Complex32 {
    let AlphaBeta { alpha, beta } = x.into();
    Complex32::new(alpha, beta)
}

impl Observer {
    /// Takes one instant; `None` for the first, which ends no interval.
    #[inline]
    pub fn step(&mut self, c: &Coefficients, t_sample: f32, now: &Instant) -> Option<Interval> {
        self.rotor *= small_rotation(now.turned);
        let (u, i) = (vector(now.u), vector(now.i));
        let back = self.rotor.conj();
        let (y, y_mirrored) = (i * back, i.conj() * back);
        let Some(before) = self.before.replace(Abc2 { u: now.u, i: now.i }) else {
            self.start(c, now, [u, i], [y, y_mirrored]);
            return None;
        };
        let x = self.flux;
        let gain = (1.0 - c.keep) * c.l_m * 0.5;
        self.flux = x * c.keep + (y + self.y) * gain;
        let psi_r = self.flux * self.rotor;
        let linkage = c.linkage(psi_r, i);
        let applied = (u + self.u - (i + self.i) * c.r_s) * (0.5 * t_sample);
        let interval = Interval {
            unexplained: applied - (linkage - self.linkage),
            weight: ((now.axis + self.axis) * 0.5).conj(),
            channels: means(&before, now),
            i,
            u,
            psi_r,
            x: (x + self.flux) * 0.5,
            y: (y + self.y) * 0.5,
            y_mirrored: (y_mirrored + self.y_mirrored) * 0.5,
        };
        self.note([u, i, y, y_mirrored, linkage], now.axis);
        Some(interval)
    }

    fn start(
        &mut self,
        c: &Coefficients,
        now: &Instant,
        [u, i]: [Complex32; 2],
        y: [Complex32; 2],
    ) {
        let linkage = c.linkage(self.flux * self.rotor, i);
        self.note([u, i, y[0], y[1], linkage], now.axis);
    }

    fn note(&mut self, [u, i, y, y_mirrored, linkage]: [Complex32; 5], axis: Complex32) {
        (self.u, self.i, self.axis) = (u, i, axis);
        (self.y, self.y_mirrored, self.linkage) = (y, y_mirrored, linkage);
    }

    /// After a change of coefficients or flux: the stator flux that goes with the present ones.
    pub fn adopt(&mut self, c: &Coefficients) {
        self.linkage = c.linkage(self.flux * self.rotor, self.i);
    }

    /// Brings the rotor's axis back to unit length.
    pub fn renormalise(&mut self) {
        renormalise(&mut self.rotor);
    }

    /// Flux of the magnetizing branch, V s.
    pub fn air_gap(&self, c: &Coefficients) -> f32 {
        c.air_gap(self.flux * self.rotor, self.i)
    }

    /// Axis of the supply at the latest instant.
    pub fn supply(&self) -> Complex32 {
        self.axis
    }
}

fn means(before: &Abc2, now: &Instant) -> [f32; 6] {
    let mean = |x: Abc, y: Abc| x.zip(y, |x, y| 0.5 * (x + y)).to_array();
    let ([a, b, c], [d, e, f]) = (mean(before.u, now.u), mean(before.i, now.i));
    [a, b, c, d, e, f]
}
