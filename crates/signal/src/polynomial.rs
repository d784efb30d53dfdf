//! Local quadratic smoothing (Savitzky-Golay) that respects the ends of a segment.

use crate::dot::dots;
use nalgebra::{Matrix3, Vector3};
use num_complex::Complex64;

/// Points per window at which a smoothed signal is evaluated.
const KNOTS: usize = 24;

/// Weights of a least-squares quadratic over `window` points that give its value and its slope (per sample) at
/// the position `at`, counted from the window's first point.
fn weights(window: usize, at: f64) -> (Vec<f64>, Vec<f64>) {
    let scale = 1.0 / window as f64;
    let basis = |k: f64| {
        let x = (k - at) * scale;
        Vector3::new(1.0, x, x * x)
    };
    let sum = |m: Matrix3<f64>, k: usize| m + basis(k as f64) * basis(k as f64).transpose();
    let normal = (0..window).fold(Matrix3::zeros(), sum);
    let inverse = normal.try_inverse().unwrap_or_else(Matrix3::identity);
    let row = |r: usize| inverse.row(r).transpose();
    let (value, slope) = (row(0), row(1) * scale);
    let dot = |v: &Vector3<f64>| (0..window).map(|k| v.dot(&basis(k as f64))).collect();
    (dot(&value), dot(&slope))
}

fn apply(w: &[f64], re: &[f64], im: &[f64]) -> Complex64 {
    let [re, im] = dots(w, [re, im]);
    Complex64::new(re, im)
}

/// Value and slope (per sample) of a signal.
#[derive(Clone, Debug, Default)]
pub struct Smoothed {
    /// Smoothed signal.
    pub value: Vec<Complex64>,
    /// Its slope per sample.
    pub slope: Vec<Complex64>,
}

/// How far the smoothing of a point looks, and how often it is evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    /// Points of a window.
    pub window: usize,
    /// Points from one evaluation to the next.
    pub stride: usize,
}

/// The reach of windows of about `window` points over `n` points; `None` where there is nothing to smooth.
pub fn reach(n: usize, window: usize) -> Option<Reach> {
    let window = (window | 1).min(n);
    let stride = (window / KNOTS).max(1);
    (window >= 5).then_some(Reach { window, stride })
}

/// Smooths one segment with windows of about `window` points; nearer to an end the last full window counts. Points that
/// are not `needed` may be left at zero.
pub fn smooth_where(x: &[Complex64], window: usize, needed: impl Fn(usize) -> bool) -> Smoothed {
    let Some(Reach { window, stride }) = reach(x.len(), window) else {
        return Smoothed {
            value: x.to_vec(),
            slope: vec![Complex64::ZERO; x.len()],
        };
    };
    let (re, im): (Vec<f64>, Vec<f64>) = x.iter().map(|x| (x.re, x.im)).unzip();
    let half = window / 2;
    let centre = weights(window, half as f64);
    let at = |k: usize| {
        let first = k.saturating_sub(half).min(x.len() - window);
        let part = first..first + window;
        let (re, im) = (&re[part.clone()], &im[part]);
        let apply =
            |(value, slope): &(Vec<f64>, Vec<f64>)| (apply(value, re, im), apply(slope, re, im));
        if k - first == half {
            apply(&centre)
        } else {
            apply(&weights(window, (k - first) as f64))
        }
    };
    joined(x.len(), stride, needed, at)
}

/// Evaluates `at` on every `stride`-th sample and joins by straight lines: what a window has smoothed hardly
/// bends within a small part of it. Where no point is needed nothing is evaluated.
fn joined(
    n: usize,
    stride: usize,
    needed: impl Fn(usize) -> bool,
    at: impl Fn(usize) -> (Complex64, Complex64),
) -> Smoothed {
    let mut out = Smoothed {
        value: vec![Complex64::ZERO; n],
        slope: vec![Complex64::ZERO; n],
    };
    let (mut k, mut known) = (0, None);
    while k + 1 < n {
        let next = (k + stride).min(n - 1);
        let mut end = None;
        if (k..next).any(&needed) {
            let (here, there) = (known.unwrap_or_else(|| at(k)), at(next));
            for j in k..next {
                let share = (j - k) as f64 / (next - k) as f64;
                out.value[j] = here.0 + (there.0 - here.0) * share;
                out.slope[j] = here.1 + (there.1 - here.1) * share;
            }
            end = Some(there);
        }
        (k, known) = (next, end);
    }
    if needed(k) {
        (out.value[k], out.slope[k]) = known.unwrap_or_else(|| at(k));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn smooth(x: &[Complex64], window: usize) -> Smoothed {
        smooth_where(x, window, |_| true)
    }

    #[test]
    fn a_quadratic_passes_unchanged_up_to_the_ends() {
        let f = |k: usize| {
            let t = k as f64 * 0.1;
            Complex64::new(1.0 + 2.0 * t - 0.3 * t * t, t)
        };
        let x: Vec<_> = (0..60).map(f).collect();
        let smoothed = smooth(&x, 21);
        for (k, (y, x)) in smoothed.value.iter().zip(&x).enumerate() {
            // Rounding of a 3 x 3 solve.
            assert!((y - x).norm() < 1e-9, "{k}");
            assert!((smoothed.slope[k].im - 0.1).abs() < 1e-9);
        }
    }

    /// Straight lines between the points that are evaluated: with wide windows only every other sample is one.
    #[test]
    fn a_straight_line_passes_windows_of_any_width() {
        for (n, window) in [(400, 100), (401, 100), (30, 100), (5, 5), (7, 4)] {
            let f = |k: usize| Complex64::new(3.0 - 0.25 * k as f64, 0.5 * k as f64);
            let x: Vec<_> = (0..n).map(f).collect();
            let smoothed = smooth(&x, window);
            assert_eq!((smoothed.value.len(), smoothed.slope.len()), (n, n));
            for (k, (value, slope)) in smoothed.value.iter().zip(&smoothed.slope).enumerate() {
                assert!((value - f(k)).norm() < 1e-8, "{k} of {n}");
                assert!(
                    (slope - Complex64::new(-0.25, 0.5)).norm() < 1e-8,
                    "{k} of {n}"
                );
            }
        }
    }

    /// To the last bit, whichever points are asked for.
    #[test]
    fn needed_points_are_those_of_the_whole() {
        let x: Vec<_> = (0..97)
            .map(|k| Complex64::from_polar(1.0, 0.3 * f64::from(k * k)))
            .collect();
        for window in [7, 60] {
            let whole = smooth(&x, window);
            for every in [2, 5, 31, 96] {
                let part = smooth_where(&x, window, |k| k % every == 0);
                for k in (0..x.len()).step_by(every) {
                    assert_eq!(
                        (part.value[k], part.slope[k]),
                        (whole.value[k], whole.slope[k])
                    );
                }
            }
        }
    }

    #[test]
    fn fewer_than_five_samples_are_left_as_they_are() {
        let x = [Complex64::new(1.0, 2.0); 4];
        let smoothed = smooth(&x, 21);
        assert_eq!(
            (smoothed.value, smoothed.slope),
            (x.to_vec(), vec![Complex64::ZERO; 4])
        );
    }

    /// In the middle of a window of 2m + 1 a quadratic has the weights of Savitzky and Golay; for five points
    /// (-3, 12, 17, 12, -3)/35, and (-2, -1, 0, 1, 2)/10 for the slope.
    #[test]
    fn weights_are_those_of_the_published_table() {
        let (value, slope) = weights(5, 2.0);
        for (k, expected) in [-3.0, 12.0, 17.0, 12.0, -3.0].into_iter().enumerate() {
            assert!((value[k] - expected / 35.0).abs() < 1e-12);
        }
        for (k, expected) in [-2.0, -1.0, 0.0, 1.0, 2.0].into_iter().enumerate() {
            assert!((slope[k] - expected / 10.0).abs() < 1e-12);
        }
    }

    #[test]
    fn joined_points_are_met_and_lie_on_lines_between() {
        let at = |k: usize| {
            (
                Complex64::new((k * k) as f64, 0.0),
                Complex64::new(0.0, k as f64),
            )
        };
        let joined = joined(8, 3, |_| true, at);
        // Evaluated at 0, 3, 6 and 7.
        let value: Vec<f64> = joined.value.iter().map(|x| x.re).collect();
        let expected = [0.0, 3.0, 6.0, 9.0, 18.0, 27.0, 36.0, 49.0];
        assert!(
            value
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-12),
            "{value:?}"
        );
        assert!(
            joined
                .slope
                .iter()
                .enumerate()
                .all(|(k, s)| (s.im - k as f64).abs() < 1e-12)
        );
    }
}
