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
