//! Symmetrical components of three phasors.

use num_complex::Complex64;
use std::f64::consts::TAU;

/// The operator `a`: a turn by 120 degrees.
pub(crate) fn a() -> Complex64 {
    Complex64::cis(TAU / 3.0)
}

/// Counter over main sequence below which the order of the phases is certain: one phase lost leaves 0.3 to 1.
const CLEAR: f64 = 0.5;

/// Zero, positive and negative sequence, amplitude-invariant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sequence {
    pub zero: Complex64,
    pub positive: Complex64,
    pub negative: Complex64,
}

impl Sequence {
    /// The components of three phase phasors.
    pub fn of([xa, xb, xc]: [Complex64; 3]) -> Sequence {
        let (a1, a2) = (a(), a().conj());
        Sequence {
            zero: (xa + xb + xc) / 3.0,
            positive: (xa + a1 * xb + a2 * xc) / 3.0,
            negative: (xa + a2 * xb + a1 * xc) / 3.0,
        }
    }

    /// Whether the phases follow each other as a, b, c.
    pub fn is_positive(&self) -> bool {
        self.positive.norm() >= self.negative.norm()
    }

    /// The same, where one sequence certainly dominates: with an open phase both are alike, and neither order is meant.
    pub fn clear_order(&self) -> Option<bool> {
        let clear = self.counter().norm() < CLEAR * self.main().norm();
        clear.then(|| self.is_positive())
    }

    /// The greater one of positive and negative sequence.
    pub fn main(&self) -> Complex64 {
        if self.is_positive() {
            self.positive
        } else {
            self.negative
        }
    }

    /// The smaller one of positive and negative sequence.
    pub fn counter(&self) -> Complex64 {
        if self.is_positive() {
            self.negative
        } else {
            self.positive
        }
    }

    /// What a balanced set does not have, relative to what it has.
    pub fn imbalance(&self) -> f64 {
        (self.counter().norm() + self.zero.norm()) / self.main().norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_balanced_set_has_one_sequence() {
        let x = Complex64::from_polar(325.0, 0.4);
        let abc = Sequence::of([x, x * a().conj(), x * a()]);
        assert!((abc.positive - x).norm() < 1e-12 * 325.0);
        assert!(abc.imbalance() < 1e-12 && abc.is_positive());
        let acb = Sequence::of([x, x * a(), x * a().conj()]);
        assert!((acb.negative - x).norm() < 1e-12 * 325.0 && !acb.is_positive());
    }

    /// Two phases in series between two lines, the third open: both sequences are alike.
    #[test]
    fn an_open_phase_has_no_order() {
        let x = Complex64::from_polar(5.0, 0.4);
        let open = Sequence::of([x, Complex64::new(0.0, 0.0), -x]);
        assert_eq!(open.clear_order(), None);
        let balanced = Sequence::of([x, x * a(), x * a().conj()]);
        assert_eq!(balanced.clear_order(), Some(false));
    }

    /// One inverted channel: V1 = 1/3, V2 = V0 = 2/3 of the amplitude.
    #[test]
    fn an_inverted_channel_turns_the_order() {
        let x = Complex64::new(1.0, 0.0);
        let set = Sequence::of([x, x * a().conj(), -x * a()]);
        assert!((set.positive.norm() - 1.0 / 3.0).abs() < 1e-12);
        assert!((set.negative.norm() - 2.0 / 3.0).abs() < 1e-12);
        assert!((set.zero.norm() - 2.0 / 3.0).abs() < 1e-12);
    }
}
