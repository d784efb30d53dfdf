//! Where a switch has taken the motor off its supply.

use std::ops::Range;

/// Mean square of a current, in units of its noise, from which it is more than noise ...
const CARRIES: f64 = 20.0;
/// ... and up to which it is only noise: three standard deviations over a period of 200 samples are 1.3.
const NOISE_ONLY: f64 = 1.6;

/// Samples during which the motor is off its supply: the phases carried current, now they carry noise.
///
/// The voltage impulse that forces the current to zero falls between two samples: no model driven by the sampled
/// voltage can follow it. An arc or a snubber that still conducts is no open switch.
pub(super) fn switched_off(
    currents: [&[f64]; 3],
    sigma: [f64; 3],
    t_sample: f64,
) -> Vec<Range<usize>> {
    let window = ((0.02 / t_sample) as usize).max(8);
    let n = currents[0].len();
    let running: Vec<Running> = (0..3)
        .map(|p| Running::new(currents[p], sigma[p]))
        .collect();
    let loudest = |of: &dyn Fn(&Running) -> f64| running.iter().map(of).fold(0.0, f64::max);
    let carried = |k: usize| loudest(&|r| r.power(k - window..k)) > CARRIES;
    let silent = |k: usize| loudest(&|r| r.variance(k..k + window)) < NOISE_ONLY;
    let back = |k: usize| loudest(&|r| r.variance(k..k + 4)) > CARRIES;
    let mut open = Vec::new();
    let mut k = window;
    while k + window < n {
        if silent(k) && carried(k) {
            let end = (k..n - 4).find(|&j| back(j)).unwrap_or(n);
            open.push(k..end);
            k = end;
        }
        k += 1;
    }
    open
}

/// Running sums of a current in units of its noise.
pub(super) struct Running {
    sum: Vec<f64>,
    square: Vec<f64>,
}

impl Running {
    pub(super) fn new(x: &[f64], sigma: f64) -> Self {
        let total = |f: &dyn Fn(f64) -> f64| {
            let mut sum = 0.0;
            let next = |x: &f64| {
                sum += f(x / sigma);
                sum
            };
            std::iter::once(0.0).chain(x.iter().map(next)).collect()
        };
        Self {
            sum: total(&|x| x),
            square: total(&|x| x * x),
        }
    }

    /// Mean square.
    pub(super) fn power(&self, r: Range<usize>) -> f64 {
        (self.square[r.end] - self.square[r.start]) / r.len() as f64
    }

    /// Mean square about the mean: an offset carries no current.
    pub(super) fn variance(&self, r: Range<usize>) -> f64 {
        let mean = (self.sum[r.end] - self.sum[r.start]) / r.len() as f64;
        self.power(r) - mean * mean
    }
}
