//! Supplies as functions of time.

use num_complex::Complex64;

/// Space vector of three phase quantities (amplitude-invariant Clarke transform).
#[inline]
pub fn clarke(abc: [f64; 3]) -> Complex64 {
    let [a, b, c] = abc;
    Complex64::new((2.0 * a - b - c) / 3.0, (b - c) / 3f64.sqrt())
}

/// Phase quantities of a space vector without zero sequence.
#[inline]
pub fn phases(x: Complex64) -> [f64; 3] {
    let half_root_3 = 0.5 * 3f64.sqrt();
    [
        x.re,
        -0.5 * x.re + half_root_3 * x.im,
        -0.5 * x.re - half_root_3 * x.im,
    ]
}

/// One rotating component of a supply: order +1 is the positive, -1 the negative sequence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonic {
    /// Order and direction of rotation relative to the fundamental (+1, -1, -5, +7 ...).
    pub order: f64,
    /// Complex amplitude at t = 0, V peak phase value.
    pub amplitude: Complex64,
}

/// A stationary supply in closed form: the sum of rotating components.
#[derive(Clone, Debug, PartialEq)]
pub struct Sinusoidal {
    /// Fundamental angular frequency, rad/s.
    pub omega_sync: f64,
    /// The components.
    pub components: Vec<Harmonic>,
}

impl Sinusoidal {
    /// A balanced supply of peak phase voltage `amplitude` (V); phase a is at its crest at t = 0.
    pub fn balanced(omega_sync: f64, amplitude: f64) -> Self {
        let amplitude = Complex64::new(amplitude, 0.0);
        Self {
            omega_sync,
            components: vec![Harmonic {
                order: 1.0,
                amplitude,
            }],
        }
    }

    /// Voltage vector at time `t` (s), V.
    #[inline]
    pub fn at(&self, t: f64) -> Complex64 {
        let phase = self.omega_sync * t;
        let turned = |c: &Harmonic| c.amplitude * Complex64::from_polar(1.0, c.order * phase);
        self.components.iter().map(turned).sum()
    }
}

/// Equally spaced voltage samples, joined by straight lines; held beyond both ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Interpolated {
    /// Time of the first sample, s.
    pub t_start: f64,
    /// Sampling time, s, > 0.
    pub t_sample: f64,
    /// Samples, V; at least one.
    pub samples: Vec<Complex64>,
}

impl Interpolated {
    /// Voltage vector at time `t` (s), V.
    #[inline]
    pub fn at(&self, t: f64) -> Complex64 {
        let last = self.samples.len() - 1;
        let x = ((t - self.t_start) / self.t_sample).clamp(0.0, last as f64);
        let k = (x as usize).min(last.saturating_sub(1));
        let next = self.samples[(k + 1).min(last)];
        self.samples[k] + (next - self.samples[k]) * (x - k as f64)
    }
}
