//! Sums of products of long series.

use num_complex::Complex64;

/// Dot product in eight independent sums, so that it vectorises; the shorter series counts.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (head_a, head_b) = (a.chunks_exact(8), b.chunks_exact(8));
    let tail: f64 = head_a
        .remainder()
        .iter()
        .zip(head_b.remainder())
        .map(|(x, y)| x * y)
        .sum();
    for (x, y) in head_a.zip(head_b) {
        for k in 0..8 {
            sums[k] += x[k] * y[k];
        }
    }
    sums.iter().sum::<f64>() + tail
}

/// Sum of vectors times weights, each axis summed as [`dot`] sums; the shorter series counts.
pub fn dot_vectors(weights: &[f64], x: &[Complex64]) -> Complex64 {
    let mut sums = [Complex64::ZERO; 8];
    let (head, vectors) = (weights.chunks_exact(8), x.chunks_exact(8));
    let tail: Complex64 = head
        .remainder()
        .iter()
        .zip(vectors.remainder())
        .map(|(w, x)| x * w)
        .sum();
    for (w, x) in head.zip(vectors) {
        for k in 0..8 {
            sums[k] += x[k] * w[k];
        }
    }
    sums.iter().sum::<Complex64>() + tail
}

#[cfg(test)]
mod tests {
    use super::*;

    /// To the last bit: what was smoothed before stays as it was.
    #[test]
    fn vectors_are_summed_as_their_axes_one_by_one() {
        let series = |f: f64| -> Vec<f64> { (0..83).map(|k| (f * f64::from(k)).sin()).collect() };
        let (a, b, c) = (series(0.3), series(1.7), series(2.9));
        let both = b.iter().zip(&c).map(|(&b, &c)| Complex64::new(b, c));
        let vectors: Vec<_> = both.collect();
        for n in [0, 5, 8, 83] {
            let sum = dot_vectors(&a[..n], &vectors[..n]);
            assert_eq!(sum.re, dot(&a[..n], &b[..n]));
            assert_eq!(sum.im, dot(&a[..n], &c[..n]));
        }
    }
}
