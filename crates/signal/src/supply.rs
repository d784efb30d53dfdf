//! Denoises measured or commanded voltages: a smooth amplitude and angle between amplitude steps, plus harmonics.

mod steps;

use super::adaptive::{Noisy, Windows};
use super::sample::append;
use super::smoothed::Line;
use num_complex::Complex64;
use std::ops::Range;
use steps::{largest, segments};

/// Orders that a supply commonly carries beside its fundamental; 0 is a constant.
const COMMON: [f64; 4] = [-1.0, 0.0, -5.0, 7.0];
/// Highest order that is looked for where the common ones do not describe a supply ...
const HIGHEST: i32 = 49;
/// ... if it turns through a sampled recording this many times more or less often than all lower orders do: an order
/// above half the sampling rate that looks like no lower one is still told by its samples ...
const RESOLVED: f64 = 4.0;
/// ... and its least size in standard deviations of what noise shows.
const SEEN: f64 = 6.0;
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
pub struct Supply {
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
    /// The window of each sample's envelope, segment after segment.
    windows: Vec<Windows>,
    window: usize,
}

/// Denoises `raw` (V) with noise `sigma` (V, per axis); `omega_rated` (rad/s) sets the windows.
///
/// Where the common harmonics do not describe it, all orders are looked for; where they do not either, the raw voltage is used.
pub fn denoise(raw: &[Complex64], t_sample: f64, sigma: f64, omega_rated: f64) -> Supply {
    let period = std::f64::consts::TAU / omega_rated / t_sample;
    let signal = Signal {
        raw,
        t_sample,
        sigma,
        window: (period as usize).max(16),
    };
    let supply = signal.between_steps(&COMMON);
    if supply.denoised {
        return supply;
    }
    let orders = signal.strong_orders();
    let more = (orders.len() > COMMON.len()).then(|| signal.between_steps(&orders));
    more.filter(|more| more.denoised).unwrap_or(supply)
}

/// A sampled voltage vector and what is known of it.
struct Signal<'a> {
    raw: &'a [Complex64],
    t_sample: f64,
    sigma: f64,
    window: usize,
}

impl Signal<'_> {
    /// The supply between the steps of its amplitude, of these harmonics.
    fn between_steps(&self, orders: &[f64]) -> Supply {
        let (raw, sigma) = (self.raw, self.sigma);
        // An unbalance makes the amplitude ripple: steps are looked for once the harmonics are known and removed.
        let mut clean = self.whole(orders).cleaned(raw);
        if orders.len() > COMMON.len() {
            // Many harmonics turn the angle in which they are found, most at the ends: once more in that of what they leave.
            for _ in 0..2 {
                let whole = 0..raw.len();
                clean = Supply::described(self, &clean, vec![whole], orders, 1).cleaned(raw);
            }
        }
        let segments = segments(&clean, self.window / 2, sigma);
        // Steps spoil the harmonics, and those the angle: once more between them.
        let clean = match segments.len() {
            1 => clean,
            _ => Supply::described(self, raw, segments.clone(), orders, 1).cleaned(raw),
        };
        let mut supply = Supply::described(self, &clean, segments, orders, 4);
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

    /// The supply as if its amplitude had no steps.
    fn whole(&self, orders: &[f64]) -> Supply {
        let whole = 0..self.raw.len();
        Supply::described(self, self.raw, vec![whole], orders, 1)
    }

    /// The common orders, and all that stand out of the noise.
    fn strong_orders(&self) -> Vec<f64> {
        // Strong harmonics turn the angle, in which they show others: once more in the angle of the fundamental alone.
        let coarse = self.strong_in(&self.whole(&COMMON));
        let clean = self.whole(&coarse).cleaned(self.raw);
        let whole = 0..self.raw.len();
        self.strong_in(&Supply::described(self, &clean, vec![whole], &coarse, 1))
    }

    fn strong_in(&self, supply: &Supply) -> Vec<f64> {
        let others = other_orders(&supply.theta);
        let fundamental = supply.fundamental(&supply.cleaned(self.raw));
        let size = fundamental.iter().map(|u| u.norm_sqr()).sum::<f64>().sqrt();
        let found = supply.fit_harmonics(self.raw, &fundamental, &others);
        let strong = found
            .iter()
            .filter(|(_, ratio)| ratio.norm() * size > SEEN * self.sigma);
        let strong = strong.map(|(order, _)| *order);
        COMMON.into_iter().chain(strong).collect()
    }
}

impl Supply {
    /// Fundamental and harmonics of a signal between known steps; the angle comes from `clean`.
    fn described(
        signal: &Signal<'_>,
        clean: &[Complex64],
        segments: Vec<Range<usize>>,
        orders: &[f64],
        rounds: usize,
    ) -> Self {
        let &Signal {
            raw,
            t_sample,
            sigma,
            window,
        } = signal;
        let (theta, slope) = angle(clean, &segments, sigma, window);
        let mut supply = Self {
            u_s: Vec::new(),
            omega_sync: slope.iter().map(|x| x / t_sample).collect(),
            theta,
            segments,
            denoised: true,
            raw: Vec::new(),
            harmonics: Vec::new(),
            windows: Vec::new(),
            window,
        };
        supply.choose_windows(clean, sigma);
        // Smoothing leaks a little of each harmonic into the fundamental, most at the ends of segments:
        // clean and repeat.
        let mut fundamental = supply.fundamental(clean);
        for _ in 0..rounds {
            supply.harmonics = supply.fit_harmonics(raw, &fundamental, orders);
            supply.u_s = supply.with_harmonics(&fundamental);
            let clean = supply.cleaned(raw);
            supply.choose_windows(&clean, sigma);
            fundamental = supply.fundamental(&clean);
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
        let largest = largest(fundamental);
        let mut last = None;
        for (omega, u) in self.omega_sync.iter_mut().zip(fundamental) {
            if u.norm() > OFF * largest {
                last = Some(*omega);
            } else if let Some(last) = last {
                *omega = last;
            }
        }
    }

    /// Parts of the supply, one after the other; each is a segment at least.
    pub fn taken(&self, parts: &[Range<usize>]) -> Self {
        let mut taken = Self {
            denoised: self.denoised,
            harmonics: self.harmonics.clone(),
            window: self.window,
            ..Self::default()
        };
        for part in parts {
            let from = taken.u_s.len();
            let both = |r: &Range<usize>| r.start.max(part.start)..r.end.min(part.end);
            let there = |r: &Range<usize>| r.start + from - part.start..r.end + from - part.start;
            for (k, segment) in self.segments.iter().enumerate() {
                let common = both(segment);
                if common.start < common.end {
                    taken.segments.push(there(&common));
                    let inside = common.start - segment.start..common.end - segment.start;
                    let windows = self.windows.get(k);
                    taken
                        .windows
                        .extend(windows.map(|windows| windows.taken(&[inside])));
                }
            }
            let raw = self.raw.iter().map(both).filter(|r| r.start < r.end);
            taken.raw.extend(raw.map(|r| there(&r)));
            taken.u_s.extend(&self.u_s[part.clone()]);
            taken.omega_sync.extend(&self.omega_sync[part.clone()]);
            taken.theta.extend(&self.theta[part.clone()]);
        }
        taken
    }

    /// This supply and another one behind it, which was denoised alike.
    #[must_use]
    pub fn joined(mut self, other: Self) -> Self {
        let from = self.u_s.len();
        let behind = |r: &Range<usize>| r.start + from..r.end + from;
        append(&mut self.u_s, &other.u_s);
        append(&mut self.omega_sync, &other.omega_sync);
        append(&mut self.theta, &other.theta);
        self.segments.extend(other.segments.iter().map(behind));
        self.raw.extend(other.raw.iter().map(behind));
        self.windows.extend(other.windows);
        self
    }

    /// `raw` without its harmonics: the fundamental, on which their size depends, is what they leave.
    fn cleaned(&self, raw: &[Complex64]) -> Vec<Complex64> {
        let left = |(k, u): (usize, &Complex64)| {
            let harmonics = self.harmonics_at(k);
            // Each time the error falls by the harmonics' share of the fundamental.
            (0..CLEANINGS).fold(*u, |fundamental, _| u - harmonics.beside(fundamental))
        };
        raw.iter().enumerate().map(left).collect()
    }

    /// The harmonics at sample `k`.
    fn harmonics_at(&self, k: usize) -> Harmonics {
        let mut at = Harmonics::default();
        for &(order, ratio) in &self.harmonics {
            match order == 0.0 {
                true => at.constant += ratio,
                false => at.relative += ratio * Complex64::from_polar(1.0, order * self.theta[k]),
            }
        }
        at
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

    /// The envelope of a segment in the turning frame.
    fn envelope(&self, raw: &[Complex64], segment: &Range<usize>) -> Vec<Complex64> {
        let turned = |k: usize| raw[k] * Complex64::from_polar(1.0, -self.theta[k]);
        segment.clone().map(turned).collect()
    }

    /// The longest windows over which the envelope is smooth, one period at least.
    fn choose_windows(&mut self, clean: &[Complex64], sigma: f64) {
        let of_segment = |segment: &Range<usize>| {
            let series = Noisy {
                x: &self.envelope(clean, segment),
                variance: &vec![sigma * sigma; segment.len()],
            };
            Windows::longest(series, self.window, false)
        };
        self.windows = self.segments.iter().map(of_segment).collect();
    }

    /// The same supply at `factor` times the rate: envelope and angle on straight lines between the samples, which the turning
    /// voltage itself is not.
    pub fn finer(&self, factor: usize) -> Self {
        let times = |r: &Range<usize>| r.start * factor..r.end * factor;
        let mut finer = Self {
            theta: refined(self.theta.clone(), factor),
            omega_sync: refined(self.omega_sync.clone(), factor),
            segments: self.segments.iter().map(times).collect(),
            raw: self.raw.iter().map(times).collect(),
            harmonics: self.harmonics.clone(),
            denoised: self.denoised,
            window: self.window * factor,
            ..Self::default()
        };
        let fundamental = self.cleaned(&self.u_s);
        finer.u_s = finer.with_harmonics(&self.refined_vector(&fundamental, &finer.theta, factor));
        finer
    }

    /// A vector that turns with this supply at `factor` times the rate, where the angle is `theta`.
    pub fn refined_vector(&self, x: &[Complex64], theta: &[f64], factor: usize) -> Vec<Complex64> {
        let envelope = |(x, theta): (&Complex64, &f64)| x * Complex64::from_polar(1.0, -theta);
        let envelope: Vec<_> = x.iter().zip(&self.theta).map(envelope).collect();
        let back = |(e, theta): (Complex64, &f64)| e * Complex64::from_polar(1.0, *theta);
        refined(envelope, factor)
            .into_iter()
            .zip(theta)
            .map(back)
            .collect()
    }

    /// The fundamental: the envelope in the turning frame, smoothed within each segment.
    fn fundamental(&self, raw: &[Complex64]) -> Vec<Complex64> {
        let mut out = Vec::with_capacity(raw.len());
        for (segment, windows) in self.segments.iter().zip(&self.windows) {
            let smoothed: Vec<Complex64> = windows.smooth(&self.envelope(raw, segment));
            let back = |(k, e): (usize, Complex64)| e * Complex64::from_polar(1.0, self.theta[k]);
            out.extend(segment.clone().zip(smoothed).map(back));
        }
        out
    }

    /// Ratio of each harmonic to the fundamental, constant over the recording.
    fn fit_harmonics(
        &self,
        raw: &[Complex64],
        fundamental: &[Complex64],
        orders: &[f64],
    ) -> Vec<(f64, Complex64)> {
        // Where the supply is off its angle is noise, and so is what turns with it.
        let off = OFF * largest(fundamental);
        let one = |&order: &f64| {
            let (mut num, mut den) = (Complex64::ZERO, 0.0);
            let on = raw.iter().zip(fundamental).enumerate();
            for (k, (u, f)) in on.filter(|(_, (_, f))| f.norm() > off) {
                let weight = if order == 0.0 { 1.0 } else { f.norm() };
                num += (u - f) * Complex64::from_polar(weight, -order * self.theta[k]);
                den += weight * weight;
            }
            (order, num / den.max(f64::MIN_POSITIVE))
        };
        orders.iter().map(one).collect()
    }

    fn with_harmonics(&self, fundamental: &[Complex64]) -> Vec<Complex64> {
        let at = |(k, f): (usize, &Complex64)| f + self.harmonics_at(k).beside(*f);
        fundamental.iter().enumerate().map(at).collect()
    }
}

/// Orders beside the common ones that samples at these angles of the fundamental (rad) tell from every lower order.
fn other_orders(theta: &[f64]) -> Vec<f64> {
    let turned = theta.last().zip(theta.first());
    let turned = turned.map_or(0.0, |(last, first)| (last - first).abs()) / std::f64::consts::TAU;
    // Turns that samples show: whole turns between two samples are not seen.
    let apart = |a: f64, b: f64| {
        let (turns, samples) = ((a - b) * turned, theta.len() as f64);
        (turns - samples * (turns / samples).round()).abs()
    };
    let mut told: Vec<f64> = COMMON.into_iter().chain([1.0]).collect();
    let known = told.len();
    for order in (2..=HIGHEST).flat_map(|k| [-k, k]).map(f64::from) {
        if told.iter().all(|&lower| apart(order, lower) > RESOLVED) {
            told.push(order);
        }
    }
    told.split_off(known)
}

/// Times that harmonics are taken from a voltage: supplies carry a tenth of harmonics at most, a ten thousandth is left.
const CLEANINGS: usize = 4;

/// Sum of the harmonics at one sample.
#[derive(Clone, Copy, Debug, Default)]
struct Harmonics {
    /// Order 0, V.
    constant: Complex64,
    /// The others, relative to the fundamental.
    relative: Complex64,
}

impl Harmonics {
    /// The harmonics beside this fundamental, V.
    fn beside(self, fundamental: Complex64) -> Complex64 {
        self.constant + self.relative * fundamental.norm()
    }
}

/// A series at `factor` times the rate, 1 or more, on straight lines between its samples.
pub fn refined<T>(x: Vec<T>, factor: usize) -> Vec<T>
where
    T: Copy
        + std::ops::Add<Output = T>
        + std::ops::Sub<Output = T>
        + std::ops::Mul<f64, Output = T>,
{
    if factor == 1 {
        return x;
    }
    let line = |pair: &[T]| {
        let (first, step) = (pair[0], (pair[1] - pair[0]) * (1.0 / factor as f64));
        (0..factor).map(move |k| first + step * k as f64)
    };
    x.windows(2)
        .flat_map(line)
        .chain(x.last().copied())
        .collect()
}

/// Unwrapped angle and its slope per sample, smoothed within each segment.
fn angle(
    raw: &[Complex64],
    segments: &[Range<usize>],
    sigma: f64,
    window: usize,
) -> (Vec<f64>, Vec<f64>) {
    let mut theta = 0.0;
    let mut last = Complex64::new(1.0, 0.0);
    let mut unwrapped = |u: &Complex64| {
        if u.norm_sqr() > 0.0 {
            theta += (u * last.conj()).arg();
            last = *u;
        }
        theta
    };
    let all: Vec<f64> = raw.iter().map(&mut unwrapped).collect();
    let (mut value, mut slope) = (Vec::new(), Vec::new());
    for segment in segments {
        // Noise across a vector turns it by its share of the length.
        let noise = |k: usize| sigma * sigma / raw[k].norm_sqr().max(f64::MIN_POSITIVE);
        let series = Noisy {
            x: &all[segment.clone()],
            variance: &segment.clone().map(noise).collect::<Vec<_>>(),
        };
        let smoothed: Vec<Line> = Windows::longest(series, 2 * window, false).smooth(series.x);
        value.extend(smoothed.iter().map(|line| line.value));
        slope.extend(smoothed.iter().map(|line| line.slope));
    }
    (value, slope)
}

#[cfg(test)]
#[allow(
    clippy::single_range_in_vec_init,
    reason = "a list of segments may hold one range"
)]
mod tests;
