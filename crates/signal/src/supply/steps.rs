//! Steps of the amplitude of a supply.

use num_complex::Complex64;
use std::ops::Range;

/// Share of the largest amplitude that is a step, where a whole window on both sides shows it ...
const STEP: f64 = 0.02;
/// ... and where fewer samples do, on which harmonics ripple: a switch that closes or opens.
const SWITCH: f64 = 0.5;

/// Cuts a recording where the voltage's amplitude jumps.
pub(super) fn segments(raw: &[Complex64], window: usize, sigma: f64) -> Vec<Range<usize>> {
    let amplitude: Vec<f64> = raw.iter().map(|u| u.norm()).collect();
    let jumps = jumps(&amplitude, window);
    let largest = largest(raw);
    let limit = |k: usize| {
        let there = at_hand(raw.len(), k, window);
        let noise = sigma * (8.0 / there.max(1) as f64).sqrt();
        let share = if there < window { SWITCH } else { STEP };
        (share * largest).max(8.0 * noise)
    };
    let mut cuts = Vec::new();
    let mut k = 0;
    while k < jumps.len() {
        if jumps[k].abs() < limit(k) {
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

/// Fewest samples beside a step that show it.
const LEAST_WINDOW: usize = 4;

/// Samples of a window that there are both before and after sample `k` of `n`.
fn at_hand(n: usize, k: usize, window: usize) -> usize {
    window.min(k).min(n - k)
}

/// Difference at each sample between straight lines fitted to the `window` samples after and before it, or to as many as
/// there are; zero with too few.
pub(super) fn jumps(x: &[f64], window: usize) -> Vec<f64> {
    // Value at the near end of a line fitted to n points: weights (4n - 2 - 6k)/(n (n + 1)), k from the near end.
    let weights = |window: usize| -> Vec<f64> {
        let n = window as f64;
        let weight = |k: usize| (4.0 * n - 2.0 - 6.0 * k as f64) / (n * (n + 1.0));
        (0..window).map(weight).collect()
    };
    let whole = weights(window);
    let at = |k: usize| {
        let there = at_hand(x.len(), k, window);
        if there < LEAST_WINDOW {
            return 0.0;
        }
        let difference = |weight: &[f64]| -> f64 {
            let sides = weight.iter().enumerate();
            sides.map(|(j, w)| w * (x[k + j] - x[k - 1 - j])).sum()
        };
        match there == window {
            true => difference(&whole),
            false => difference(&weights(there)),
        }
    };
    (0..x.len()).map(at).collect()
}

/// The sample at which the step happens: the largest difference between neighbours near the largest jump.
pub(super) fn sharpest(amplitude: &[f64], jumps: &[f64], from: usize, to: usize) -> usize {
    let by = |f: &dyn Fn(usize) -> f64, range: Range<usize>| {
        range.max_by(|&a, &b| f(a).total_cmp(&f(b))).unwrap_or(from)
    };
    let centre = by(&|k| jumps[k].abs(), from..to);
    let near = centre.saturating_sub(4).max(1)..(centre + 5).min(amplitude.len());
    by(&|k| (amplitude[k] - amplitude[k - 1]).abs(), near)
}

/// The largest amplitude, V.
pub(super) fn largest(u: &[Complex64]) -> f64 {
    u.iter().fold(0.0f64, |a, u| a.max(u.norm()))
}
