//! Local quadratic smoothing (Savitzky-Golay) that respects the ends of a segment.

use crate::smoothed::{Smoothed, Weights};
use nalgebra::{Matrix3, Vector3};

/// Points per window at which a smoothed signal is evaluated.
const KNOTS: usize = 24;

/// Weights of a least-squares quadratic over `window` points that give its value and its slope (per sample) at
/// the position `at`, counted from the window's first point.
fn weights(window: usize, at: f64) -> Weights {
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
    Weights {
        value: dot(&value),
        slope: dot(&slope),
    }
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
/// are not `needed` may be left as they are.
pub fn smooth_where<S: Smoothed>(
    x: &[S::Of],
    window: usize,
    needed: impl Fn(usize) -> bool,
) -> Vec<S> {
    let raw = || x.iter().map(|x| S::raw(*x)).collect();
    let Some(Reach { window, stride }) = reach(x.len(), window) else {
        return raw();
    };
    let half = window / 2;
    let centre = weights(window, half as f64);
    let at = |k: usize| {
        let first = k.saturating_sub(half).min(x.len() - window);
        let part = &x[first..first + window];
        if k - first == half {
            S::of(&centre, part)
        } else {
            S::of(&weights(window, (k - first) as f64), part)
        }
    };
    let mut out = raw();
    join(&mut out, stride, needed, at);
    out
}

/// Evaluates `at` on every `stride`-th sample and joins by straight lines: what a window has smoothed hardly
/// bends within a small part of it. Where no point is needed nothing is evaluated.
fn join<S: Smoothed>(
    out: &mut [S],
    stride: usize,
    needed: impl Fn(usize) -> bool,
    at: impl Fn(usize) -> S,
) {
    let n = out.len();
    let (mut k, mut known) = (0, None);
    while k + 1 < n {
        let next = (k + stride).min(n - 1);
        let mut end = None;
        if (k..next).any(&needed) {
            let (here, there) = (known.unwrap_or_else(|| at(k)), at(next));
            for (j, out) in out[k..next].iter_mut().enumerate() {
                *out = here.towards(there, j as f64 / (next - k) as f64);
            }
            end = Some(there);
        }
        (k, known) = (next, end);
    }
    if needed(k) {
        out[k] = known.unwrap_or_else(|| at(k));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::smoothed::Line;
    use num_complex::Complex64;

    fn smooth<S: Smoothed>(x: &[S::Of], window: usize) -> Vec<S> {
        smooth_where(x, window, |_| true)
    }

    #[test]
    fn a_quadratic_passes_unchanged_up_to_the_ends() {
        let f = |k: usize| {
            let t = k as f64 * 0.1;
            Complex64::new(1.0 + 2.0 * t - 0.3 * t * t, t)
        };
        let x: Vec<_> = (0..60).map(f).collect();
        let lines = |axis: fn(&Complex64) -> f64| -> Vec<Line> {
            smooth(&x.iter().map(axis).collect::<Vec<f64>>(), 21)
        };
        let smoothed: Vec<Complex64> = smooth(&x, 21);
        let (of_re, of_im) = (lines(|x| x.re), lines(|x| x.im));
        for (k, x) in x.iter().enumerate() {
            // Rounding of a 3 x 3 solve.
            assert!((smoothed[k] - x).norm() < 1e-9, "{k}");
            let (re, im) = (of_re[k], of_im[k]);
            assert!((re.value - x.re).abs() < 1e-9 && (im.value - x.im).abs() < 1e-9);
            assert!((re.slope - 0.1 * (2.0 - 0.6 * 0.1 * k as f64)).abs() < 1e-9);
            assert!((im.slope - 0.1).abs() < 1e-9);
        }
    }

    /// Straight lines between the points that are evaluated: with wide windows only every other sample is one.
    #[test]
    fn a_straight_line_passes_windows_of_any_width() {
        for (n, window) in [(400, 100), (401, 100), (30, 100), (5, 5), (7, 4)] {
            let f = |k: usize| 3.0 - 0.25 * k as f64;
            let x: Vec<_> = (0..n).map(f).collect();
            let smoothed: Vec<Line> = smooth(&x, window);
            assert_eq!(smoothed.len(), n);
            for (k, line) in smoothed.iter().enumerate() {
                assert!((line.value - f(k)).abs() < 1e-8, "{k} of {n}");
                assert!((line.slope + 0.25).abs() < 1e-8, "{k} of {n}");
            }
        }
    }

    /// To the last bit, whichever points are asked for, each axis alone or both together, with slopes or without.
    #[test]
    fn needed_points_are_those_of_the_whole() {
        let x: Vec<_> = (0..97)
            .map(|k| Complex64::from_polar(1.0, 0.3 * f64::from(k * k)))
            .collect();
        let re: Vec<f64> = x.iter().map(|x| x.re).collect();
        for window in [7, 60] {
            let (both, lines): (Vec<Complex64>, Vec<Line>) =
                (smooth(&x, window), smooth(&re, window));
            for every in [2, 5, 31, 96] {
                let some = |k| k % every == 0;
                let part: Vec<Complex64> = smooth_where(&x, window, some);
                let one: Vec<f64> = smooth_where(&re, window, some);
                let with_slope: Vec<Line> = smooth_where(&re, window, some);
                for k in (0..x.len()).step_by(every) {
                    assert_eq!((part[k], with_slope[k]), (both[k], lines[k]));
                    assert_eq!([one[k], lines[k].value], [both[k].re; 2]);
                }
            }
        }
    }

    #[test]
    fn fewer_than_five_samples_are_left_as_they_are() {
        let x = [Complex64::new(1.0, 2.0); 4];
        assert_eq!(smooth::<Complex64>(&x, 21), x);
        let line = Line {
            value: 1.0,
            slope: 0.0,
        };
        assert_eq!(smooth::<Line>(&[1.0; 4], 21), [line; 4]);
    }

    /// In the middle of a window of 2m + 1 a quadratic has the weights of Savitzky and Golay; for five points
    /// (-3, 12, 17, 12, -3)/35, and (-2, -1, 0, 1, 2)/10 for the slope.
    #[test]
    fn weights_are_those_of_the_published_table() {
        let Weights { value, slope } = weights(5, 2.0);
        for (k, expected) in [-3.0, 12.0, 17.0, 12.0, -3.0].into_iter().enumerate() {
            assert!((value[k] - expected / 35.0).abs() < 1e-12);
        }
        for (k, expected) in [-2.0, -1.0, 0.0, 1.0, 2.0].into_iter().enumerate() {
            assert!((slope[k] - expected / 10.0).abs() < 1e-12);
        }
    }

    #[test]
    fn joined_points_are_met_and_lie_on_lines_between() {
        let at = |k: usize| Line {
            value: (k * k) as f64,
            slope: k as f64,
        };
        let mut joined = [Line::default(); 8];
        join(&mut joined, 3, |_| true, at);
        // Evaluated at 0, 3, 6 and 7.
        let expected = [0.0, 3.0, 6.0, 9.0, 18.0, 27.0, 36.0, 49.0];
        for (k, (line, expected)) in joined.iter().zip(expected).enumerate() {
            assert!((line.value - expected).abs() < 1e-12, "{joined:?}");
            assert!((line.slope - k as f64).abs() < 1e-12);
        }
    }
}
