//! Denoises measured or commanded voltages: a smooth amplitude and angle between amplitude steps, plus harmonics.

use super::polynomial::smooth;
use num_complex::Complex64;
use std::ops::Range;

/// Orders that a supply may carry beside its fundamental; 0 is a constant.
const ORDERS: [f64; 4] = [-1.0, 0.0, -5.0, 7.0];
/// Share of the largest voltage below which the supply counts as off.
const OFF: f64 = 0.03;
/// Samples on each side over which the denoised voltage is held against the raw one.
const NEAR: usize = 10;
/// Mean square of the rest, in variances, above which the raw voltage is believed there: twelve standard deviations
/// of the mean square of 21 two-axis samples.
const LOCAL_LIMIT: f64 = 3.6;
/// The rest may exceed the declared noise by this factor before the raw voltage is believed instead.
const WHITE_LIMIT: f64 = 1.25;

/// A denoised supply.
#[derive(Clone, Debug, Default)]
pub(crate) struct Supply {
    /// Denoised voltage vector, V.
    pub u_s: Vec<Complex64>,
    /// Supply frequency, rad/s, one per sample.
    pub omega_sync: Vec<f64>,
    /// Unwrapped angle of the fundamental, rad.
    pub theta: Vec<f64>,
    /// Segments between amplitude steps.
    pub segments: Vec<Range<usize>>,
    /// Whether the voltage could be described by fundamental and harmonics.
    pub denoised: bool,
    /// Samples at which it could not (a switch that opens, a dip): the raw voltage is used there.
    pub raw: Vec<Range<usize>>,
    /// Component of each order relative to the fundamental (order 0: V).
    pub harmonics: Vec<(f64, Complex64)>,
    window: usize,
}

/// Denoises `raw` (V) with noise `sigma` (V, per axis); `omega_rated` (rad/s) sets the windows.
pub(crate) fn denoise(raw: &[Complex64], t_sample: f64, sigma: f64, omega_rated: f64) -> Supply {
    let period = std::f64::consts::TAU / omega_rated / t_sample;
    let window = (period as usize).max(16);
    // An unbalance makes the amplitude ripple: steps are looked for once the harmonics are known and removed.
    let whole = 0..raw.len();
    let first = Supply::described(raw, raw, vec![whole], t_sample, window, 1);
    let clean = first.cleaned(raw);
    let segments = segments(&clean, window / 2, sigma);
    let mut supply = Supply::described(raw, &clean, segments, t_sample, window, 4);
    supply.restore(raw, sigma);
    let restored: usize = supply.raw.iter().map(Range::len).sum();
    let rest = raw.iter().zip(&supply.u_s).map(|(a, b)| (a - b).norm_sqr());
    let described = (raw.len() - restored).max(1);
    let rms = (0.5 * rest.sum::<f64>() / described as f64).sqrt();
    if rms > WHITE_LIMIT * sigma || 2 * restored > raw.len() {
        supply.u_s = raw.to_vec();
        supply.raw.clear();
        supply.denoised = false;
    }
    supply
}

impl Supply {
    /// Fundamental and harmonics of `raw` between known steps; the angle comes from `clean`.
    fn described(
        raw: &[Complex64],
        clean: &[Complex64],
        segments: Vec<Range<usize>>,
        t_sample: f64,
        window: usize,
        rounds: usize,
    ) -> Self {
        let (theta, slope) = angle(clean, &segments, window);
        let mut supply = Self {
            u_s: Vec::new(),
            omega_sync: slope.iter().map(|x| x / t_sample).collect(),
            theta,
            segments,
            denoised: true,
            raw: Vec::new(),
            harmonics: Vec::new(),
            window,
        };
        // Smoothing leaks a little of each harmonic into the fundamental, most at the ends of segments:
        // clean and repeat.
        let mut fundamental = supply.fundamental(clean);
        for _ in 0..rounds {
            supply.harmonics = supply.fit_harmonics(raw, &fundamental);
            supply.u_s = supply.with_harmonics(&fundamental);
            fundamental = supply.fundamental(&supply.cleaned(raw));
        }
        supply.u_s = supply.with_harmonics(&fundamental);
        supply.hold_frequency(&fundamental);
        supply
    }

    /// Takes the raw voltage back where fundamental and harmonics do not describe it.
    fn restore(&mut self, raw: &[Complex64], sigma: f64) {
        let rest: Vec<f64> = raw
            .iter()
            .zip(&self.u_s)
            .map(|(a, b)| (a - b).norm_sqr())
            .collect();
        let limit = LOCAL_LIMIT * 2.0 * sigma * sigma;
        let around = |k: usize| k.saturating_sub(NEAR)..(k + NEAR + 1).min(rest.len());
        let mean = |r: Range<usize>| rest[r.clone()].iter().sum::<f64>() / r.len() as f64;
        // Smoothing smears what it cannot follow over its window, less and less visibly.
        let smeared = |k: usize| {
            let reach = NEAR + self.window;
            k.saturating_sub(reach)..(k + reach + 1).min(rest.len())
        };
        for k in (0..rest.len()).filter(|&k| mean(around(k)) > limit) {
            let near = smeared(k);
            match self.raw.last_mut() {
                Some(last) if near.start <= last.end => last.end = near.end,
                _ => self.raw.push(near),
            }
        }
        for r in &self.raw {
            self.u_s[r.clone()].copy_from_slice(&raw[r.clone()]);
        }
    }

    /// Where the supply is off its angle is noise: the last frequency stays.
    fn hold_frequency(&mut self, fundamental: &[Complex64]) {
        let largest = fundamental.iter().fold(0.0f64, |a, u| a.max(u.norm()));
        let mut last = None;
        for (omega, u) in self.omega_sync.iter_mut().zip(fundamental) {
            if u.norm() > OFF * largest {
                last = Some(*omega);
            } else if let Some(last) = last {
                *omega = last;
            }
        }
    }

    /// `raw` without its harmonics.
    fn cleaned(&self, raw: &[Complex64]) -> Vec<Complex64> {
        let harmonic = |(k, u): (usize, &Complex64)| {
            let amplitude = u.norm();
            u - self.harmonic_sum(k, amplitude)
        };
        raw.iter().enumerate().map(harmonic).collect()
    }

    /// Sum of the harmonics at sample `k` for a fundamental of this amplitude (V).
    fn harmonic_sum(&self, k: usize, amplitude: f64) -> Complex64 {
        let part = |&(order, ratio): &(f64, Complex64)| {
            let size = if order == 0.0 { 1.0 } else { amplitude };
            ratio * Complex64::from_polar(size, order * self.theta[k])
        };
        self.harmonics.iter().map(part).sum()
    }

    /// What the denoising makes of a disturbance of the raw voltage (the operation is linear).
    pub fn filter(&self, disturbance: &[Complex64]) -> Vec<Complex64> {
        if !self.denoised {
            return disturbance.to_vec();
        }
        let mut filtered = self.fundamental(disturbance);
        for r in &self.raw {
            filtered[r.clone()].copy_from_slice(&disturbance[r.clone()]);
        }
        filtered
    }

    /// The fundamental: the envelope in the turning frame, smoothed within each segment.
    fn fundamental(&self, raw: &[Complex64]) -> Vec<Complex64> {
        let turned = |k: usize| raw[k] * Complex64::from_polar(1.0, -self.theta[k]);
        let mut out = Vec::with_capacity(raw.len());
        for segment in &self.segments {
            let envelope: Vec<_> = segment.clone().map(turned).collect();
            let smoothed = smooth(&envelope, self.window).value;
            let back = |(k, e): (usize, Complex64)| e * Complex64::from_polar(1.0, self.theta[k]);
            out.extend(segment.clone().zip(smoothed).map(back));
        }
        out
    }

    /// Ratio of each harmonic to the fundamental, constant over the recording.
    fn fit_harmonics(&self, raw: &[Complex64], fundamental: &[Complex64]) -> Vec<(f64, Complex64)> {
        let one = |order: f64| {
            let (mut num, mut den) = (Complex64::ZERO, 0.0);
            for (k, (u, f)) in raw.iter().zip(fundamental).enumerate() {
                let weight = if order == 0.0 { 1.0 } else { f.norm() };
                num += (u - f) * Complex64::from_polar(weight, -order * self.theta[k]);
                den += weight * weight;
            }
            (order, num / den.max(f64::MIN_POSITIVE))
        };
        ORDERS.into_iter().map(one).collect()
    }

    fn with_harmonics(&self, fundamental: &[Complex64]) -> Vec<Complex64> {
        let at = |(k, f): (usize, &Complex64)| f + self.harmonic_sum(k, f.norm());
        fundamental.iter().enumerate().map(at).collect()
    }
}

/// Unwrapped angle and its slope per sample, smoothed within each segment.
fn angle(raw: &[Complex64], segments: &[Range<usize>], window: usize) -> (Vec<f64>, Vec<f64>) {
    let mut theta = 0.0;
    let mut last = Complex64::new(1.0, 0.0);
    let mut unwrapped = |u: &Complex64| {
        if u.norm_sqr() > 0.0 {
            theta += (u * last.conj()).arg();
            last = *u;
        }
        Complex64::new(theta, 0.0)
    };
    let all: Vec<_> = raw.iter().map(&mut unwrapped).collect();
    let (mut value, mut slope) = (Vec::new(), Vec::new());
    for segment in segments {
        let smoothed = smooth(&all[segment.clone()], 2 * window);
        value.extend(smoothed.value.iter().map(|x| x.re));
        slope.extend(smoothed.slope.iter().map(|x| x.re));
    }
    (value, slope)
}

/// Cuts a recording where the voltage's amplitude jumps.
fn segments(raw: &[Complex64], window: usize, sigma: f64) -> Vec<Range<usize>> {
    let amplitude: Vec<f64> = raw.iter().map(|u| u.norm()).collect();
    let jumps = jumps(&amplitude, window);
    let noise = sigma * (8.0 / window as f64).sqrt();
    let largest = amplitude.iter().fold(0.0f64, |a, &b| a.max(b));
    let limit = (8.0 * noise).max(0.02 * largest);
    let mut cuts = Vec::new();
    let mut k = 0;
    while k < jumps.len() {
        if jumps[k].abs() < limit {
            k += 1;
            continue;
        }
        let end = (k + window).min(jumps.len());
        cuts.push(sharpest(&amplitude, &jumps, k, end));
        // The detector sees a step one window before and after it.
        k = end + window;
    }
    let starts = std::iter::once(0).chain(cuts.iter().copied());
    let ends = cuts.iter().copied().chain(std::iter::once(raw.len()));
    starts
        .zip(ends)
        .filter(|(a, b)| a < b)
        .map(|(a, b)| a..b)
        .collect()
}

/// Difference at each sample between straight lines fitted to the `window` samples after and before it.
fn jumps(x: &[f64], window: usize) -> Vec<f64> {
    let n = window as f64;
    // Value at the near end of a line fitted to n points: weights (4n - 2 - 6k)/(n (n + 1)), k from the near end.
    let weight: Vec<f64> = (0..window)
        .map(|k| (4.0 * n - 2.0 - 6.0 * k as f64) / (n * (n + 1.0)))
        .collect();
    let at = |k: usize| {
        if k < window || k + window > x.len() {
            return 0.0;
        }
        let sum = |j: usize| weight[j] * (x[k + j] - x[k - 1 - j]);
        (0..window).map(sum).sum()
    };
    (0..x.len()).map(at).collect()
}

/// The sample at which the step happens: the largest difference between neighbours near the largest jump.
fn sharpest(amplitude: &[f64], jumps: &[f64], from: usize, to: usize) -> usize {
    let by = |f: &dyn Fn(usize) -> f64, range: Range<usize>| {
        range.max_by(|&a, &b| f(a).total_cmp(&f(b))).unwrap_or(from)
    };
    let centre = by(&|k| jumps[k].abs(), from..to);
    let near = centre.saturating_sub(4).max(1)..(centre + 5).min(amplitude.len());
    by(&|k| (amplitude[k] - amplitude[k - 1]).abs(), near)
}

#[cfg(test)]
#[allow(
    clippy::single_range_in_vec_init,
    reason = "a list of segments may hold one range"
)]
mod tests {
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
            Complex64::from_polar(amplitude, theta)
                + Complex64::from_polar(0.02 * amplitude, -theta)
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
            // The line rises by a half from one sample to the next.
            let expected = if (10..=50).contains(&k) { 0.5 } else { 0.0 };
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
        let (theta, slope) = angle(&turning, &[0..2000], 20);
        for (k, (theta, slope)) in theta.iter().zip(slope).enumerate() {
            assert!((theta - 0.1 * k as f64).abs() < 1e-8);
            assert!((slope - 0.1).abs() < 1e-8);
        }
        let (theta, _) = angle(&[Complex64::ZERO; 50], &[0..50], 20);
        assert!(theta.iter().all(|x| x.abs() < 1e-12));
    }
}
