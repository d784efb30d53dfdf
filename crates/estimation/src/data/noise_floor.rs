//! The error that is left when nothing is missing: sensor noise and propagated input noise.

use crate::data::case::{Case, Waveform};
use crate::data::channels::N_CHANNELS;
use crate::model::prediction::{Drive, outputs_on};
use motor::effect::Plant;
use num_complex::Complex64;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use signal::{Windows, dot, refined};
use std::ops::Range;

/// Monte-Carlo draws of the input noise.
const DRAWS: u64 = 30;

/// Noise floor of a case.
#[derive(Clone, Debug)]
pub struct Floor {
    /// Expected squared error of each block.
    pub block: Vec<f64>,
    /// Expected mean squared error.
    pub mean: f64,
    /// Standard deviation of the mean between draws.
    pub sd: f64,
    /// Expected mean squared error of each channel.
    pub channel: [f64; N_CHANNELS],
}

impl Floor {
    /// Rms error over noise for the sum of squared errors `sse` over `judged` values.
    pub fn error_over_noise(&self, sse: f64, judged: f64) -> f64 {
        (sse / judged / self.mean).sqrt()
    }

    /// Relative allowance on the gate: two standard deviations of the floor.
    pub fn allowance(&self) -> f64 {
        self.sd / self.mean
    }
}

/// Propagates the noise of voltage and torque through the believed plant.
pub fn floor(case: &Case, plant: &Plant, seed: u64) -> Floor {
    let rows = case.blocks();
    let Case::Waveform(waveform) = case else {
        return Floor {
            block: rows.iter().map(|r| judged(case, r)).collect(),
            mean: 1.0,
            sd: 0.0,
            channel: [1.0; N_CHANNELS],
        };
    };
    let squares = |change: Vec<f64>| {
        let error = |r: &Range<usize>| {
            let part = &change[r.start * N_CHANNELS..r.end * N_CHANNELS];
            dot(part, part)
        };
        let blocks = rows.iter().map(error).collect::<Vec<f64>>();
        (blocks, by_channel(&change))
    };
    let (draws, channels): (Vec<_>, Vec<_>) = noise_draws(waveform, plant, seed, DRAWS, squares)
        .into_iter()
        .unzip();
    let mut block: Vec<f64> = rows.iter().map(|r| judged(case, r)).collect();
    for draw in &draws {
        block
            .iter_mut()
            .zip(draw)
            .for_each(|(b, d)| *b += d / DRAWS as f64);
    }
    let total = case.judged();
    let sums: Vec<f64> = draws
        .iter()
        .map(|d| d.iter().sum::<f64>() / total)
        .collect();
    let mean_draw = sums.iter().sum::<f64>() / DRAWS as f64;
    let variance = sums.iter().map(|s| (s - mean_draw).powi(2)).sum::<f64>() / (DRAWS - 1) as f64;
    let channel = |k: usize| {
        let drawn: f64 = channels
            .iter()
            .map(|sums: &[f64; N_CHANNELS]| sums[k])
            .sum();
        1.0 + drawn / DRAWS as f64 / judged_of(case, k).max(1.0)
    };
    Floor {
        channel: core::array::from_fn(channel),
        mean: block.iter().sum::<f64>() / total,
        block,
        sd: variance.sqrt(),
    }
}

/// Sum of squares of each channel.
pub fn by_channel(rows: &[f64]) -> [f64; N_CHANNELS] {
    let mut sums = [0.0; N_CHANNELS];
    for row in rows.chunks_exact(N_CHANNELS) {
        sums.iter_mut().zip(row).for_each(|(sum, x)| *sum += x * x);
    }
    sums
}

/// Number of judged values of a channel.
pub fn judged_of(case: &Case, channel: usize) -> f64 {
    case.weight().iter().filter(|w| w[channel] > 0.0).count() as f64
}

fn judged(case: &Case, rows: &Range<usize>) -> f64 {
    let weights = case.weight()[rows.clone()].iter().flatten();
    weights.filter(|&&w| w > 0.0).count() as f64
}

/// What each of `count` draws of the input noise changes in the weighted outputs of a plant, handed to `of`.
pub fn noise_draws<T: Send>(
    waveform: &Waveform,
    plant: &Plant,
    seed: u64,
    count: u64,
    of: impl Fn(Vec<f64>) -> T + Sync,
) -> Vec<T> {
    let base = outputs_on(waveform, plant, &Drive::of(waveform));
    let draw = |k: u64| {
        let mut change = outputs_on(waveform, plant, &disturbed(waveform, seed.wrapping_add(k)));
        change.iter_mut().zip(&base).for_each(|(x, b)| *x -= b);
        of(change)
    };
    (0..count).into_par_iter().map(draw).collect()
}

/// What drives the model, with one more draw of its noise.
fn disturbed(waveform: &Waveform, seed: u64) -> Drive<'_> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut drive = Drive::of(waveform);
    let noise = waveform.input_noise;
    let mut draw = |sigma: f64| {
        let normal: f64 = StandardNormal.sample(&mut rng);
        sigma * normal
    };
    let coarse = waveform.coarse.as_ref().unwrap_or(&waveform.supply);
    let samples = 0..coarse.theta.len();
    let inputs = drive.inputs.to_mut();
    let voltage = || Complex64::new(draw(noise.voltage), draw(noise.voltage));
    add(
        &mut inputs.u_s,
        supplied(waveform, drawn(&samples, voltage)),
    );
    let torque = drawn(&samples, || draw(noise.torque));
    add(
        &mut inputs.tau_load,
        smoothed(waveform, &waveform.load_windows, torque),
    );
    if noise.speed > 0.0 {
        let speed = drawn(&samples, || draw(noise.speed));
        add(
            drive.speed.to_mut(),
            smoothed(waveform, &waveform.speed_windows, speed),
        );
    }
    drive
}

fn drawn<T>(samples: &Range<usize>, mut one: impl FnMut() -> T) -> Vec<T> {
    samples.clone().map(|_| one()).collect()
}

/// What is left of noise of the measured voltage in that which drives the model. A draw is as long as the recording: each step
/// gives its memory back.
fn supplied(waveform: &Waveform, voltage: Vec<Complex64>) -> Vec<Complex64> {
    let Some(coarse) = &waveform.coarse else {
        return waveform.supply.filter(&voltage);
    };
    let filtered = coarse.filter(&voltage);
    drop(voltage);
    coarse.refined_vector(&filtered, &waveform.supply.theta, waveform.finer)
}

/// The same of a signal of one axis that was smoothed with these windows.
fn smoothed(waveform: &Waveform, windows: &Windows, noise: Vec<f64>) -> Vec<f64> {
    refined(windows.smooth(&noise), waveform.finer)
}

fn add<T: std::ops::AddAssign>(to: &mut [T], what: Vec<T>) {
    to.iter_mut().zip(what).for_each(|(x, d)| *x += d);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::inputs::InputNoise;
    use crate::specimen;

    fn prepared() -> (Waveform, Plant) {
        let prior = specimen::prior("");
        let waveform = Waveform::new(&specimen::recording(0.5, |_| 1.0), &prior.plant.rated);
        (waveform.expect("judged"), prior.plant)
    }

    #[test]
    fn without_input_noise_every_judged_value_counts_one() {
        let (mut case, plant) = prepared();
        case.input_noise = InputNoise::default();
        case.weight[3] = [0.0; N_CHANNELS];
        let floor = floor(&case.clone().into(), &plant, 1);
        assert!((floor.mean - 1.0).abs() < 1e-12 && floor.sd < 1e-12);
        let rows: Vec<usize> = case.blocks().iter().map(|r| r.len()).collect();
        for (k, (block, rows)) in floor.block.iter().zip(rows).enumerate() {
            let missing = if k == 0 { N_CHANNELS } else { 0 };
            assert!((block - (rows * N_CHANNELS - missing) as f64).abs() < 1e-9);
        }
        assert_eq!(floor.allowance(), floor.sd / floor.mean);
    }

    /// Errors are root mean squares over the noise: four times the expected squares are twice the noise.
    #[test]
    fn an_error_is_a_root_mean_square_over_the_floor() {
        let floor = Floor {
            block: Vec::new(),
            mean: 1.5,
            sd: 0.03,
            channel: [1.5; N_CHANNELS],
        };
        assert!((floor.error_over_noise(4.0 * 1.5 * 200.0, 200.0) - 2.0).abs() < 1e-12);
        assert!((floor.allowance() - 0.02).abs() < 1e-12);
    }

    /// The same seed draws the same noise, of the declared size, as the smoothing leaves it.
    #[test]
    fn input_noise_is_drawn_with_its_declared_deviation() {
        let (mut case, _) = prepared();
        case.input_noise = InputNoise {
            voltage: 0.5,
            torque: 0.02,
            speed: 0.0,
        };
        let noise = disturbed(&case, 7).inputs;
        assert_eq!(disturbed(&case, 7).inputs, noise);
        assert_ne!(disturbed(&case, 8).inputs, noise);
        let torque = noise.tau_load.iter().zip(&case.inputs.tau_load);
        let mean_square = torque.map(|(a, b)| (a - b).powi(2)).sum::<f64>() / 2500.0;
        // The torque is constant: a quadratic over 1600 of the 2500 samples keeps 9/4 over 1600 of the variance, up to four
        // times that at the ends.
        let kept = mean_square / 4e-4;
        assert!((7e-4..6e-3).contains(&kept), "{kept}");
        let volt = noise.u_s.iter().zip(&case.inputs.u_s);
        let mean_square = volt.map(|(a, b)| (a - b).norm_sqr()).sum::<f64>() / 2500.0;
        // So is the supply: over 16 periods of 83 samples 9/4 over 1328, for each of the two axes.
        let kept = mean_square / (2.0 * 0.25);
        assert!((7e-4..8e-3).contains(&kept), "{kept}");
    }

    /// Noise of the torque moves the speed: twice the noise adds four times the squares.
    #[test]
    fn propagated_noise_adds_to_the_floor_with_its_square() {
        let (mut case, plant) = prepared();
        let excess = |one: &Waveform| floor(&one.clone().into(), &plant, 3).mean - 1.0;
        case.input_noise.torque = 0.5;
        let once = excess(&case);
        case.input_noise.torque = 1.0;
        let twice = excess(&case);
        assert!(once > 1e-4, "{once}");
        assert!((twice / once - 4.0).abs() < 0.4, "{once} {twice}");
    }

    #[test]
    fn a_table_has_its_assumed_accuracy_as_its_floor() {
        let study = specimen::table_study(|_| ());
        let floor = &study.fitted.floor;
        assert_eq!((floor.mean, floor.sd), (1.0, 0.0));
        assert_eq!(floor.block.iter().sum::<f64>(), study.fitted.case.judged());
    }
}
