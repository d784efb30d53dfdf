//! The error that is left when nothing is missing: sensor noise and propagated input noise.

use crate::case::{Case, N_CHANNELS};
use crate::predict::outputs_on;
use motor::effects::Plant;
use num_complex::Complex64;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;
use rayon::prelude::*;

/// Monte-Carlo draws of the input noise.
const DRAWS: u64 = 30;

/// Noise floor of a case.
#[derive(Clone, Debug)]
pub(crate) struct Floor {
    /// Expected squared error of each block.
    pub block: Vec<f64>,
    /// Expected mean squared error.
    pub mean: f64,
    /// Standard deviation of the mean between draws.
    pub sd: f64,
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
pub(crate) fn floor(case: &Case, plant: &Plant, seed: u64) -> Floor {
    let rows = case.blocks();
    if case.table.is_some() {
        return Floor {
            block: rows.iter().map(|r| judged(case, r)).collect(),
            mean: 1.0,
            sd: 0.0,
        };
    }
    let base = outputs_on(case, plant, &case.inputs);
    let draw = |k: u64| {
        let inputs = disturbed(case, seed.wrapping_add(k));
        let out = outputs_on(case, plant, &inputs);
        let error = |r: &std::ops::Range<usize>| {
            let range = r.start * N_CHANNELS..r.end * N_CHANNELS;
            let pairs = out[range.clone()].iter().zip(&base[range]);
            pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
        };
        rows.iter().map(error).collect::<Vec<f64>>()
    };
    let draws: Vec<Vec<f64>> = (0..DRAWS).into_par_iter().map(draw).collect();
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
    Floor {
        mean: block.iter().sum::<f64>() / total,
        block,
        sd: variance.sqrt(),
    }
}

fn judged(case: &Case, rows: &std::ops::Range<usize>) -> f64 {
    let weights = case.weight[rows.clone()].iter().flatten();
    weights.filter(|&&w| w > 0.0).count() as f64
}

/// Inputs with one more draw of their noise.
fn disturbed(case: &Case, seed: u64) -> motor::effects::Inputs {
    let mut rng = Pcg64::seed_from_u64(seed);
    let (u, tau) = case.input_noise;
    let mut inputs = case.inputs.clone();
    let Ok(normal) = Normal::new(0.0, 1.0) else {
        return inputs;
    };
    let mut pair = || Complex64::new(normal.sample(&mut rng), normal.sample(&mut rng)) * u;
    let noise: Vec<_> = inputs.u_s.iter().map(|_| pair()).collect();
    for (x, d) in inputs.u_s.iter_mut().zip(case.supply.filter(&noise)) {
        *x += d;
    }
    inputs
        .tau_load
        .iter_mut()
        .for_each(|x| *x += tau * normal.sample(&mut rng));
    inputs
}
