//! Which stretches: the first one, then again and again the one that is least like all that were taken.

use motor::dynamic::clarke;
use num_complex::Complex64;
use recording::Recording;
use std::ops::Range;

/// Longest recording that is taken whole, s.
pub const LONGEST_WHOLE: f64 = 60.0;
/// Length of a stretch, s.
pub(super) const LENGTH: f64 = 2.0;
/// Number of stretches.
pub(super) const COUNT: usize = 16;
/// Time before a stretch that is simulated and not judged, s: the fluxes settle.
pub(super) const SETTLES: f64 = 0.5;
/// Length of the means whose range tells what changes within a stretch, s: two periods of 50 Hz.
pub(super) const MEAN: f64 = 0.04;
/// Share of the largest value below which a median is no scale: a torque that is zero most of the time.
const SMALL: f64 = 0.05;

/// Samples of a recording that are taken.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// The samples, those included that are not judged.
    pub samples: Range<usize>,
    /// How many of the first ones are not judged.
    pub settles: usize,
}

/// The stretches of a recording that are taken, in their order; `None` where it is short enough to be taken whole.
pub fn stretches(rec: &Recording) -> Option<Vec<Stretch>> {
    let t_sample = rec.t_sample();
    let length = (LENGTH / t_sample).round() as usize;
    if rec.duration() <= LONGEST_WHOLE || length == 0 {
        return None;
    }
    let settles = (SETTLES / t_sample).round() as usize;
    let simulated = |taken: &[usize]| {
        let stretches = merged(taken, length, settles);
        stretches.iter().map(|stretch| stretch.samples.len()).sum()
    };
    let longest = COUNT * (length + settles);
    let taken = least_alike_within(&features(rec, length), COUNT, longest, simulated);
    Some(merged(&taken, length, settles))
}

/// Which stretches of a long recording are fitted and judged, in words; `None` where it is taken whole.
pub fn told(rec: &Recording) -> Option<String> {
    let t_sample = rec.t_sample();
    let judged =
        |s: &Stretch| [s.samples.start + s.settles, s.samples.end].map(|k| k as f64 * t_sample);
    let judged: Vec<[f64; 2]> = stretches(rec)?.iter().map(judged).collect();
    let together: f64 = judged.iter().map(|[from, to]| to - from).sum();
    let parts: Vec<String> = judged
        .iter()
        .map(|[from, to]| format!("{from:.0}..{to:.0}"))
        .collect();
    Some(format!(
        "{together:.0} s of the {:.0} s are used, chosen to differ in load, speed, voltage and time: {} s",
        rec.duration(),
        parts.join(", ")
    ))
}

/// Neighbours among the cells become one stretch, with what comes before it.
fn merged(cells: &[usize], length: usize, settles: usize) -> Vec<Stretch> {
    let mut all: Vec<Stretch> = Vec::new();
    for cell in cells {
        let samples = cell * length..(cell + 1) * length;
        match all.last_mut() {
            Some(last) if last.samples.end == samples.start => last.samples.end = samples.end,
            _ => {
                let settles = settles.min(samples.start);
                let samples = samples.start - settles..samples.end;
                all.push(Stretch { samples, settles });
            }
        }
    }
    all
}

/// The cells that are least alike: `alone`, or as many more as are `simulated` in no more than `longest` samples. Those that follow
/// one another need less time to settle than those that stand alone.
pub(super) fn least_alike_within(
    features: &[Vec<f64>],
    alone: usize,
    longest: usize,
    simulated: impl Fn(&[usize]) -> usize,
) -> Vec<usize> {
    let more = (alone + 1..=features.len()).map(|count| least_alike(features, count));
    let fitting = more.take_while(|taken| simulated(taken) <= longest).last();
    fitting.unwrap_or_else(|| least_alike(features, alone))
}

/// The first cell, then always the one farthest from all that were taken (farthest-first traversal), sorted.
pub(super) fn least_alike(features: &[Vec<f64>], count: usize) -> Vec<usize> {
    let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    let mut nearest = vec![f64::INFINITY; features.len()];
    let mut taken = Vec::new();
    let mut next = 0;
    while taken.len() < count.min(features.len()) {
        taken.push(next);
        for (at, cell) in nearest.iter_mut().zip(features) {
            *at = at.min(distance(cell, &features[next]));
        }
        let farthest = (0..nearest.len()).max_by(|&a, &b| nearest[a].total_cmp(&nearest[b]));
        next = farthest.unwrap_or(0);
    }
    taken.sort_unstable();
    taken.dedup();
    taken
}

/// What each cell is like: time, and mean and range of every quantity, in parts of what is usual in the recording.
fn features(rec: &Recording, length: usize) -> Vec<Vec<f64>> {
    let cells = rec.len() / length;
    let mut all: Vec<Vec<f64>> = (0..cells).map(|k| vec![k as f64 / cells as f64]).collect();
    let piece = ((MEAN / rec.t_sample()).round() as usize).clamp(1, length);
    for quantity in quantities(rec) {
        let means: Vec<Vec<f64>> = (0..cells)
            .map(|k| means(&quantity, k * length..(k + 1) * length, piece))
            .collect();
        let scale = usual(means.iter().flatten().copied());
        for (cell, means) in all.iter_mut().zip(&means) {
            let lowest = means.iter().copied().fold(f64::INFINITY, f64::min);
            let highest = means.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            cell.push(0.5 * (lowest + highest) / scale);
            cell.push((highest - lowest) / scale);
        }
    }
    all
}

/// Amplitudes of voltage and current, speed of the voltage, shaft speed and torque, as far as they were measured.
fn quantities(rec: &Recording) -> Vec<Vec<f64>> {
    let vector = |abc: [&[f64]; 3]| -> Vec<Complex64> {
        let at = |k: usize| clarke(abc.map(|x| x[k]));
        (0..rec.len()).map(at).collect()
    };
    let amplitude = |x: &[Complex64]| x.iter().map(|x| x.norm()).collect::<Vec<f64>>();
    let mut all = Vec::new();
    if let Some(u) = rec.voltages().map(vector) {
        all.push(amplitude(&u));
        let turn = |pair: &[Complex64]| (pair[1] * pair[0].conj()).arg();
        let turns = std::iter::once(0.0).chain(u.windows(2).map(turn));
        all.push(turns.collect());
    }
    all.extend(rec.currents().map(vector).map(|i| amplitude(&i)));
    all.extend(rec.speed().map(<[f64]>::to_vec));
    all.extend(rec.torque().map(<[f64]>::to_vec));
    all
}

fn means(x: &[f64], cell: Range<usize>, piece: usize) -> Vec<f64> {
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    x[cell].chunks_exact(piece).map(mean).collect()
}

/// The median of the magnitudes, or the largest one where most are small.
pub(super) fn usual(x: impl Iterator<Item = f64>) -> f64 {
    let mut x: Vec<f64> = x.map(f64::abs).collect();
    x.sort_by(f64::total_cmp);
    let largest = x.last().copied().unwrap_or(0.0);
    let median = x.get(x.len() / 2).copied().unwrap_or(0.0);
    let scale = if median > SMALL * largest {
        median
    } else {
        largest
    };
    scale.max(f64::MIN_POSITIVE)
}
