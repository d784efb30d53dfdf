//! Where a switch has taken the motor off its supply.

use std::ops::Range;

/// Mean square of a current, in units of its noise, from which it is more than noise ...
const CARRIES: f64 = 20.0;
/// ... and up to which it is only noise: three standard deviations over a period of 200 samples are 1.3.
const NOISE_ONLY: f64 = 1.6;
/// Square of a channel's offset over that of the current before, up to which it can be an offset: a drive that holds a motor with
/// direct current carries more.
const OFFSET: f64 = 0.06;
/// Parts of a silent period whose means are compared ...
const PARTS: usize = 8;
/// ... and their variance, in units of the noise of one sample, up to which nothing but noise and some hum moves them: a current
/// that swings slowly through zero, behind a drive that has just started, is carried all the time.
const HUM: f64 = 0.2;
/// Variance of the means of parts of white noise, seven degrees of freedom, over its expectation: exceeded once in 300 periods.
const MEANS_OF_NOISE: f64 = 3.0;

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
    let moves = HUM + MEANS_OF_NOISE / (window / PARTS) as f64;
    let is_open = |k: usize| {
        let (before, now) = (k - window..k, k..k + window);
        let carried = loudest(&|r| r.power_about(r.mean(now.clone()), before.clone()));
        loudest(&|r| r.variance(now.clone())) < NOISE_ONLY
            && carried > CARRIES
            && loudest(&|r| r.mean(now.clone()).powi(2)) < OFFSET * carried
            && loudest(&|r| r.swing(now.clone())) < moves
    };
    let back = |level: &Range<usize>, j: usize| {
        loudest(&|r| r.power_about(r.mean(level.clone()), j..j + 4)) > CARRIES
    };
    let mut open = Vec::new();
    let mut k = window;
    while k + window < n {
        if is_open(k) {
            let level = k..k + window;
            let end = (k..n - 4).find(|&j| back(&level, j)).unwrap_or(n);
            open.push(k..end);
            k = end;
        }
        k += 1;
    }
    open
}

/// Running sums of a current in units of its noise.
struct Running {
    sum: Vec<f64>,
    square: Vec<f64>,
}

impl Running {
    fn new(x: &[f64], sigma: f64) -> Self {
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

    /// Mean.
    fn mean(&self, r: Range<usize>) -> f64 {
        (self.sum[r.end] - self.sum[r.start]) / r.len() as f64
    }

    /// Mean square.
    fn power(&self, r: Range<usize>) -> f64 {
        (self.square[r.end] - self.square[r.start]) / r.len() as f64
    }

    /// Mean square about a level: the offset of a channel carries no current.
    fn power_about(&self, level: f64, r: Range<usize>) -> f64 {
        self.power(r.clone()) - level * (2.0 * self.mean(r) - level)
    }

    /// Mean square about the mean.
    pub(super) fn variance(&self, r: Range<usize>) -> f64 {
        self.power_about(self.mean(r.clone()), r)
    }

    /// Variance of the means of equal parts.
    fn swing(&self, r: Range<usize>) -> f64 {
        let part = r.len() / PARTS;
        let means: [f64; PARTS] = std::array::from_fn(|n| {
            let start = r.start + n * part;
            self.mean(start..start + part)
        });
        let middle = means.iter().sum::<f64>() / PARTS as f64;
        let squares = means.iter().map(|mean| (mean - middle).powi(2));
        squares.sum::<f64>() / (PARTS - 1) as f64
    }
}

#[cfg(test)]
mod tests;
