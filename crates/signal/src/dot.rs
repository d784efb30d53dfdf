//! Sums of products of long series.

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
