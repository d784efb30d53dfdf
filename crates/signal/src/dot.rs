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

/// Dot products of one series with two others of its length, each summed as [`dot`] sums.
pub fn dots(a: &[f64], [b, c]: [&[f64]; 2]) -> [f64; 2] {
    let mut sums = [[0.0; 8]; 2];
    let heads = [a, b, c].map(|x| x.chunks_exact(8));
    let [tail, tail_b, tail_c] = [&heads[0], &heads[1], &heads[2]].map(|head| head.remainder());
    let tails = [tail_b, tail_c].map(|other| tail.iter().zip(other).map(|(x, y)| x * y).sum());
    let [head, head_b, head_c] = heads;
    for ((x, y), z) in head.zip(head_b).zip(head_c) {
        for k in 0..8 {
            sums[0][k] += x[k] * y[k];
            sums[1][k] += x[k] * z[k];
        }
    }
    let [with_b, with_c]: [f64; 2] = tails;
    [
        sums[0].iter().sum::<f64>() + with_b,
        sums[1].iter().sum::<f64>() + with_c,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// To the last bit: what was smoothed before stays as it was.
    #[test]
    fn two_sums_at_once_are_those_of_one_by_one() {
        let series = |f: f64| -> Vec<f64> { (0..83).map(|k| (f * f64::from(k)).sin()).collect() };
        let (a, b, c) = (series(0.3), series(1.7), series(2.9));
        for n in [0, 5, 8, 83] {
            let (a, b, c) = (&a[..n], &b[..n], &c[..n]);
            assert_eq!(dots(a, [b, c]), [dot(a, b), dot(a, c)]);
        }
    }
}
