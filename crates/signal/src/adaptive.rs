//! Smoothing with windows that are as long as the signal allows.
//!
//! A local quadratic over a short window keeps the signal and much of the noise; over a long one it loses both. Each
//! sample gets the longest window, of a series that doubles, over which the signal is a quadratic as far as its noise
//! can tell. On a constant load the noise of an input is the only thing that moves a model; what is left of it biases
//! the parameters that damp it (leakage, inertia).

use super::polynomial::{reach, smooth_where};
use crate::dot::dot;
use crate::sample::Sample;
use crate::smoothed::Smoothed;
use std::borrow::Cow;
use std::ops::{Add, Mul, Range};

/// Orders of the polynomials that a quadratic leaves over and that are looked for in a window: kinks, steps and up to
/// three swings.
const ORDERS: std::ops::RangeInclusive<usize> = 3..=6;
/// Sum of squares of their four coefficients, or of the eight of a signal of two axes, in variances, above which the window
/// is too long: chance exceeds it in one window of a hundred (chi-square).
const LIMITS: [f64; 2] = [13.3, 20.1];

/// So many limits are no chance, however few windows exceed them: one in a million.
const FAR: f64 = 2.5;

/// A series of samples and its white noise.
#[derive(Clone, Copy, Debug)]
pub struct Noisy<'a, T> {
    /// Samples.
    pub x: &'a [T],
    /// Variance of the noise of each sample, per axis.
    pub variance: &'a [f64],
}

/// The window of each sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Windows {
    /// 0: the sample itself; `k`: the shortest window times `2^(k - 1)`.
    level: Vec<u8>,
    /// Shortest window, samples.
    shortest: usize,
}

impl Windows {
    /// The longest windows over which a series is a quadratic as far as its noise can tell; none is shorter than
    /// `shortest` samples, except that a sample is left as it is where not even that holds and `may_be_raw`.
    pub fn longest<T: Sample>(series: Noisy<'_, T>, shortest: usize, may_be_raw: bool) -> Self {
        let limit = LIMITS[T::AXES - 1];
        let mut level = vec![u8::from(!may_be_raw); series.x.len()];
        let mut means = series.x.to_vec();
        let mut variance = series.variance.to_vec();
        for number in 1.. {
            if means.len() < shortest.max(5) && number > 1 {
                break;
            }
            let quadratic = without_chance(&misfits(&means, &variance, shortest), limit, shortest);
            let mut any = number == 1;
            for (k, at) in level.iter_mut().enumerate() {
                let block = (k >> (number - 1)).min(quadratic.len() - 1);
                if *at + 1 >= number && quadratic[block] {
                    *at = (*at).max(number);
                }
                any |= *at == number;
            }
            if !any {
                break;
            }
            means = halved(&means);
            variance = halved(&variance).iter().map(|v| 0.5 * v).collect();
        }
        Self { level, shortest }
    }

    /// Smooths a series with these windows: its values, or its [`Line`](crate::Line)s; the operation is linear.
    pub fn smooth<S: Smoothed>(&self, x: &[S::Of]) -> Vec<S> {
        let mut out: Vec<S> = x.iter().map(|x| S::raw(*x)).collect();
        let mut means = Cow::Borrowed(x);
        for number in 1..=self.level.iter().copied().max().unwrap_or(0) {
            let mine = || (0..self.level.len()).filter(|&k| self.level[k] == number);
            let mut needed = vec![false; means.len()];
            for Blocks { first, next, .. } in mine().map(|k| blocks(means.len(), k, number - 1)) {
                (needed[first], needed[next]) = (true, true);
            }
            let smoothed: Vec<S> = smooth_where(&means, self.shortest, |k| needed[k]);
            for k in mine() {
                out[k] = between_blocks(&smoothed, k, number - 1);
            }
            means = Cow::Owned(halved(&means));
        }
        out
    }

    /// The windows of some parts of the series, one after the other; none is longer than what is taken.
    pub fn taken(&self, parts: &[Range<usize>]) -> Self {
        let part = |r: &Range<usize>| self.level.get(r.clone()).unwrap_or_default();
        let mut level: Vec<u8> = parts.iter().flat_map(part).copied().collect();
        let longest = longest_of(level.len(), self.shortest);
        level.iter_mut().for_each(|at| *at = (*at).min(longest));
        Self {
            level,
            shortest: self.shortest,
        }
    }

    /// The windows of this signal and of another one behind it, which were smoothed alike.
    #[must_use]
    pub fn joined(&self, other: &Self) -> Self {
        Self {
            level: [&self.level[..], &other.level].concat(),
            shortest: self.shortest,
        }
    }
}

/// The longest windows of a signal of one axis with noise of the standard deviation `sigma`.
pub fn longest_real(x: &[f64], sigma: f64, shortest: usize, may_be_raw: bool) -> Windows {
    let variance = &vec![sigma * sigma; x.len()];
    Windows::longest(Noisy { x, variance }, shortest, may_be_raw)
}

/// Level of the longest window that a series of `samples` can hold.
fn longest_of(samples: usize, shortest: usize) -> u8 {
    let holds = |number: &u8| samples >> (number - 1) >= shortest.max(5);
    (1..=63).take_while(holds).last().unwrap_or(1)
}

/// Means of neighbouring pairs; an odd last one is left out.
fn halved<T>(x: &[T]) -> Vec<T>
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    let mean = |pair: &[T]| (pair[0] + pair[1]) * 0.5;
    x.chunks_exact(2).map(mean).collect()
}

/// The two means between which a sample stands.
struct Blocks {
    first: usize,
    next: usize,
    /// Its way from the first to the next, 0 to 1; beyond at the ends.
    share: f64,
    /// Samples of one mean.
    length: f64,
}

/// Where sample `k` stands in a series of `count` means of `2^halvings` samples.
fn blocks(count: usize, k: usize, halvings: u8) -> Blocks {
    let length = f64::from(1u32 << halvings);
    let last = count - 1;
    // A block stands at the mean position of its samples.
    let at = (k as f64 - 0.5 * (length - 1.0)) / length;
    let first = (at.max(0.0) as usize).min(last.saturating_sub(1));
    Blocks {
        first,
        next: (first + 1).min(last),
        share: at - first as f64,
        length,
    }
}

/// At sample `k` of a series whose points are means of `2^halvings` samples.
fn between_blocks<S: Smoothed>(smoothed: &[S], k: usize, halvings: u8) -> S {
    let Blocks {
        first,
        next,
        share,
        length,
    } = blocks(smoothed.len(), k, halvings);
    let there = smoothed[first].towards(smoothed[next], share);
    there.of_means(length)
}

/// How much more than a quadratic the window around each point holds, in variances of the noise.
fn misfits<T: Sample>(x: &[T], variance: &[f64], window: usize) -> Vec<f64> {
    let Some(reach) = reach(x.len(), window) else {
        return vec![0.0; x.len()];
    };
    let polynomials = left_over(reach.window);
    let of_window = |first: usize| {
        let part = first..first + reach.window;
        let noise = variance[part.clone()].iter().sum::<f64>() / reach.window as f64;
        let coefficients = polynomials.iter().map(|p| dot(p, &x[part.clone()]));
        let squares = coefficients.map(T::square);
        squares.sum::<f64>() / noise.max(f64::MIN_POSITIVE)
    };
    let last = x.len() - reach.window;
    let mut out = vec![0.0; x.len()];
    let mut k = 0;
    while k < x.len() {
        let end = (k + reach.stride).min(x.len());
        let middle = (k + end - 1) / 2;
        let misfit = of_window(middle.saturating_sub(reach.window / 2).min(last));
        out[k..end].fill(misfit);
        k = end;
    }
    out
}

/// Where a window holds a quadratic: what bends the signal is seen by the windows around it, so that fewer neighbours than
/// half a window exceed the limit by chance, unless by far.
fn without_chance(misfit: &[f64], limit: f64, window: usize) -> Vec<bool> {
    let half = window / 2;
    // Nearer to an end than half a window all points share one window.
    let own = half..misfit.len().saturating_sub(half).max(half + 1);
    let mut out = vec![true; misfit.len()];
    let mut k = 0;
    while k < misfit.len() {
        let end = (k..misfit.len())
            .find(|&j| misfit[j] < limit)
            .unwrap_or(misfit.len());
        let windows = end.min(own.end).saturating_sub(k.max(own.start));
        let far = misfit[k..end].iter().any(|&m| m > FAR * limit);
        if windows > half || far {
            out[k..end].fill(false);
        }
        k = end + 1;
    }
    out
}

/// Orthonormal polynomials of [`ORDERS`] over `n` equally spaced points.
fn left_over(n: usize) -> Vec<Vec<f64>> {
    let mut found: Vec<Vec<f64>> = Vec::new();
    let x = |k: usize| 2.0 * (k as f64 + 0.5) / n as f64 - 1.0;
    for order in 0..=*ORDERS.end() {
        let mut p: Vec<f64> = match found.last() {
            None => vec![1.0; n],
            Some(last) => last.iter().enumerate().map(|(k, p)| p * x(k)).collect(),
        };
        for lower in &found {
            let along = dot(lower, &p);
            p.iter_mut().zip(lower).for_each(|(p, l)| *p -= along * l);
        }
        let length = dot(&p, &p).sqrt().max(f64::MIN_POSITIVE);
        p.iter_mut().for_each(|p| *p /= length);
        debug_assert_eq!(found.len(), order);
        found.push(p);
    }
    found.split_off(*ORDERS.start())
}

#[cfg(test)]
mod tests;
