//! Tests on pairs of held-out blocks.

/// One-sided Wilcoxon signed-rank test that `a` exceeds `b`: the probability of the data if it does not.
pub fn wilcoxon(a: &[f64], b: &[f64]) -> f64 {
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

    /// Chance that the ranks 1..=n, each with either sign, give a sum of the positive ones of at least `sum`.
    fn exact(n: u32, sum: u32) -> f64 {
        let at_least = |signs: &u32| {
            let positive: u32 = (0..n).filter(|k| signs >> k & 1 == 1).map(|k| k + 1).sum();
            positive >= sum
        };
        (0..1_u32 << n).filter(at_least).count() as f64 / f64::from(1_u32 << n)
    }

    /// The normal distribution stands for all sign patterns of ten pairs to within a hundredth.
    #[test]
    fn ranks_give_the_chance_of_their_sum() {
        for wrong in [&[][..], &[1], &[3, 4], &[2, 9], &[1, 5, 10], &[8, 9, 10]] {
            let differences = (1..=10).map(|k| {
                if wrong.contains(&k) {
                    -f64::from(k)
                } else {
                    f64::from(k)
                }
            });
            // Any order of the pairs, any common part.
            let mut pairs: Vec<(f64, f64)> = differences.map(|d| (20.0 + d, 20.0)).collect();
            pairs.rotate_left(3);
            let (a, b): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
            let sum = 55 - wrong.iter().map(|k| *k as u32).sum::<u32>();
            let (got, expected) = (wilcoxon(&a, &b), exact(10, sum));
            assert!((got - expected).abs() < 0.01, "{wrong:?}: {got} {expected}");
        }
    }

    #[test]
    fn equal_pairs_and_fewer_than_five_prove_nothing() {
        assert_eq!(wilcoxon(&[2.0; 4], &[1.0; 4]), 1.0);
        assert!(wilcoxon(&[2.0, 3.0, 4.0, 5.0, 6.0], &[1.0; 5]) < 0.04);
        let (mut a, mut b) = (vec![2.0, 3.0, 4.0, 5.0], vec![1.0; 4]);
        a.extend([7.0, f64::INFINITY]);
        b.extend([7.0, 0.0]);
        assert_eq!(wilcoxon(&a, &b), 1.0);
    }

    /// Tables of the normal distribution.
    #[test]
    fn the_tail_is_right_at_whole_deviations() {
        for (z, tail) in [
            (0.0, 0.5),
            (1.0, 0.158_655_3),
            (2.0, 0.022_750_1),
            (3.0, 0.001_349_9),
            (-2.0, 0.977_249_9),
        ] {
            assert!((upper_tail(z) - tail).abs() < 2e-7, "{z}");
        }
    }
}
