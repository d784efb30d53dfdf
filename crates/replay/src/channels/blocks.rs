//! The sine of a recording, block by block.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};
use num_complex::Complex64;
use recording::Recording;

use super::{CHANNELS, NAMES};
use crate::calibrate::Refusal;

/// Cycles of a block.
const CYCLES: f64 = 10.0;
/// Fewest blocks that tell a scatter.
const FEWEST: usize = 5;
/// Hz; what the board judges.
const FREQUENCIES: [f64; 2] = [5.0, 100.0];
/// Rounds of fitting blocks and correcting the frequency by their phases: each leaves a hundredth of the error.
const ROUNDS: usize = 3;

/// What all channels of a recording show.
#[derive(Clone, Debug)]
pub struct Sine {
    /// rad/s.
    pub omega: f64,
    /// Phasors of the channels, block by block: `x = Re(p e^(j w t))`, V and A.
    pub blocks: Vec<[Complex64; CHANNELS]>,
    /// What the rounding of codes may do to each phasor, the same in every cycle, a share of its length.
    pub rounding: [f64; CHANNELS],
}

impl Sine {
    /// Mean phasor of each channel as the first channel sees it.
    pub fn seen_from_the_first(&self) -> [Complex64; CHANNELS] {
        let share = 1.0 / self.blocks.len() as f64;
        let mut mean = [Complex64::ZERO; CHANNELS];
        for block in &self.blocks {
            let [first, ..] = *block;
            let turn = first.conj() / first.norm();
            mean.iter_mut()
                .zip(block)
                .for_each(|(sum, p)| *sum += p * turn * share);
        }
        mean
    }
}

/// Fits the sine of a recording.
pub fn sine(recording: &Recording) -> Result<Sine, Refusal> {
    let refused = |reason: String| Refusal {
        recording: recording.name().to_owned(),
        reason,
    };
    let channels = channels(recording).ok_or_else(|| {
        refused(
            "needs three voltages and three currents: all six channels on one signal".to_owned(),
        )
    })?;
    let t = recording.t();
    let first = crossings(t, channels[0]).ok_or_else(|| {
        refused(format!(
            "{} shows no steady alternating voltage: lead all three voltage inputs to one phase",
            NAMES[0]
        ))
    })?;
    let mut omega = first;
    let mut blocks = Vec::new();
    for _ in 0..ROUNDS {
        let hertz = omega / TAU;
        if !(FREQUENCIES[0]..=FREQUENCIES[1]).contains(&hertz) {
            return Err(refused(format!(
                "its frequency is {hertz:.1} Hz: use 5 to 100 Hz, best two frequencies in the range of the drive"
            )));
        }
        blocks = fitted(t, &channels, omega);
        if blocks.len() < FEWEST {
            return Err(refused(format!(
                "holds {} blocks of ten cycles, {FEWEST} are the least: record ten seconds",
                blocks.len()
            )));
        }
        omega += drift(&blocks) / (CYCLES * TAU / omega);
    }
    let mut sine = Sine {
        omega,
        blocks,
        rounding: [0.0; CHANNELS],
    };
    sine.rounding = rounding(t, &channels, &sine);
    Ok(sine)
}

/// Codes of a supply that the sampling keeps step with are rounded alike in every cycle: no scatter shows it. Of the `n`
/// samples of a cycle with a step `q` the phasor is off by `q/sqrt(12) sqrt(2/n)`.
fn rounding(t: &[f64], channels: &[&[f64]; CHANNELS], sine: &Sine) -> [f64; CHANNELS] {
    let span = t
        .last()
        .zip(t.first())
        .map_or(0.0, |(last, first)| last - first);
    let in_a_cycle = t.len() as f64 * TAU / (sine.omega * span);
    let lengths = sine.seen_from_the_first();
    std::array::from_fn(|k| step(channels[k]) * (in_a_cycle * 6.0).powf(-0.5) / lengths[k].norm())
}

/// Share of the peak within which two values are one code.
const SAME: f64 = 1e-7;

/// Smallest distance between two values: the converter's step, or next to nothing without one.
fn step(x: &[f64]) -> f64 {
    let mut values = x.to_vec();
    values.sort_unstable_by(f64::total_cmp);
    let peak = values.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
    let steps = values.windows(2).map(|pair| pair[1] - pair[0]);
    let least = steps
        .filter(|step| *step > SAME * peak)
        .fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

fn channels(recording: &Recording) -> Option<[&[f64]; CHANNELS]> {
    let [va, vb, vc] = recording.voltages()?;
    let [ia, ib, ic] = recording.currents()?;
    Some([va, vb, vc, ia, ib, ic])
}

/// Frequency by the rising crossings of zero, rad/s; a crossing counts once the signal has been below minus a third of its peak.
fn crossings(t: &[f64], x: &[f64]) -> Option<f64> {
    let peak = x.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
    let mut was_low = false;
    let (mut first, mut last, mut count) = (None, 0.0, 0_u32);
    for (pair, times) in x.windows(2).zip(t.windows(2)) {
        was_low |= pair[0] < -peak / 3.0;
        if was_low && pair[0] < 0.0 && pair[1] >= 0.0 {
            let share = pair[0] / (pair[0] - pair[1]);
            last = times[0] + share * (times[1] - times[0]);
            first.get_or_insert(last);
            count += 1;
            was_low = false;
        }
    }
    let span = last - first?;
    (count > 2 && span > 0.0).then(|| TAU * f64::from(count - 1) / span)
}

/// Least squares of 1, cos and sin in each block of ten cycles.
fn fitted(t: &[f64], channels: &[&[f64]; CHANNELS], omega: f64) -> Vec<[Complex64; CHANNELS]> {
    let length = CYCLES * TAU / omega;
    let start = t.first().copied().unwrap_or_default();
    let number = |at: f64| ((at - start) / length) as usize;
    let whole = t.last().map_or(0, |end| number(*end));
    let mut normal = vec![Matrix3::zeros(); whole];
    let mut right = vec![[Vector3::zeros(); CHANNELS]; whole];
    for (k, &at) in t.iter().enumerate() {
        let block = number(at);
        if block >= whole {
            break;
        }
        let (sin, cos) = (omega * at).sin_cos();
        let basis = Vector3::new(1.0, cos, sin);
        normal[block] += basis * basis.transpose();
        for (sum, x) in right[block].iter_mut().zip(channels) {
            *sum += basis * x[k];
        }
    }
    let solved = normal.iter().zip(&right).filter_map(|(normal, right)| {
        let inverse = normal.try_inverse()?;
        Some(right.map(|right| {
            let solution = inverse * right;
            Complex64::new(solution[1], -solution[2])
        }))
    });
    solved.collect()
}

/// Mean advance of the first channel's phase from a block to the next, rad.
fn drift(blocks: &[[Complex64; CHANNELS]]) -> f64 {
    let steps = blocks.windows(2).map(|pair| pair[1][0] * pair[0][0].conj());
    steps.sum::<Complex64>().arg()
}
