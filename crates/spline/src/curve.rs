//! Whole curves: second derivatives at the knots, and the curve between them.

use super::piece;
use core::f64::consts::TAU;

/// Second derivatives of the cubic spline through `(x, y)`; `x` ascends and has at least three knots. The first two and the last
/// two pieces are one cubic each (not-a-knot; de Boor, A Practical Guide to Splines, chapter IV), so that a curve that
/// bends at its ends is met there too.
///
/// # Panics
/// With fewer than three knots, or fewer values than knots.
#[must_use]
pub fn bends(x: &[f64], y: &[f64]) -> Vec<f64> {
    let n = x.len();
    let width = |k: usize| x[k + 1] - x[k];
    let slope = |k: usize| (y[k + 1] - y[k]) / width(k);
    let bend = |k: usize| 6.0 * (slope(k) - slope(k - 1));
    if n == 3 {
        return vec![bend(1) / (3.0 * (x[2] - x[0])); 3];
    }
    let (first, last) = (width(0) / width(1), width(n - 2) / width(n - 3));
    let (mut upper, mut second) = (vec![0.0; n], vec![0.0; n]);
    for k in 1..n - 1 {
        let (mut lower, mut pivot, mut above) =
            (width(k - 1), 2.0 * (width(k - 1) + width(k)), width(k));
        if k == 1 {
            pivot += lower * (1.0 + first);
            above -= lower * first;
            lower = 0.0;
        }
        if k == n - 2 {
            pivot += above * (1.0 + last);
            lower -= above * last;
            above = 0.0;
        }
        let pivot = pivot - lower * upper[k - 1];
        upper[k] = above / pivot;
        second[k] = (bend(k) - lower * second[k - 1]) / pivot;
    }
    for k in (1..n - 2).rev() {
        second[k] -= upper[k] * second[k + 1];
    }
    second[0] = (1.0 + first) * second[1] - first * second[2];
    second[n - 1] = (1.0 + last) * second[n - 2] - last * second[n - 3];
    second
}

/// A curve that can be evaluated.
#[derive(Clone, Debug)]
pub struct Spline {
    x: Vec<f64>,
    y: Vec<f64>,
    second: Vec<f64>,
}

/// Knots that a periodic curve repeats beyond each end, so that the free ends of the spline have died away: a bend at the
/// end falls by 3.7 from knot to knot.
const OVERLAP: usize = 12;

impl Spline {
    /// Through knots that ascend; beyond them the curve stays.
    #[must_use]
    pub fn open(x: &[f64], y: &[f64]) -> Self {
        Self {
            second: bends(x, y),
            x: x.to_vec(),
            y: y.to_vec(),
        }
    }

    /// Through knots within one turn (rad), repeating.
    #[must_use]
    pub fn periodic(x: &[f64], y: &[f64]) -> Self {
        let n = x.len() as i64;
        let overlap = OVERLAP as i64;
        let at = |k: i64| {
            let turn = k.div_euclid(n);
            let knot = k.rem_euclid(n) as usize;
            (x[knot] + TAU * turn as f64, y[knot])
        };
        let (x, y): (Vec<f64>, Vec<f64>) = (-overlap..n + overlap).map(at).unzip();
        Self::open(&x, &y)
    }

    /// Value at `x`.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        let last = self.x.len() - 1;
        let x = x.clamp(self.x[0], self.x[last]);
        let k = self.x.partition_point(|&knot| knot <= x).clamp(1, last);
        piece(
            [self.x[k - 1], self.x[k]],
            [self.y[k - 1], self.y[k]],
            [self.second[k - 1], self.second[k]],
            x,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight line bends nowhere, whatever the knots.
    #[test]
    fn a_line_is_a_line() {
        let x = [0.0, 1.0, 2.5, 3.0, 7.0];
        let spline = Spline::open(&x, &x.map(|x| 2.0 - 3.0 * x));
        for x in [0.0, 0.3, 1.7, 2.9, 6.5, 7.0] {
            assert!((spline.at(x) - (2.0 - 3.0 * x)).abs() < 1e-12);
        }
        assert_eq!(spline.at(-4.0), 2.0);
        assert_eq!(spline.at(9.0), -19.0);
    }

    /// A cubic is its own spline, on knots at any distance.
    #[test]
    fn a_cubic_is_met_exactly() {
        let cubic = |x: f64| 1.0 - 2.0 * x + 0.5 * x * x - 0.3 * x.powi(3);
        for x in [&[0.0, 0.4, 1.0, 2.5][..], &[-3.0, -1.0, 0.0, 0.2, 4.0, 5.0]] {
            let y: Vec<f64> = x.iter().map(|x| cubic(*x)).collect();
            let spline = Spline::open(x, &y);
            for k in 0..=50 {
                let at = x[0] + (x[x.len() - 1] - x[0]) * f64::from(k) / 50.0;
                assert!((spline.at(at) - cubic(at)).abs() < 1e-9, "{at}");
            }
        }
        let parabola = Spline::open(&[0.0, 1.0, 3.0], &[0.0, 1.0, 9.0]);
        assert!((parabola.at(2.0) - 4.0).abs() < 1e-12);
    }

    /// Error of cubic interpolation: 5/384 h^4 times the fourth derivative, away from the free ends.
    #[test]
    fn a_sine_is_met_to_the_fourth_order() {
        let knots: Vec<f64> = (0..36).map(|k| TAU * f64::from(k) / 36.0).collect();
        let values: Vec<f64> = knots.iter().map(|x| (3.0 * x).sin()).collect();
        let spline = Spline::periodic(&knots, &values);
        let bound = 5.0 / 384.0 * (TAU / 36.0).powi(4) * 81.0;
        for k in 0..1000 {
            let x = TAU * f64::from(k) / 1000.0;
            assert!((spline.at(x) - (3.0 * x).sin()).abs() < 1.2 * bound, "{x}");
        }
    }
}
