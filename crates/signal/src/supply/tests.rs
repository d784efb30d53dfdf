use super::steps::{jumps, sharpest};
use super::*;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};

fn noisy(n: usize, sigma: f64, f: impl Fn(usize) -> Complex64) -> Vec<Complex64> {
    let mut rng = rand_pcg::Pcg64::seed_from_u64(7);
    let normal = Normal::new(0.0, sigma).unwrap();
    let mut one = |k| f(k) + Complex64::new(normal.sample(&mut rng), normal.sample(&mut rng));
    (0..n).map(&mut one).collect()
}

#[test]
fn steps_are_found_at_their_sample_and_noise_is_reduced() {
    let clean = |k: usize| {
        let amplitude = if k < 3210 { 320.0 } else { 288.0 };
        let theta = 0.0314159 * k as f64;
        Complex64::from_polar(amplitude, theta) + Complex64::from_polar(0.02 * amplitude, -theta)
    };
    let raw = noisy(8000, 1.0, clean);
    let supply = denoise(&raw, 1e-4, 1.0, 314.159);
    assert!(supply.denoised);
    assert_eq!(supply.segments.len(), 2);
    assert_eq!(supply.segments[1].start, 3210);
    assert!((supply.harmonics[0].1.norm() - 0.02).abs() < 2e-4);
    let error = |k: usize| (supply.u_s[k] - clean(k)).norm_sqr();
    let rms = ((0..8000).map(error).sum::<f64>() / 16000.0).sqrt();
    // A quadratic over 200 points leaves 1.5/sqrt(200) of the noise; ends of segments three times as much.
    assert!(rms < 0.2, "{rms}");
}

#[test]
fn where_a_switch_opens_the_raw_voltage_is_used() {
    // Within 6 ms the terminals pass from the supply to a decaying voltage of another phase.
    let clean = |k: usize| {
        let supply = Complex64::from_polar(320.0, 0.0314159 * k as f64);
        let decaying = Complex64::from_polar(280.0, 0.0310 * k as f64 - 0.2)
            * (-(k as f64 - 4000.0) * 1e-3).exp();
        let share = ((k as f64 - 4000.0) / 60.0).clamp(0.0, 1.0);
        supply * (1.0 - share) + decaying * share
    };
    let raw = noisy(8000, 1.0, clean);
    let supply = denoise(&raw, 1e-4, 1.0, 314.159);
    let worst = |r: std::ops::Range<usize>| {
        let error = r.map(|k| (supply.u_s[k] - clean(k)).norm());
        error.fold(0.0, f64::max)
    };
    assert!(supply.raw.iter().any(|r| r.contains(&4030)));
    // Five standard deviations of the raw voltage.
    assert!(worst(3900..4200) < 5.0, "{}", worst(3900..4200));
    assert!(supply.raw.iter().map(|r| r.len()).sum::<usize>() < 1200);
}

#[test]
fn a_voltage_that_is_no_sinusoid_is_left_alone() {
    let square = |k: usize| Complex64::new(if k % 200 < 100 { 300.0 } else { -300.0 }, 0.0);
    let raw = noisy(4000, 1.0, square);
    let supply = denoise(&raw, 1e-4, 1.0, 314.159);
    assert!(!supply.denoised);
    assert_eq!(supply.u_s, raw);
}

const STEP: f64 = 0.0314159;

fn sine(k: usize) -> Complex64 {
    Complex64::from_polar(320.0, STEP * k as f64 + 0.4)
}

#[test]
fn frequency_and_angle_are_those_of_the_fundamental() {
    let raw = noisy(4000, 1.0, sine);
    let supply = denoise(&raw, 1e-4, 1.0, 314.159);
    assert!(supply.raw.is_empty() && supply.segments == [0..4000]);
    for k in (0..4000).step_by(101) {
        // Noise of 1 V on 320 V over windows of 200 and 400: 1e-4 rad in the middle, some times that at the ends.
        let error = supply.theta[k] - (STEP * k as f64 + 0.4);
        assert!(error.abs() < 3e-3, "{k}: {error}");
        assert!(
            (supply.omega_sync[k] / 314.159 - 1.0).abs() < 2e-3,
            "{k}: {}",
            supply.omega_sync[k]
        );
    }
}

/// Unbalance, a constant, a fifth and a seventh at once, each in its own place.
#[test]
fn every_harmonic_is_found_with_its_size_and_phase() {
    let parts = [
        (-1.0, Complex64::from_polar(0.02, 0.3)),
        (0.0, Complex64::from_polar(3.0, -1.0)),
        (-5.0, Complex64::from_polar(0.015, 2.0)),
        (7.0, Complex64::from_polar(0.01, -2.0)),
    ];
    let clean = |k: usize| {
        let theta = STEP * k as f64 + 0.4;
        let part = |(order, ratio): (f64, Complex64)| {
            let size = if order == 0.0 { 1.0 } else { 320.0 };
            ratio * Complex64::from_polar(size, order * theta)
        };
        sine(k) + parts.into_iter().map(part).sum::<Complex64>()
    };
    let raw = noisy(8000, 0.5, clean);
    let supply = denoise(&raw, 1e-4, 0.5, 314.159);
    assert!(supply.denoised);
    for ((order, ratio), (expected, truth)) in supply.harmonics.iter().zip(parts) {
        assert_eq!(*order, expected);
        // Seen from the fundamental a constant turns once in a window: smoothing keeps part of it there.
        let share = if expected == 0.0 { 0.25 } else { 0.05 };
        assert!(
            (ratio - truth).norm() < share * truth.norm(),
            "{order}: {ratio} {truth}"
        );
    }
    let worst = (0..8000)
        .map(|k| (supply.u_s[k] - clean(k)).norm())
        .fold(0.0, f64::max);
    assert!(worst < 1.0, "{worst}");
}

/// The orders found in two seconds at 2 kHz of a supply with these harmonics, and the largest error of the denoised voltage (V).
fn slowly_sampled(frequency_hz: f64, parts: &[(f64, f64)]) -> (Vec<f64>, f64) {
    let step = frequency_hz / 2000.0 * std::f64::consts::TAU;
    let clean = |k: usize| {
        let theta = step * k as f64 + 0.4;
        let part = |&(order, ratio): &(f64, f64)| {
            Complex64::from_polar(320.0 * ratio, order * theta + order)
        };
        Complex64::from_polar(320.0, theta) + parts.iter().map(part).sum::<Complex64>()
    };
    let raw = noisy(4000, 0.5, clean);
    let supply = denoise(&raw, 5e-4, 0.5, frequency_hz * std::f64::consts::TAU);
    assert!(supply.denoised);
    let mut found: Vec<f64> = supply.harmonics.iter().map(|(order, _)| *order).collect();
    found.sort_by(f64::total_cmp);
    let error = (0..4000).map(|k| (supply.u_s[k] - clean(k)).norm());
    (found, error.fold(0.0, f64::max))
}

/// Ends of segments hold three times the noise of windows of one period, 33 to 40 samples, V.
const AT_THE_ENDS: f64 = 1.2;

/// A slow recorder on a supply with orders that are not the common ones, one of them near half the sampling rate.
#[test]
fn orders_that_stand_out_are_found_and_no_others() {
    let parts = [(13.0, 0.03), (19.0, 0.034), (-17.0, 0.016), (3.0, 0.01)];
    let (found, error) = slowly_sampled(50.0, &parts);
    assert_eq!(found, [-17.0, -5.0, -1.0, 0.0, 3.0, 7.0, 13.0, 19.0]);
    assert!(error < AT_THE_ENDS, "{error}");
}

/// A tenth of harmonics on a quiet recorder: their size follows the fundamental's, not that of their sum.
#[test]
fn many_harmonics_are_described_to_the_noise() {
    let (step, sigma) = (50.0 / 10_000.0 * std::f64::consts::TAU, 0.18);
    let parts = [
        (-1.0, 0.0172),
        (19.0, 0.0347),
        (3.0, 0.0132),
        (-11.0, 0.027),
        (-5.0, 0.0236),
    ];
    let clean = |k: usize| {
        let theta = step * k as f64 + 0.4;
        let part = |&(order, ratio): &(f64, f64)| {
            Complex64::from_polar(326.0 * ratio, order * theta + order)
        };
        Complex64::from_polar(326.0, theta) + parts.iter().map(part).sum::<Complex64>()
    };
    let raw = noisy(40_000, sigma, clean);
    let supply = denoise(&raw, 1e-4, sigma, 50.0 * std::f64::consts::TAU);
    assert!(supply.denoised && supply.segments.len() == 1);
    let error = (0..40_000).map(|k| (supply.u_s[k] - clean(k)).norm());
    // Ends of segments hold three times the noise of windows of one period, 200 samples: sigma times sqrt(9/200) in each axis.
    let worst = error.fold(0.0, f64::max);
    assert!(worst < 3.0 * sigma * (9.0f64 / 200.0).sqrt(), "{worst}");
}

/// At 60 Hz the 17th and the 19th turn more than half a turn between two samples, unlike any lower order: -16.3 and -14.3.
#[test]
fn orders_above_half_the_sampling_rate_are_told_where_no_lower_one_looks_alike() {
    let (found, error) = slowly_sampled(60.0, &[(-17.0, 0.03), (19.0, 0.015)]);
    assert_eq!(found, [-17.0, -5.0, -1.0, 0.0, 7.0, 19.0]);
    assert!(error < AT_THE_ENDS, "{error}");
}

/// At 50 Hz the 27th turns 13 fortieths back between two samples, as the 13th of negative sequence does.
#[test]
fn of_two_orders_that_look_alike_the_lower_one_is_taken() {
    let (found, _) = slowly_sampled(50.0, &[(27.0, 0.02)]);
    assert_eq!(found, [-13.0, -5.0, -1.0, 0.0, 7.0]);
}

/// What the denoising makes of noise is told by `filter`: the difference of two denoised voltages.
#[test]
fn the_filter_is_the_denoising_of_a_difference() {
    let raw = noisy(3000, 0.5, sine);
    let supply = denoise(&raw, 1e-4, 0.5, 314.159);
    let extra = noisy(3000, 0.01, |k| Complex64::from_polar(0.02, STEP * k as f64));
    let both: Vec<_> = raw.iter().zip(&extra).map(|(a, b)| a + b).collect();
    let again = denoise(&both, 1e-4, 0.5, 314.159);
    let filtered = supply.filter(&extra);
    let off = |k: usize| (again.u_s[k] - supply.u_s[k] - filtered[k]).norm_sqr();
    let size: f64 = filtered.iter().map(|x| x.norm_sqr()).sum();
    // The harmonics follow the disturbance a little too.
    assert!((0..3000).map(off).sum::<f64>() < 0.05 * size);
    let mut raw = supply;
    raw.denoised = false;
    assert_eq!(raw.filter(&extra), extra);
}

#[test]
fn where_the_raw_voltage_is_used_its_noise_is_too() {
    let supply = Supply {
        theta: (0..300).map(|k| STEP * f64::from(k)).collect(),
        segments: vec![0..300],
        denoised: true,
        raw: vec![100..120],
        windows: vec![Windows::longest(
            Noisy {
                x: &[Complex64::ZERO; 300],
                variance: &[1.0; 300],
            },
            41,
            false,
        )],
        window: 41,
        ..Supply::default()
    };
    let noise = noisy(300, 1.0, |_| Complex64::ZERO);
    let filtered = supply.filter(&noise);
    assert_eq!(filtered[100..120], noise[100..120]);
    let power = |x: &[Complex64]| x.iter().map(|x| x.norm_sqr()).sum::<f64>();
    assert!(power(&filtered[130..270]) < 0.15 * power(&noise[130..270]));
}

/// Where the supply is off, the last frequency stays.
#[test]
fn the_frequency_is_held_while_the_supply_is_off() {
    let mut supply = Supply {
        omega_sync: vec![9.0, 314.0, 315.0, 7.0, 8.0, 316.0],
        ..Supply::default()
    };
    let u = [0.0, 320.0, 300.0, 9.0, 0.0, 320.0].map(|x| Complex64::new(x, 0.0));
    supply.hold_frequency(&u);
    // Nothing was known before the supply came.
    assert_eq!(supply.omega_sync, [9.0, 314.0, 315.0, 315.0, 315.0, 316.0]);
}

/// Two lines that meet have no jump between them; a step has its height where it is.
#[test]
fn a_jump_is_the_difference_of_two_lines() {
    let line: Vec<f64> = (0..60).map(|k| 3.0 + 0.5 * f64::from(k)).collect();
    let step: Vec<f64> = line
        .iter()
        .enumerate()
        .map(|(k, x)| if k < 30 { *x } else { x + 7.0 })
        .collect();
    let (smooth, jumped) = (jumps(&line, 10), jumps(&step, 10));
    for (k, jump) in smooth.iter().enumerate() {
        // The line rises by a half from one sample to the next; four samples on each side show it.
        let expected = if (4..=56).contains(&k) { 0.5 } else { 0.0 };
        assert!((jump - expected).abs() < 1e-9, "{k}: {jump}");
    }
    assert!((jumped[30] - 7.5).abs() < 1e-9);
    assert!(jumped.iter().all(|x| *x < 7.6));
    assert_eq!(sharpest(&step, &jumped, 25, 36), 30);
}

#[test]
fn amplitude_steps_cut_and_ripple_does_not() {
    let with = |steps: &[usize], ripple: f64| {
        let at = |k: usize| {
            let down = steps.iter().filter(|s| **s <= k).count() as f64;
            Complex64::new(
                320.0 * (1.0 - 0.1 * down) * (1.0 + ripple * (0.2 * k as f64).sin()),
                0.0,
            )
        };
        segments(&(0..3000).map(at).collect::<Vec<_>>(), 100, 0.1)
    };
    assert_eq!(with(&[], 0.0), [0..3000]);
    assert_eq!(with(&[1000], 0.0), [0..1000, 1000..3000]);
    assert_eq!(with(&[1000, 2000], 0.0), [0..1000, 1000..2000, 2000..3000]);
    assert_eq!(with(&[], 0.005), [0..3000]);
    assert!(segments(&[], 100, 0.1).is_empty());
}

/// The angle turns on while the voltage does, and stands while there is none.
#[test]
fn the_unwrapped_angle_goes_through_many_turns() {
    let turning: Vec<_> = (0..2000)
        .map(|k| Complex64::from_polar(5.0, 0.1 * f64::from(k)))
        .collect();
    let (theta, slope) = angle(&turning, &[0..2000], 1e-3, 20);
    for (k, (theta, slope)) in theta.iter().zip(slope).enumerate() {
        assert!((theta - 0.1 * k as f64).abs() < 1e-8);
        assert!((slope - 0.1).abs() < 1e-8);
    }
    let (theta, _) = angle(&[Complex64::ZERO; 50], &[0..50], 1e-3, 20);
    assert!(theta.iter().all(|x| x.abs() < 1e-12));
}

/// A supply that is switched on some time after the recorder: while it is off its angle is noise, which is no constant.
#[test]
fn a_late_switch_leaves_no_constant() {
    for on in [0, 80, 2330] {
        let clean = |k: usize| if k < on { Complex64::ZERO } else { sine(k) };
        let raw = noisy(40_000, 0.7, clean);
        let supply = denoise(&raw, 1e-4, 0.7, 314.159);
        assert!(supply.denoised);
        assert_eq!(supply.segments.last(), Some(&(on..40_000)));
        let error: Complex64 = (on..40_000).map(|k| supply.u_s[k] - clean(k)).sum();
        // The mean of the noise is 0.7 V over the root of 40 000 in each axis, 0.005 V in both; three of that.
        assert!(error.norm() / 40_000.0 < 0.015, "{on}: {error}");
    }
}
