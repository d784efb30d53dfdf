use super::*;
use crate::specimen::T_SAMPLE;
use num_complex::Complex64;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// Standard deviation of the noise of `phases`, A.
const SIGMA: f64 = 0.05;

#[test]
fn running_sums_give_power_and_variance_of_any_range() {
    let x = [1.0, -3.0, 2.0, 4.0, 7.0];
    let running = Running::new(&x, 2.0);
    // In units of the noise: -1.5, 1, 2.
    let (power, mean) = ((2.25 + 1.0 + 4.0) / 3.0, 0.5);
    assert!((running.power(1..4) - power).abs() < 1e-12);
    assert!((running.variance(1..4) - (power - mean * mean)).abs() < 1e-12);
}

/// Three currents of 0.4 s at 10 kHz, A: a vector through time, in units of their white noise.
fn phases(vector: impl Fn(f64) -> Complex64) -> [Vec<f64>; 3] {
    let mut rng = Pcg64::seed_from_u64(7);
    let normal = Normal::new(0.0, SIGMA).unwrap();
    [0.0, 1.0, 2.0].map(|phase| {
        let axis = Complex64::cis(-TAU * phase / 3.0);
        let mut at =
            |k: i32| SIGMA * (vector(f64::from(k) * 1e-4) * axis).re + normal.sample(&mut rng);
        (0..4000).map(&mut at).collect()
    })
}

/// Beginnings and ends of what is open, s.
fn open_in(x: &[Vec<f64>; 3]) -> Vec<(f64, f64)> {
    let found = switched_off([&x[0], &x[1], &x[2]], [SIGMA; 3], 1e-4);
    let seconds = |k: usize| k as f64 * 1e-4;
    found
        .iter()
        .map(|r| (seconds(r.start), seconds(r.end)))
        .collect()
}

/// Behind a drive that starts, the current's vector can swing past zero: for 20 ms its phases move by little more than the noise.
#[test]
fn a_slow_current_that_passes_zero_is_carried_all_the_time() {
    let x = phases(|t| {
        let t = t - 0.1;
        let near = 1.15 * t.clamp(-0.01, 0.01) / 0.01;
        let far = t.signum() * (t.abs() - 0.01).max(0.0) / 0.001;
        let turned = Complex64::cis(TAU * 4.0 * (t - 0.03).max(0.0));
        Complex64::new(near + far.clamp(-20.0, 20.0), 0.5) * turned
    });
    assert!(open_in(&x).is_empty(), "{:?}", open_in(&x));
}

#[test]
fn a_motor_that_is_held_with_direct_current_is_not_switched_off() {
    let x = phases(|t| 20.0 * Complex64::cis(TAU * 50.0 * t.min(0.2)));
    assert!(open_in(&x).is_empty(), "{:?}", open_in(&x));
}

/// What comes back slowly is back: a drive that catches a motor changes its current by less than the noise between samples.
#[test]
fn a_current_that_returns_slowly_ends_what_was_open() {
    let x = phases(|t| {
        let amplitude = match t {
            t if t < 0.1 => 40.0,
            t if t < 0.2 => 0.0,
            t => (400.0 * (t - 0.2)).min(40.0),
        };
        amplitude * Complex64::cis(TAU * 5.0 * t)
    });
    let open = open_in(&x);
    assert_eq!(open.len(), 1, "{open:?}");
    assert!((open[0].0 - 0.1).abs() < 2e-3, "{open:?}");
    // 400 deviations of the noise a second: 4.5 of them after 11 ms.
    assert!((open[0].1 - 0.211).abs() < 0.01, "{open:?}");
}

#[test]
fn a_motor_that_never_carried_current_is_not_switched_off() {
    let quiet: Vec<f64> = (0..2000)
        .map(|k| 0.005 * ((k * 7_919 % 1000) as f64 / 500.0 - 1.0))
        .collect();
    let all = [&quiet[..]; 3];
    assert!(switched_off(all, [0.005; 3], T_SAMPLE).is_empty());
}

/// Three currents of an amplitude that may change, A, with a noise of which 5 mA is the largest.
fn currents(n: usize, amplitude: impl Fn(usize) -> f64) -> [Vec<f64>; 3] {
    let omega = 120.0 * std::f64::consts::PI * T_SAMPLE;
    [0.0, 1.0, 2.0].map(|phase| {
        let shift = phase * std::f64::consts::TAU / 3.0;
        let at = |k: usize| {
            let noise = 0.005 * ((k * 7_919 % 1000) as f64 / 500.0 - 1.0);
            amplitude(k) * (omega * k as f64 - shift).cos() + noise
        };
        (0..n).map(at).collect()
    })
}

fn open_of(x: &[Vec<f64>; 3]) -> Vec<Range<usize>> {
    switched_off([&x[0], &x[1], &x[2]], [0.005; 3], T_SAMPLE)
}

#[test]
fn a_motor_that_is_switched_off_for_good_stays_off_to_the_end() {
    let x = currents(3000, |k| if k < 1500 { 1.0 } else { 0.0 });
    let open = open_of(&x);
    assert_eq!(open.len(), 1, "{open:?}");
    assert!(
        open[0].start.abs_diff(1500) <= 2 && open[0].end == 3000,
        "{open:?}"
    );
}

/// 20 ms must be silent: 12 ms are no open switch.
#[test]
fn a_short_silence_is_no_open_switch() {
    let x = currents(3000, |k| if (1500..1560).contains(&k) { 0.0 } else { 1.0 });
    assert!(open_of(&x).is_empty());
}

/// A current that fades away over a second carries nothing any more in the last 20 ms before the silence.
#[test]
fn what_fades_away_was_not_switched_off() {
    let x = currents(8000, |k| {
        (1.0 - k.saturating_sub(1000) as f64 / 5000.0).max(0.0)
    });
    assert!(open_of(&x).is_empty());
}
