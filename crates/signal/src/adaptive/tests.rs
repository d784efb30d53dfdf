use super::*;
use crate::smoothed::Line;
use num_complex::Complex64;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

fn noise(n: usize, sigma: f64, seed: u64) -> Vec<f64> {
    let mut rng = rand_pcg::Pcg64::seed_from_u64(seed);
    let one = || {
        let normal: f64 = StandardNormal.sample(&mut rng);
        sigma * normal
    };
    std::iter::repeat_with(one).take(n).collect()
}

fn rms(x: impl Iterator<Item = f64>) -> f64 {
    let (n, sum) = x.fold((0usize, 0.0), |(n, sum), x| (n + 1, sum + x * x));
    (sum / n.max(1) as f64).sqrt()
}

/// Over a constant the windows grow until nearly all noise is gone: a quadratic over 25600 samples leaves
/// 1.5/sqrt(25600) of it in the middle, some times that at the ends; a window of 25 leaves 0.3.
#[test]
fn a_constant_loses_its_noise() {
    let x: Vec<f64> = noise(60_000, 1.0, 1).iter().map(|e| 20.0 + e).collect();
    let windows = longest_real(&x, 1.0, 25, true);
    let smooth: Vec<f64> = windows.smooth(&x);
    let left = rms(smooth.iter().map(|y| y - 20.0));
    assert!(left < 0.05, "{left}");
    let longest = *windows.level.iter().max().expect("samples");
    assert!(25usize << (longest - 1) > 15_000, "{longest}");
}

/// A step of ten deviations stays at its sample: nothing of it is smeared further than its noise.
#[test]
fn a_step_stays_a_step() {
    let clean = |k: usize| if k < 5000 { 0.0 } else { 10.0 };
    let x: Vec<f64> = noise(10_000, 1.0, 2)
        .iter()
        .enumerate()
        .map(|(k, e)| clean(k) + e)
        .collect();
    let smooth: Vec<f64> = longest_real(&x, 1.0, 25, true).smooth(&x);
    let worst = smooth
        .iter()
        .enumerate()
        .map(|(k, y)| (y - clean(k)).abs())
        .fold(0.0, f64::max);
    // Four deviations of the raw noise.
    assert!(worst < 4.0, "{worst}");
    let away = smooth
        .iter()
        .enumerate()
        .filter(|(k, _)| k.abs_diff(5000) > 200);
    let left = rms(away.map(|(k, y)| y - clean(k)));
    assert!(left < 0.2, "{left}");
}

/// A ramp that begins: the bias at the kink stays within what the shorter windows would have left of noise.
#[test]
fn a_kink_is_not_rounded_by_more_than_noise() {
    let clean = |k: usize| 0.01 * k.saturating_sub(10_000) as f64;
    let worst = |seed: u64| {
        let x: Vec<f64> = noise(20_000, 1.0, seed)
            .iter()
            .enumerate()
            .map(|(k, e)| clean(k) + e)
            .collect();
        let smooth: Vec<f64> = longest_real(&x, 1.0, 25, false).smooth(&x);
        smooth[9_000..11_000]
            .iter()
            .zip(9_000..)
            .map(|(y, k)| (y - clean(k)).abs())
            .fold(0.0, f64::max)
    };
    // A window of 25 leaves 0.3 of the noise, four deviations of it 1.2.
    for seed in 1..6 {
        assert!(worst(seed) < 1.2, "{}", worst(seed));
    }
}

/// What moves within the shortest window is left alone where that is allowed, and is not where it is not.
#[test]
fn what_is_faster_than_any_window_stays() {
    let x: Vec<f64> = (0..2000)
        .map(|k| 10.0 * (2.0 * f64::from(k)).sin())
        .collect();
    assert_eq!(longest_real(&x, 0.1, 25, true).smooth::<f64>(&x), x);
    let smoothed: Vec<f64> = longest_real(&x, 0.1, 25, false).smooth(&x);
    assert!(rms(smoothed[50..1950].iter().copied()) < 3.0);
}

/// Slow swings are kept: their amplitude and their slope.
#[test]
fn a_swing_keeps_its_value_and_slope() {
    let omega = std::f64::consts::TAU / 4000.0;
    let clean = |k: usize| 30.0 * (omega * k as f64).sin();
    let x: Vec<f64> = noise(20_000, 0.5, 4)
        .iter()
        .enumerate()
        .map(|(k, e)| clean(k) + e)
        .collect();
    let variance = vec![0.25; x.len()];
    let series = Noisy {
        x: &x,
        variance: &variance,
    };
    let smoothed: Vec<Line> = Windows::longest(series, 25, false).smooth(&x);
    let inside = 500..19_500;
    let off = rms(inside.clone().map(|k| smoothed[k].value - clean(k)));
    // Less than windows of 100 samples would leave: 0.5 x 1.5/10.
    assert!(off < 0.075, "{off}");
    let slope = |k: usize| 30.0 * omega * (omega * k as f64).cos();
    let off = rms(inside.map(|k| smoothed[k].slope - slope(k)));
    assert!(off < 0.1 * 30.0 * omega, "{off}");
}

/// Two axes at once, and a linear operation: a sum is smoothed to the sum.
#[test]
fn smoothing_is_linear_in_what_is_smoothed() {
    let [a, b] = [7, 8].map(|seed| noise(3000, 1.0, seed));
    let [c, d] = [9, 10].map(|seed| noise(3000, 1.0, seed));
    let one: Vec<_> = a
        .iter()
        .zip(&b)
        .map(|(&a, &b)| Complex64::new(a, b))
        .collect();
    let two: Vec<_> = c
        .iter()
        .zip(&d)
        .map(|(&c, &d)| Complex64::new(c, d))
        .collect();
    let variance = vec![1.0; one.len()];
    let windows = Windows::longest(
        Noisy {
            x: &one,
            variance: &variance,
        },
        50,
        true,
    );
    let sum: Vec<_> = one.iter().zip(&two).map(|(a, b)| a + b).collect();
    let [one, two, sum] = [one, two, sum].map(|x| windows.smooth::<Complex64>(&x));
    for ((one, two), sum) in one.iter().zip(&two).zip(&sum) {
        assert!((one + two - sum).norm() < 1e-9);
    }
}

/// Orthonormal, and blind to every quadratic.
#[test]
fn what_is_left_over_is_no_quadratic() {
    let polynomials = left_over(40);
    assert_eq!(polynomials.len(), 4);
    for (j, p) in polynomials.iter().enumerate() {
        for (k, q) in polynomials.iter().enumerate() {
            let expected = f64::from(u8::from(j == k));
            assert!((dot(p, q) - expected).abs() < 1e-9);
        }
        for order in 0..3 {
            let power: Vec<f64> = (0..40).map(|k| f64::from(k).powi(order)).collect();
            assert!(dot(p, &power).abs() < 1e-7 * dot(&power, &power).sqrt());
        }
    }
}

/// Chance exceeds the limits in one window of a hundred.
#[test]
fn the_limits_are_those_of_chi_square() {
    fn exceed<T: Sample>(x: &[T]) -> usize {
        let windows = x
            .chunks_exact(49)
            .map(|part| misfits(part, &[1.0; 49], 49)[20]);
        windows.filter(|&m| m > LIMITS[T::AXES - 1]).count()
    }
    let [re, im] = [21, 22].map(|seed| noise(2_000_000, 1.0, seed));
    let both = re.iter().zip(&im).map(|(&re, &im)| Complex64::new(re, im));
    // 40816 windows: 408 expected, four deviations of a count.
    for count in [exceed(&re), exceed(&both.collect::<Vec<_>>())] {
        assert!((327..=489).contains(&count), "{count}");
    }
}

/// Windows of eleven points: six neighbours that exceed are a kink, five are chance; at an end half a window shares one.
#[test]
fn few_neighbours_exceed_by_chance() {
    let series = |high: std::ops::Range<usize>| -> Vec<f64> {
        (0..60)
            .map(|k| if high.contains(&k) { 9.0 } else { 1.0 })
            .collect()
    };
    let failed = |high| {
        without_chance(&series(high), 5.0, 11)
            .iter()
            .filter(|x| !**x)
            .count()
    };
    assert_eq!(failed(20..25), 0);
    assert_eq!(failed(20..26), 6);
    assert_eq!(failed(0..10), 0, "five of them share the first window");
    assert_eq!(failed(0..11), 11);
    assert_eq!(failed(49..60), 11);
    assert_eq!(failed(50..60), 0);
}

/// A long constant has windows of its own length; parts of it have windows that fit into them, and smooth as before.
#[test]
fn parts_of_a_series_have_windows_that_fit() {
    let noise = noise(4096, 1.0, 7);
    let windows = longest_real(&noise, 1.0, 16, false);
    for length in [3, 20, 40, 700] {
        let part = windows.taken(std::slice::from_ref(&(100..100 + length)));
        let smoothed: Vec<f64> = part.smooth(&noise[100..100 + length]);
        assert_eq!(smoothed.len(), length);
        assert!(smoothed.iter().all(|x| x.is_finite()));
    }
    assert_eq!(windows.taken(&[0..2048, 2048..4096]), windows);
}
