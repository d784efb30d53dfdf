//! From the place of the lines to a slip, block by block, between the points of the spectra.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::angle::Turned;
use super::blocks::{Block, Blocks, straight};
use super::circuit::CircuitSlip;
use super::search::{Offset, SeenLine, Unique};
use super::spectrum::{hann, is_harmonic};

/// Places that are tried: so many bins to both sides, in such steps.
const REACH_BINS: f64 = 4.0;
const STEP_BINS: f64 = 0.1;
/// Standard deviation of a block's slip around the one of the whole recording, bins.
const DEVIATION_BINS: f64 = 1.0;
/// From this power over noise on the top is a parabola.
const CLEAR: f64 = 30.0;
/// Neighbouring blocks share half of their samples: their errors are half the same.
const OVERLAP: f64 = 1.5;
/// What the search says of the slip of blocks that say nothing themselves is off by this share.
const GUESS: f64 = 0.5;
/// Share of the blocks that may say nothing.
const MOST_SILENT: f64 = 0.5;
/// Least half interval of the mean slip: what happens between the middles of blocks at a load step.
const LEAST: f64 = 3e-5;
/// Least error of a block, bins: the circuit's slip inside a block is no better known.
const LEAST_BINS: f64 = 0.05;

/// The slip by slot harmonics.
pub(super) struct Refined {
    /// What the circuit's slip lacks after the search.
    offset: Offset,
    /// Middle of each block, in samples of the recording, and what is lacking there still.
    rests: Vec<[f64; 2]>,
    /// Half of the 95 % interval of the mean slip.
    pub half_width: f64,
}

impl Refined {
    /// Slip at every sample of the recording.
    pub fn per_sample(&self, circuit: &CircuitSlip) -> Vec<f64> {
        let each = circuit.slip.iter().enumerate();
        each.map(|(k, slip)| slip + self.offset.at(*slip) + self.rest(k as f64))
            .collect()
    }

    fn rest(&self, sample: f64) -> f64 {
        let next = self.rests.partition_point(|[at, _]| *at < sample);
        let before = self.rests[next.saturating_sub(1)];
        let after = self.rests[next.min(self.rests.len() - 1)];
        if after[0] <= before[0] {
            return before[1];
        }
        before[1] + (sample - before[0]) / (after[0] - before[0]) * (after[1] - before[1])
    }
}

/// One line of one block, straightened and windowed.
struct Line {
    samples: Vec<Complex64>,
    /// Of the samples' spectrum.
    noise: f64,
    turns: f64,
    harmonic: f64,
}

/// The slip of each block; `None` without lines.
pub(super) fn refine(turned: &Turned, blocks: &Blocks, unique: &Unique) -> Option<Refined> {
    let window = hann(blocks.cycles * turned.per_cycle);
    let bin = 1.0 / (unique.per_pair * blocks.cycles as f64);
    let mut rests = Vec::new();
    let (mut variance, mut silent, mut guessed) = (0.0, 0.0, 0.0);
    for block in &blocks.blocks {
        let slip: Vec<f64> = turned.slip[block.start..block.start + window.len()]
            .iter()
            .map(|slip| slip + unique.offset.at(*slip))
            .collect();
        let mean = slip.iter().sum::<f64>() / slip.len() as f64;
        let lines = lines(turned, blocks, block, unique, &slip, &window);
        let power = |rest: f64| -> f64 {
            let orders = unique.per_pair * (1.0 - mean - rest);
            lines
                .iter()
                .map(|line| line.power(orders, turned.per_cycle, blocks.cycles))
                .sum()
        };
        let [rest, of_block] = match lines.is_empty() {
            true => [0.0, 0.0],
            false => top(power, bin),
        };
        if of_block == 0.0 {
            silent += 1.0;
            guessed += GUESS * unique.offset.at(block.slip).abs() + bin;
        }
        let middle = turned.at[block.start + window.len() / 2];
        rests.push([middle, rest]);
        variance += of_block + (LEAST_BINS * bin).powi(2);
    }
    let count = rests.len() as f64;
    if rests.is_empty() || silent > MOST_SILENT * count {
        return None;
    }
    let overlap = if rests.len() > 1 { OVERLAP } else { 1.0 };
    let of_mean = overlap * variance / count.powi(2) + unique.spread.powi(2);
    Some(Refined {
        offset: unique.offset,
        rests,
        half_width: (1.96 * of_mean.sqrt()).hypot(guessed / count).hypot(LEAST),
    })
}

fn lines(
    turned: &Turned,
    blocks: &Blocks,
    block: &Block,
    unique: &Unique,
    slip: &[f64],
    window: &[f64],
) -> Vec<Line> {
    let range = block.start..block.start + window.len();
    let windowed: Vec<Complex64> = turned.i[range]
        .iter()
        .zip(window)
        .map(|(x, w)| x * w)
        .collect();
    let energy: f64 = window.iter().map(|w| w * w).sum();
    let mean = slip.iter().sum::<f64>() / slip.len() as f64;
    let slots = unique.per_pair * (1.0 - mean);
    let one = |seen: &SeenLine| {
        let harmonic = f64::from(seen.harmonic);
        let order = seen.turns * (slots + harmonic);
        blocks.slot(block, order)?;
        Some(Line {
            samples: straight(
                &windowed,
                slip,
                seen.turns * unique.per_pair,
                turned.per_cycle,
            ),
            noise: energy * block.current.noise(order),
            turns: seen.turns,
            harmonic,
        })
    };
    unique.lines.iter().filter_map(one).collect()
}

impl Line {
    /// Power over noise at an order of the slots; 0 under a harmonic of the supply.
    fn power(&self, slots: f64, per_cycle: usize, cycles: usize) -> f64 {
        if is_harmonic(slots + self.harmonic, cycles) {
            return 0.0;
        }
        let step = TAU * self.turns * (slots + self.harmonic) / per_cycle as f64;
        let turn = Complex64::from_polar(1.0, -step);
        let mut axis = Complex64::ONE;
        let mut sum = Complex64::ZERO;
        for x in &self.samples {
            sum += x * axis;
            axis *= turn;
        }
        sum.norm_sqr() / self.noise
    }
}

/// Place of the largest power and its variance, 0 where there is none: `exp` of the power over noise is the likelihood of a line there.
fn top(power: impl Fn(f64) -> f64, bin: f64) -> [f64; 2] {
    let count = (REACH_BINS / STEP_BINS).round() as i32;
    let places: Vec<f64> = (-count..=count).map(|k| f64::from(k) * STEP_BINS).collect();
    let logs: Vec<f64> = places
        .iter()
        .map(|x| power(x * bin) - 0.5 * (x / DEVIATION_BINS).powi(2))
        .collect();
    let best = (0..logs.len())
        .max_by(|a, b| logs[*a].total_cmp(&logs[*b]))
        .unwrap_or(0);
    if best == 0 || best + 1 == logs.len() {
        // No top here: the block says nothing.
        return [0.0, 0.0];
    }
    let curvature = 2.0 * logs[best] - logs[best - 1] - logs[best + 1];
    if logs[best] > CLEAR && curvature > 0.0 {
        let vertex = 0.5 * (logs[best + 1] - logs[best - 1]) / curvature;
        let place = places[best] + STEP_BINS * vertex;
        return [place * bin, (STEP_BINS * bin).powi(2) / curvature];
    }
    let weights: Vec<f64> = logs.iter().map(|log| (log - logs[best]).exp()).collect();
    let total: f64 = weights.iter().sum();
    let moment = |f: &dyn Fn(f64) -> f64| -> f64 {
        places
            .iter()
            .zip(&weights)
            .map(|(x, w)| f(*x) * w)
            .sum::<f64>()
            / total
    };
    let mean = moment(&|x| x);
    let variance = moment(&|x| (x - mean).powi(2));
    [mean * bin, variance * bin * bin]
}
