//! Tests on pairs of held-out blocks.

/// One-sided Wilcoxon signed-rank test that `a` exceeds `b`: the probability of the data if it does not.
pub(crate) fn wilcoxon(a: &[f64], b: &[f64]) -> f64 {
    let mut differences: Vec<f64> = a.iter().zip(b).map(|(x, y)| x - y).collect();
    differences.retain(|d| d.abs() > 0.0 && d.is_finite());
    differences.sort_by(|x, y| x.abs().total_cmp(&y.abs()));
    let n = differences.len() as f64;
    if n < 5.0 {
        return 1.0;
    }
    let rank = |(k, d): (usize, &f64)| if *d > 0.0 { k as f64 + 1.0 } else { 0.0 };
    let positive: f64 = differences.iter().enumerate().map(rank).sum();
    let mean = n * (n + 1.0) / 4.0;
    let sd = (n * (n + 1.0) * (2.0 * n + 1.0) / 24.0).sqrt();
    upper_tail((positive - mean - 0.5) / sd)
}

/// Upper tail of the normal distribution (Abramowitz and Stegun 7.1.26, absolute error below 1.5e-7).
fn upper_tail(z: f64) -> f64 {
    let x = z.abs() / std::f64::consts::SQRT_2;
    let t = 1.0 / (1.0 + 0.327_591_1 * x);
    let coefficients = [
        0.254829592,
        -0.284496736,
        1.421413741,
        -1.453152027,
        1.061405429,
    ];
    let polynomial = coefficients.iter().rev().fold(0.0, |sum, c| (sum + c) * t);
    let tail = 0.5 * polynomial * (-x * x).exp();
    if z >= 0.0 { tail } else { 1.0 - tail }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tail_of_the_normal_distribution_is_right() {
        // Tables: P(Z > 1.96) = 0.025, P(Z > -1) = 0.8413.
        assert!((upper_tail(1.959_964) - 0.025).abs() < 1e-6);
        assert!((upper_tail(-1.0) - 0.841_345).abs() < 1e-6);
    }

    #[test]
    fn a_consistent_advantage_is_proven_and_noise_is_not() {
        let a: Vec<f64> = (0..40).map(|k| 1.0 + f64::from(k % 7)).collect();
        let better: Vec<f64> = a.iter().map(|x| 0.9 * x).collect();
        assert!(wilcoxon(&a, &better) < 1e-6);
        let shuffled: Vec<f64> = (0..40).map(|k| 1.0 + f64::from((k * 3) % 7)).collect();
        assert!(wilcoxon(&a, &shuffled) > 0.05);
    }
}
