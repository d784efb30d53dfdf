//! Samples that an interference put far off their neighbours, bridged by straight lines.
//!
//! A shaft has inertia: a speed that leaves its neighbours for some samples and comes back was not the shaft's. A voltage or
//! current may jump, but one that for up to three samples reaches three times what its neighbours and the recording show was
//! not the motor's either.

use recording::{Bridged, Column, Quantity};
use std::ops::Range;

/// Samples on either side that a speed is compared with: their median stands through half of them being wrong.
const AROUND: usize = 5;
/// A speed is off from this share of its usual size on, ...
const OFF: f64 = 0.05;
/// ... and from this many standard deviations of its noise, and steps of its neighbours, of which a quarter is smaller.
const OFF_SIGMAS: f64 = 12.0;
const OFF_STEPS: f64 = 16.0;
/// Passes: several spikes within a few samples hide each other.
const PASSES: usize = 4;
/// Share of the samples beyond which these are no spikes but the channel itself.
const MOST: f64 = 0.2;
/// An encoder that is read too often shows one and the same pulse over and over: so many samples of so few values.
const PULSES: (usize, usize) = (20, 3);
/// Longest spike of a voltage or current, in samples.
const LONGEST: usize = 3;
/// A spike of a voltage or current over its neighbours, and over what 99 % of the recording stay below.
const BEYOND: f64 = 3.0;
/// Neighbours on either side of it.
const NEIGHBOURS: usize = 10;
/// Share of voltages or currents that may be spikes.
const MOST_ELECTRICAL: f64 = 0.01;
/// Fewer samples than this are not looked at.
const FEWEST: usize = 4 * AROUND;

/// Replaces spikes by straight lines between their neighbours; says how many of the samples in `kept`, where there were any.
pub(in crate::read) fn bridge(
    t: &[f64],
    x: &mut Column,
    quantity: Quantity,
    kept: &Range<usize>,
) -> Option<Bridged> {
    if x.len() < FEWEST {
        return None;
    }
    let find: fn(&[f64]) -> Vec<usize> = match quantity {
        Quantity::Speed => of_speed,
        Quantity::Voltage | Quantity::Current => electrical,
        _ => return None,
    };
    let mut bridged: Option<Bridged> = None;
    for _ in 0..PASSES {
        let spikes = find(x);
        if spikes.is_empty() {
            break;
        }
        note(t, x, &spikes, kept, &mut bridged);
        let x = x.to_mut();
        runs(&spikes).into_iter().for_each(|run| line(t, x, run));
    }
    bridged
}

fn note(
    t: &[f64],
    x: &[f64],
    spikes: &[usize],
    kept: &Range<usize>,
    bridged: &mut Option<Bridged>,
) {
    let spikes = spikes.iter().copied().filter(|k| kept.contains(k));
    let farther = |a: &usize, b: &usize| x[*a].abs().total_cmp(&x[*b].abs());
    let Some(at) = spikes.clone().max_by(farther) else {
        return;
    };
    let so_far = bridged.get_or_insert(Bridged {
        samples: 0,
        farthest: x[at],
        at_s: t[at],
    });
    so_far.samples += spikes.count();
    if x[at].abs() > so_far.farthest.abs() {
        (so_far.farthest, so_far.at_s) = (x[at], t[at]);
    }
}

fn of_speed(x: &[f64]) -> Vec<usize> {
    // What is below a share of the slowest speed is below that of the usual one, too.
    let slowest = x
        .iter()
        .fold(f64::INFINITY, |slowest, x| x.abs().min(slowest));
    if x.windows(2)
        .all(|pair| (pair[1] - pair[0]).abs() <= OFF * slowest)
    {
        return Vec::new();
    }
    let steps: Vec<f64> = x.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let sigma = median(&steps) / (0.674_5 * std::f64::consts::SQRT_2);
    let sizes: Vec<f64> = x.iter().map(|x| x.abs()).collect();
    let limit = (OFF * median(&sizes)).max(OFF_SIGMAS * sigma);
    if steps.iter().all(|step| *step <= limit) {
        return Vec::new();
    }
    let off: Vec<usize> = (0..x.len())
        .filter(|k| is_off(x, &steps, *k, limit))
        .collect();
    let mut values: Vec<f64> = off.iter().map(|k| x[*k]).collect();
    values.sort_unstable_by(f64::total_cmp);
    values.dedup();
    let pulses = off.len() >= PULSES.0 && values.len() <= PULSES.1;
    if pulses || off.len() as f64 > MOST * x.len() as f64 {
        return Vec::new();
    }
    off
}

fn is_off(x: &[f64], steps: &[f64], k: usize, limit: f64) -> bool {
    let from = k.saturating_sub(AROUND).min(x.len() - 2 * AROUND - 1);
    let off = (x[k] - median(&x[from..=from + 2 * AROUND])).abs();
    let mut near = steps[from..from + 2 * AROUND].to_vec();
    let quarter = *near.select_nth_unstable_by(AROUND / 2, f64::total_cmp).1;
    off > limit && off > OFF_STEPS * quarter
}

fn electrical(x: &[f64]) -> Vec<usize> {
    // Where more than a hundredth is larger than a third of the largest, nothing is three times what 99 % stay below.
    let largest = x.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let many = x.iter().filter(|x| BEYOND * x.abs() >= largest).count();
    if many > x.len() - x.len() * 99 / 100 {
        return Vec::new();
    }
    let mut sizes: Vec<f64> = x.iter().map(|x| x.abs()).collect();
    let at = sizes.len() * 99 / 100;
    let usual = *sizes.select_nth_unstable_by(at, f64::total_cmp).1;
    let off: Vec<usize> = (0..x.len())
        .filter(|k| x[*k].abs() > BEYOND * usual)
        .collect();
    let lonely = |run: &Range<usize>| {
        let least = x[run.clone()]
            .iter()
            .fold(f64::INFINITY, |least: f64, x| least.min(x.abs()));
        let before = run.start.saturating_sub(NEIGHBOURS)..run.start;
        let after = run.end..(run.end + NEIGHBOURS).min(x.len());
        run.len() <= LONGEST && before.chain(after).all(|k| BEYOND * x[k].abs() < least)
    };
    let spikes: Vec<usize> = runs(&off).into_iter().filter(lonely).flatten().collect();
    if spikes.len() as f64 > MOST_ELECTRICAL * x.len() as f64 {
        return Vec::new();
    }
    spikes
}

/// Neighbouring indices as ranges.
fn runs(indices: &[usize]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for k in indices {
        match runs.last_mut() {
            Some(last) if last.end == *k => last.end += 1,
            _ => runs.push(*k..k + 1),
        }
    }
    runs
}

/// A straight line over a range; the nearest value where one end is missing.
fn line(t: &[f64], x: &mut [f64], run: Range<usize>) {
    let before = run.start.checked_sub(1).map(|k| (t[k], x[k]));
    let after = x.get(run.end).map(|x| (t[run.end], *x));
    let (before, after) = match (before, after) {
        (Some(before), Some(after)) => (before, after),
        (Some(one), None) | (None, Some(one)) => (one, (one.0 + 1.0, one.1)),
        (None, None) => return,
    };
    for k in run {
        x[k] = before.1 + (after.1 - before.1) * (t[k] - before.0) / (after.0 - before.0);
    }
}

fn median(x: &[f64]) -> f64 {
    let mut sorted = x.to_vec();
    let middle = sorted.len() / 2;
    *sorted.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn clock(n: usize) -> Vec<f64> {
        (0..n).map(|k| k as f64 * 1e-4).collect()
    }

    /// Numbers between 0 and 1, the same every time (splitmix64).
    fn uniform(state: &mut u64) -> f64 {
        *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (*state ^ (*state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    }

    #[test]
    fn spikes_of_a_speed_are_bridged_and_counted() {
        let t = clock(20_000);
        let mut state = 1;
        let truth: Vec<f64> = t
            .iter()
            .map(|t| (200.0 * t).min(150.0) + 0.3 * uniform(&mut state))
            .collect();
        let mut spoilt = Column::from(truth.clone());
        let mut count = 0;
        for x in spoilt.to_mut() {
            if uniform(&mut state) < 0.025 {
                *x = 4e5 * (uniform(&mut state) - 0.5);
                count += 1;
            }
        }
        let bridged = bridge(&t, &mut spoilt, Quantity::Speed, &(0..t.len())).expect("spikes");
        // A value of 4e5 falls by chance within 8 rad/s of the truth once in 25 000.
        assert!(count - bridged.samples <= 1, "{count} {bridged:?}");
        let worst = spoilt
            .iter()
            .zip(&truth)
            .map(|(x, y)| (x - y).abs())
            .fold(0.0, f64::max);
        assert!(worst < 1.0, "{worst}");
        assert!(bridged.farthest.abs() > 1.9e5);
    }

    #[test]
    fn starts_steps_noise_and_pulses_are_no_spikes() {
        let t = clock(4000);
        let mut state = 7;
        let mut noise = |size: f64| size * (uniform(&mut state) - 0.5);
        let start: Vec<f64> = (0..4000).map(|k| (1.6 * f64::from(k)).min(157.0)).collect();
        let step: Vec<f64> = (0..4000)
            .map(|k| if k < 2000 { 50.0 } else { 150.0 })
            .collect();
        let noisy: Vec<f64> = (0..4000).map(|_| 150.0 + noise(100.0)).collect();
        let pulses: Vec<f64> = (0..4000)
            .map(|k| if k % 20 == 0 { 600.0 } else { 0.0 })
            .collect();
        let reversal: Vec<f64> = (0..4000).map(|k| 150.0 - 0.075 * f64::from(k)).collect();
        let rest = vec![0.0; 4000];
        for (k, x) in [start, step, noisy, pulses, reversal, rest]
            .into_iter()
            .enumerate()
        {
            let mut same = Column::from(x.clone());
            assert!(
                bridge(&t, &mut same, Quantity::Speed, &(0..t.len())).is_none(),
                "{k}"
            );
            assert_eq!(same[..], x);
        }
    }

    #[test]
    fn one_outlier_in_a_current_is_bridged_and_an_inrush_is_not() {
        let t = clock(20_000);
        let wave = |t: f64| 5.0 * (1.0 + 12.0 * (-t / 0.05).exp()) * (TAU * 50.0 * t).sin();
        let truth: Vec<f64> = t.iter().map(|t| wave(*t)).collect();
        let mut same = Column::from(truth.clone());
        assert!(bridge(&t, &mut same, Quantity::Current, &(0..t.len())).is_none());
        for at in [0, 1, 9_000, 15_050, 19_999] {
            let mut spoilt = Column::from(truth.clone());
            spoilt.to_mut()[at] = -3e5;
            let bridged =
                bridge(&t, &mut spoilt, Quantity::Current, &(0..t.len())).expect("a spike");
            assert_eq!(
                (bridged.samples, bridged.farthest, bridged.at_s),
                (1, -3e5, t[at])
            );
            assert!((spoilt[at] - truth[at]).abs() < 3.0, "{at}");
        }
    }
}
