//! Lines beside the supply in one current: what broken bars leave, seen without voltage and speed.
//!
//! Bars leave lines at twice the slip frequency below and above the supply (`monitor`, `checks/rotor_bars.rs`). Without a speed
//! the slip is not known, so the clearest line within the slips of a motor is told, and never a verdict: a load that
//! swings leaves the same pair.

use std::f64::consts::TAU;

use num_complex::Complex64;
use schemars::JsonSchema;
use serde::Serialize;

/// What lies beside the supply in one current.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BesideSupply {
    /// Distances from the supply that were looked at, Hz.
    pub looked_hz: [f64; 2],
    /// The smallest line that would have stood clear, percent of the current.
    pub visible_percent: f64,
    /// The clearest line, where one stands clear.
    pub line: Option<SupplySideband>,
}

/// A line beside the supply.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SupplySideband {
    /// Distance from the supply, Hz: twice the slip frequency where bars leave it.
    pub distance_hz: f64,
    /// Amplitude of the line below the supply, percent of the current.
    pub lower_percent: f64,
    /// Amplitude of the line above the supply, percent of the current.
    pub upper_percent: f64,
}

/// Least distance, turns in the recording: nearer, the drift of load and supply covers everything.
const LEAST_TURNS: f64 = 6.0;
/// Most slip at which a motor runs, as in the monitor.
const LARGEST_SLIP: f64 = 0.13;
/// Times the lines beside it that a line must be. Where noise is alike, its power over the mean of four others is distributed as F with 2
/// and 8 degrees of freedom: `(1 + 6^2/4)^-4`, one in ten thousand lines; some hundred are looked at.
const CLEAR: f64 = 6.0;
/// Smallest line that counts, share of the current: below it clamps and converters leave lines of their own.
const LEAST: f64 = 1e-3;
/// Lines of the window beside a line: Hann's main lobe ends after two.
const BESIDE: [i32; 4] = [-4, -3, 3, 4];

/// Looks beside the supply; `None` where the recording is too short for any distance.
pub(super) fn beside_supply(x: &[f64], step: f64, supply_hz: f64) -> Option<BesideSupply> {
    let turned = per_period(x, step, supply_hz);
    let length = turned.len() as f64 / supply_hz;
    let looked_hz = [
        LEAST_TURNS / length,
        (2.0 * LARGEST_SLIP * supply_hz).min(0.4 * supply_hz),
    ];
    if turned.len() < 50 || looked_hz[0] >= looked_hz[1] {
        return None;
    }
    let spectrum = Lines::of(&turned);
    let bins = |hz: f64| hz * length;
    let range = bins(looked_hz[0]).ceil() as i32..=bins(looked_hz[1]).floor() as i32;
    let beside: Vec<(i32, f64)> = range.map(|bin| (bin, spectrum.beside(-bin))).collect();
    let clear = |&&(bin, beside): &&(i32, f64)| {
        let lower = spectrum.amplitude(-bin);
        lower > CLEAR * beside && lower > LEAST
    };
    let line = beside
        .iter()
        .filter(clear)
        .max_by(|(a, _), (b, _)| spectrum.amplitude(-a).total_cmp(&spectrum.amplitude(-b)))
        .map(|&(bin, _)| SupplySideband {
            distance_hz: f64::from(bin) / length,
            lower_percent: 100.0 * spectrum.amplitude(-bin),
            upper_percent: 100.0 * spectrum.amplitude(bin),
        });
    let mut floors: Vec<f64> = beside.iter().map(|(_, beside)| CLEAR * beside).collect();
    floors.sort_by(f64::total_cmp);
    let visible = floors.get(floors.len() / 2).copied()?.max(LEAST);
    Some(BesideSupply {
        looked_hz,
        visible_percent: 100.0 * visible,
        line,
    })
}

/// The current seen from the supply, one value a period (harmonics cancel over whole periods), over its mean; a wrong or drifting frequency and a
/// drifting load are taken out as straight and bent lines of phase and size.
fn per_period(x: &[f64], step: f64, supply_hz: f64) -> Vec<Complex64> {
    let samples = 1.0 / (supply_hz * step);
    let count = (x.len() as f64 / samples).floor() as usize;
    let points: Vec<Complex64> = (0..count)
        .map(|k| {
            let [from, to] = [k, k + 1].map(|k| (k as f64 * samples).round() as usize);
            let turned = |n: usize| Complex64::cis(-TAU * supply_hz * step * n as f64) * x[n];
            let sum: Complex64 = (from..to.min(x.len())).map(turned).sum();
            sum * 2.0 / (to - from).max(1) as f64
        })
        .collect();
    level(&points)
}

/// Divides by what changes slowly: size and phase as parabolas over time.
fn level(points: &[Complex64]) -> Vec<Complex64> {
    let sizes: Vec<f64> = points.iter().map(|z| z.norm()).collect();
    let mut phases: Vec<f64> = Vec::with_capacity(points.len());
    for z in points {
        let last = phases.last().copied().unwrap_or(z.arg());
        let turn = (z.arg() - last + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
        phases.push(last + turn);
    }
    let [sizes, phases] = [sizes, phases].map(|y| parabola(&y));
    let slow = sizes.iter().zip(&phases);
    let level = points
        .iter()
        .zip(slow)
        .map(|(z, (size, phase))| z * Complex64::cis(-phase) / size.max(f64::MIN_POSITIVE));
    level.collect()
}

/// The parabola through values at equal steps, least squares, by Legendre's polynomials on -1 to 1.
fn parabola(y: &[f64]) -> Vec<f64> {
    let at = |k: usize| 2.0 * (k as f64 + 0.5) / y.len() as f64 - 1.0;
    let shapes: [fn(f64) -> f64; 3] = [|_| 1.0, |x| x, |x| 1.5 * x * x - 0.5];
    let weights = shapes.map(|shape| {
        let (mut product, mut square) = (0.0, 0.0);
        for (k, y) in y.iter().enumerate() {
            let value = shape(at(k));
            product += value * y;
            square += value * value;
        }
        product / f64::max(square, f64::MIN_POSITIVE)
    });
    let value = |k: usize| {
        let parts = shapes.iter().zip(weights);
        parts.map(|(shape, weight)| weight * shape(at(k))).sum()
    };
    (0..y.len()).map(value).collect()
}

/// Lines of the levelled current through Hann's window.
struct Lines {
    lines: Vec<Complex64>,
}

impl Lines {
    fn of(points: &[Complex64]) -> Lines {
        let count = points.len();
        let mean = points.iter().sum::<Complex64>() / count as f64;
        let window = |k: usize| 1.0 - (TAU * (k as f64 + 0.5) / count as f64).cos();
        let mut lines: Vec<Complex64> = points
            .iter()
            .enumerate()
            .map(|(k, z)| (z - mean) * window(k))
            .collect();
        fourier::Transform::of(count).forward(&mut lines);
        Lines { lines }
    }

    /// Of a line, whole turns in the recording, negative below the supply: share of the current.
    fn amplitude(&self, bin: i32) -> f64 {
        let count = self.lines.len();
        let place = bin.rem_euclid(count as i32) as usize;
        self.lines[place].norm() / count as f64
    }

    /// Root mean square of the lines beside one.
    fn beside(&self, bin: i32) -> f64 {
        let square = |off: &i32| self.amplitude(bin + off).powi(2);
        (BESIDE.iter().map(square).sum::<f64>() / BESIDE.len() as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64;

    const STEP: f64 = 2e-4;

    /// A current of 10 s with harmonics, a supply that drifts by 0.05 Hz, 0.2 % noise, and a part of the size by time.
    fn current(seed: u64, part: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut noise = || (0..4).map(|_| random.random::<f64>() - 0.5).sum::<f64>() * 0.0035;
        let sample = |k: i32| {
            let t = f64::from(k) * STEP;
            let turned = TAU * (50.02 * t + 0.0025 * t * t);
            let fundamental = (1.0 + 0.01 * t + part(t)) * turned.cos();
            8.0 * (fundamental + 0.04 * (5.0 * turned).cos() + noise())
        };
        (0..50_000).map(sample).collect()
    }

    /// Size swinging by `2 a` makes lines of `a` on both sides.
    #[test]
    fn a_line_within_the_slips_of_a_motor_is_told_with_its_size() {
        let x = current(1, |t| 0.016 * (TAU * 3.3 * t).cos());
        let found = beside_supply(&x, STEP, 50.03).unwrap();
        let line = found.line.unwrap();
        assert!((line.distance_hz - 3.3).abs() < 0.1, "{line:?}");
        // Between two lines of the window a line is up to 15 % too small (Hann).
        assert!((0.66..0.83).contains(&line.lower_percent), "{line:?}");
        assert!((0.66..0.83).contains(&line.upper_percent), "{line:?}");
        assert!(found.visible_percent < 0.2, "{found:?}");
    }

    #[test]
    fn noise_drift_and_steps_of_load_leave_no_line() {
        for seed in 0..60 {
            let quiet = beside_supply(&current(seed, |_| 0.0), STEP, 50.03).unwrap();
            assert_eq!(quiet.line, None, "{seed}: {quiet:?}");
        }
        for at in [1.0, 3.7, 5.0, 8.2] {
            let step = current(7, |t| if t < at { 0.0 } else { 0.2 });
            let stepped = beside_supply(&step, STEP, 50.03).unwrap();
            assert_eq!(stepped.line, None, "{at}: {stepped:?}");
        }
    }

    #[test]
    fn a_recording_that_resolves_nothing_says_nothing() {
        let x = current(1, |_| 0.0);
        assert_eq!(beside_supply(&x[..2_000], STEP, 50.0), None);
        assert_eq!(beside_supply(&[], STEP, 50.0), None);
        assert_eq!(beside_supply(&x[..100], STEP, 1e-3), None);
    }
}
