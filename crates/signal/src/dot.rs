//! Sums of products of long series.

use crate::sample::Sample;

/// Sum of samples times weights in eight independent sums, so that it vectorises; the shorter series counts.
pub fn dot<T: Sample>(weights: &[f64], x: &[T]) -> T {
    let mut sums = [T::ZERO; 8];
    let (heads, samples) = (weights.chunks_exact(8), x.chunks_exact(8));
    let tails = heads.remainder().iter().zip(samples.remainder());
    let tail = tails.fold(T::ZERO, |sum, (w, x)| sum + *x * *w);
    for (w, x) in heads.zip(samples) {
        for k in 0..8 {
            sums[k] = sums[k] + x[k] * w[k];
        }
    }
    sums.into_iter().fold(T::ZERO, |sum, x| sum + x) + tail
}

#[cfg(test)]
mod tests {
    use super::*;

    use num_complex::Complex64;

    /// To the last bit: what was smoothed before stays as it was.
    #[test]
    fn vectors_are_summed_as_their_axes_one_by_one() {
        let series = |f: f64| -> Vec<f64> { (0..83).map(|k| (f * f64::from(k)).sin()).collect() };
        let (a, b, c) = (series(0.3), series(1.7), series(2.9));
        let both = b.iter().zip(&c).map(|(&b, &c)| Complex64::new(b, c));
        let vectors: Vec<_> = both.collect();
        for n in [0, 5, 8, 83] {
            let sum = dot(&a[..n], &vectors[..n]);
            assert_eq!(sum.re, dot(&a[..n], &b[..n]));
            assert_eq!(sum.im, dot(&a[..n], &c[..n]));
        }
        let one_by_one: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
        // At most n eps times the sum of n products of size one (Higham, Accuracy and Stability, section 3.1).
        assert!((dot(&a, &b) - one_by_one).abs() < 83.0 * 83.0 * f64::EPSILON);
    }
}
