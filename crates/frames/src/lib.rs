//! Reference frames: three-phase, stationary two-phase, and rotating two-phase quantities.
//!
//! Amplitude-invariant throughout: a balanced set of amplitude `X` is a space vector of length `X`.

#![cfg_attr(not(test), no_std)]

use num_complex::Complex32;

/// One value per phase: instantaneous V or A, or a gain or an offset per channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Abc {
    /// Phase a.
    pub a: f32,
    /// Phase b, a third of a period after a in the positive sequence.
    pub b: f32,
    /// Phase c, two thirds of a period after a in the positive sequence.
    pub c: f32,
}

/// A space vector in the stationary frame; alpha lies on phase a, beta leads it by 90 degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AlphaBeta {
    /// Component along phase a.
    pub alpha: f32,
    /// Component 90 degrees ahead of phase a.
    pub beta: f32,
}

/// A space vector in a rotating frame; q leads d by 90 degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dq {
    /// Direct component.
    pub d: f32,
    /// Quadrature component.
    pub q: f32,
}

const ONE_OVER_SQRT_3: f32 = 0.577_350_26;
const SQRT_3_OVER_2: f32 = 0.866_025_4;

impl Abc {
    /// The same value in every phase.
    #[inline]
    pub const fn splat(value: f32) -> Self {
        Abc {
            a: value,
            b: value,
            c: value,
        }
    }

    /// The three values as an array in the order a, b, c.
    #[inline]
    pub const fn to_array(self) -> [f32; 3] {
        [self.a, self.b, self.c]
    }

    /// From an array in the order a, b, c.
    #[inline]
    pub const fn from_array([a, b, c]: [f32; 3]) -> Self {
        Abc { a, b, c }
    }

    /// Combines two sets phase by phase.
    #[inline]
    pub fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Abc {
            a: f(self.a, other.a),
            b: f(self.b, other.b),
            c: f(self.c, other.c),
        }
    }

    /// Zero-sequence component `(a + b + c)/3`, the part that Clarke's transform drops.
    #[inline]
    pub fn zero(self) -> f32 {
        (self.a + self.b + self.c) / 3.0
    }

    /// Whether all three are finite numbers.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.a.is_finite() && self.b.is_finite() && self.c.is_finite()
    }
}

impl From<Abc> for AlphaBeta {
    /// Amplitude-invariant Clarke transform.
    #[inline]
    fn from(x: Abc) -> Self {
        AlphaBeta {
            alpha: (2.0 * x.a - x.b - x.c) / 3.0,
            beta: (x.b - x.c) * ONE_OVER_SQRT_3,
        }
    }
}

impl From<AlphaBeta> for Abc {
    /// Inverse Clarke transform of a set without zero sequence.
    #[inline]
    fn from(x: AlphaBeta) -> Self {
        Abc {
            a: x.alpha,
            b: -0.5 * x.alpha + SQRT_3_OVER_2 * x.beta,
            c: -0.5 * x.alpha - SQRT_3_OVER_2 * x.beta,
        }
    }
}

impl AlphaBeta {
    /// Park transform into the frame whose d axis points along `axis` (a unit vector `e^{j theta}`).
    #[inline]
    pub fn to_dq(self, axis: Complex32) -> Dq {
        let x = Complex32::new(self.alpha, self.beta) * axis.conj();
        Dq { d: x.re, q: x.im }
    }
}

impl Dq {
    /// Inverse Park transform from the frame whose d axis points along `axis` (a unit vector).
    #[inline]
    pub fn to_alpha_beta(self, axis: Complex32) -> AlphaBeta {
        let x = Complex32::new(self.d, self.q) * axis;
        AlphaBeta {
            alpha: x.re,
            beta: x.im,
        }
    }
}

/// Symmetrical components of three phase phasors (Fortescue), each as the phasor of phase a.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sequence {
    /// Positive sequence.
    pub positive: Complex32,
    /// Negative sequence.
    pub negative: Complex32,
    /// Zero sequence.
    pub zero: Complex32,
}

/// `e^{j 2 pi / 3}`.
const TURN: Complex32 = Complex32::new(-0.5, SQRT_3_OVER_2);

impl Sequence {
    /// The positive sequence alone of the phasors of phases a, b and c.
    #[inline]
    pub fn positive_of([a, b, c]: [Complex32; 3]) -> Complex32 {
        (a + TURN * b + TURN.conj() * c) / 3.0
    }

    /// Whether the phases follow each other as a, c, b: the field turns backwards.
    #[inline]
    pub fn is_backwards(phases: [Complex32; 3]) -> bool {
        let forwards = Sequence::positive_of(phases).norm_sqr();
        Sequence::positive_of(Sequence::mirrored(phases)).norm_sqr() > forwards
    }

    /// Phases b and c exchanged: a motor that runs backwards, seen in the mirror, runs forwards.
    #[inline]
    pub const fn mirrored([a, b, c]: [Complex32; 3]) -> [Complex32; 3] {
        [a, c, b]
    }

    /// Splits the phasors of phases a, b and c.
    #[inline]
    pub fn from_phases(phases: [Complex32; 3]) -> Self {
        let [a, b, c] = phases;
        Sequence {
            positive: Sequence::positive_of(phases),
            negative: (a + TURN.conj() * b + TURN * c) / 3.0,
            zero: (a + b + c) / 3.0,
        }
    }

    /// Negative over positive sequence as a complex ratio; zero when there is no positive sequence.
    ///
    /// The ratio does not depend on where the window starts, so it can be averaged over windows.
    #[inline]
    pub fn unbalance(&self) -> Complex32 {
        ratio(self.negative, self.positive)
    }

    /// Zero over positive sequence as a complex ratio; zero when there is no positive sequence.
    #[inline]
    pub fn zero_ratio(&self) -> Complex32 {
        ratio(self.zero, self.positive)
    }
}

#[inline]
fn ratio(numerator: Complex32, denominator: Complex32) -> Complex32 {
    let square = denominator.norm_sqr();
    if square > f32::MIN_POSITIVE {
        numerator * denominator.conj() / square
    } else {
        Complex32::ZERO
    }
}

/// Length of a phasor; `Complex::norm` would go through a double-precision `hypot` on the board.
#[inline]
pub fn magnitude(x: Complex32) -> f32 {
    processor::sqrtf(x.norm_sqr())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn phases(amplitude: f32, angle: f32) -> Abc {
        let third = core::f32::consts::TAU / 3.0;
        Abc {
            a: amplitude * libm::cosf(angle),
            b: amplitude * libm::cosf(angle - third),
            c: amplitude * libm::cosf(angle + third),
        }
    }

    proptest! {
        /// A balanced set keeps its amplitude and angle (the definition of amplitude invariance).
        #[test]
        fn clarke_keeps_amplitude_and_angle(amplitude in 0.1f32..1000.0, angle in -3.1f32..3.1) {
            let x = AlphaBeta::from(phases(amplitude, angle));
            let tolerance = 4.0 * f32::EPSILON * amplitude; // a handful of f32 roundings
            prop_assert!((x.alpha - amplitude * libm::cosf(angle)).abs() < tolerance);
            prop_assert!((x.beta - amplitude * libm::sinf(angle)).abs() < tolerance);
        }

        #[test]
        fn park_and_clarke_invert(a in -500f32..500.0, b in -500f32..500.0, angle in -3.1f32..3.1) {
            let axis = Complex32::new(libm::cosf(angle), libm::sinf(angle));
            let phases = Abc { a, b, c: -a - b };
            let back = Abc::from(AlphaBeta::from(phases).to_dq(axis).to_alpha_beta(axis));
            let tolerance = 16.0 * f32::EPSILON * 1000.0; // sixteen roundings of the largest value
            prop_assert!((back.a - a).abs() < tolerance && (back.b - b).abs() < tolerance);
            prop_assert!((back.c - phases.c).abs() < tolerance);
        }
    }

    #[test]
    fn a_zero_sequence_leaves_the_space_vector() {
        let shifted = phases(10.0, 0.4).zip(Abc::splat(3.0), |x, y| x + y);
        let x = AlphaBeta::from(shifted);
        assert!((x.alpha - 10.0 * libm::cosf(0.4)).abs() < 1e-5); // 10 f32 roundings of 10
        assert!((shifted.zero() - 3.0).abs() < 1e-5);
    }

    #[test]
    fn fortescue_finds_each_sequence() {
        let turn = Complex32::from_polar(1.0, core::f32::consts::TAU / 3.0);
        let (p, n, z) = (
            Complex32::new(10.0, 2.0),
            Complex32::new(0.5, -0.3),
            Complex32::new(0.1, 0.2),
        );
        let sequence = Sequence::from_phases([
            p + n + z,
            p * turn.conj() + n * turn + z,
            p * turn + n * turn.conj() + z,
        ]);
        assert!((sequence.positive - p).norm() < 1e-5); // f32 roundings of values near 10
        assert!((sequence.negative - n).norm() < 1e-5);
        assert!((sequence.zero - z).norm() < 1e-5);
        assert!((sequence.unbalance() - n / p).norm() < 1e-6);
    }

    /// Exchanging two phases exchanges positive and negative sequence and keeps the zero sequence.
    #[test]
    fn the_mirror_exchanges_the_sequences() {
        let turn = Complex32::from_polar(1.0, core::f32::consts::TAU / 3.0);
        let (x, y) = (Complex32::new(10.0, 2.0), Complex32::new(0.5, -0.3));
        let phases = [
            x + y,
            x * turn.conj() + y * turn,
            x * turn + y * turn.conj(),
        ];
        let (seen, mirrored) = (
            Sequence::from_phases(phases),
            Sequence::from_phases(Sequence::mirrored(phases)),
        );
        assert!((seen.positive - mirrored.negative).norm() < 1e-5);
        assert!((seen.negative - mirrored.positive).norm() < 1e-5);
        assert!((seen.zero - mirrored.zero).norm() < 1e-6);
        assert!(!Sequence::is_backwards(phases));
        assert!(Sequence::is_backwards(Sequence::mirrored(phases)));
    }

    #[test]
    fn ratios_are_complex_and_nothing_without_a_positive_sequence() {
        let mut sequence = Sequence {
            positive: Complex32::new(3.0, 4.0),
            negative: Complex32::new(0.5, -0.3),
            zero: Complex32::new(-0.2, 0.1),
        };
        assert!((sequence.zero_ratio() - sequence.zero / sequence.positive).norm() < 1e-6);
        sequence.positive = Complex32::ZERO;
        assert_eq!(sequence.zero_ratio(), Complex32::ZERO);
        assert_eq!(sequence.unbalance(), Complex32::ZERO);
    }

    #[test]
    fn arrays_keep_the_order_of_the_phases() {
        let abc = Abc {
            a: 1.0,
            b: 2.0,
            c: 3.0,
        };
        assert_eq!(abc.to_array(), [1.0, 2.0, 3.0]);
        assert_eq!(Abc::from_array([1.0, 2.0, 3.0]), abc);
    }

    #[test]
    fn one_bad_phase_makes_the_set_bad() {
        assert!(Abc::splat(1.0).is_finite());
        for bad in [f32::NAN, f32::INFINITY] {
            for phase in 0..3 {
                let mut values = [1.0; 3];
                values[phase] = bad;
                assert!(!Abc::from_array(values).is_finite());
            }
        }
    }

    #[test]
    fn magnitude_is_the_length() {
        assert_eq!(magnitude(Complex32::new(3.0, -4.0)), 5.0);
    }

    #[test]
    fn the_zero_sequence_is_the_mean() {
        let x = Abc {
            a: 1.0,
            b: 2.0,
            c: 5.5,
        };
        assert!((x.zero() - 8.5 / 3.0).abs() < 1e-6);
    }
}
