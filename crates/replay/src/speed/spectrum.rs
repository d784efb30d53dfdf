//! The spectrum of one block over orders, multiples of the supply's frequency, in units of the noise around each line.

use std::f64::consts::TAU;

use fourier::Transform;
use num_complex::Complex64;

/// Points of the spectrum in one bin: lines are found between bins.
pub(super) const PADDING: usize = 4;
/// Bins on both sides of a harmonic that it covers: its main lobe (Hann), and skirts of a swinging load.
pub(super) const LOBE_BINS: f64 = 3.0;
/// Stretches of noise in one order; the noise of a point is the median over its stretch and the two beside it.
const STRETCHES: usize = 4;

/// One block's spectrum.
pub(super) struct Spectrum {
    /// Power over the noise around it, each point; 1 on average where there is only noise.
    white: Vec<f32>,
    /// Power, each point.
    pub power: Vec<f32>,
    /// Noise of each stretch, in units of `power`.
    noise: Vec<f64>,
    /// Points in one order.
    per_order: usize,
}

/// Hann's window.
pub(super) fn hann(length: usize) -> Vec<f64> {
    let one = |k: usize| 0.5 - 0.5 * (TAU * (k as f64 + 0.5) / length as f64).cos();
    (0..length).map(one).collect()
}

/// Whether a harmonic of the supply covers an order in blocks of `cycles`.
pub(super) fn is_harmonic(order: f64, cycles: usize) -> bool {
    (order - order.round()).abs() * (cycles as f64) < LOBE_BINS
}

impl Spectrum {
    /// Of samples that are windowed already; `cycles` of the supply long, with `PADDING` times as many points.
    pub fn of(
        windowed: &[Complex64],
        cycles: usize,
        energy: f64,
        transform: &Transform,
    ) -> Spectrum {
        let mut points = windowed.to_vec();
        points.resize(transform.count(), Complex64::ZERO);
        transform.forward(&mut points);
        let power: Vec<f32> = points
            .iter()
            .map(|x| (x.norm_sqr() / energy) as f32)
            .collect();
        let per_order = PADDING * cycles;
        let noise = noise(&power, per_order, cycles);
        let stretch = per_order / STRETCHES;
        let white = power
            .iter()
            .enumerate()
            .map(|(k, p)| (f64::from(*p) / noise[(k / stretch).min(noise.len() - 1)]) as f32)
            .collect();
        Spectrum {
            white,
            power,
            noise,
            per_order,
        }
    }

    /// Power over noise at an order; negative ones turn backwards.
    pub fn white(&self, order: f64) -> f64 {
        let at = self.place(order);
        let first = at.floor() as usize;
        let one = |k: usize| f64::from(self.white[k % self.white.len()]);
        one(first) + (at - first as f64) * (one(first + 1) - one(first))
    }

    /// Power over noise, point by point.
    pub fn white_points(&self) -> impl Iterator<Item = f64> {
        self.white.iter().map(|x| f64::from(*x))
    }

    /// Noise around an order.
    pub fn noise(&self, order: f64) -> f64 {
        let stretch = self.place(order) as usize / (self.per_order / STRETCHES);
        self.noise[stretch.min(self.noise.len() - 1)]
    }

    /// Nearest point of an order.
    pub fn point(&self, order: f64) -> usize {
        self.place(order).round() as usize % self.white.len()
    }

    fn place(&self, order: f64) -> f64 {
        (order * self.per_order as f64).rem_euclid(self.white.len() as f64)
    }
}

/// Medians of the stretches without the harmonics of the supply, as means of the exponential distribution.
fn noise(power: &[f32], per_order: usize, cycles: usize) -> Vec<f64> {
    let stretch = per_order / STRETCHES;
    let calm = |k: &usize| !is_harmonic(*k as f64 / per_order as f64, cycles);
    let count = power.len() / stretch;
    let one = |n: usize| {
        let near = [n + count - 1, n, n + 1].into_iter().flat_map(|m| {
            let first = (m % count) * stretch;
            first..first + stretch
        });
        let mut values: Vec<f32> = near.filter(calm).map(|k| power[k]).collect();
        let middle = values.len() / 2;
        let (_, median, _) = values.select_nth_unstable_by(middle, f32::total_cmp);
        (f64::from(*median) / std::f64::consts::LN_2).max(f64::MIN_POSITIVE)
    };
    (0..count).map(one).collect()
}
