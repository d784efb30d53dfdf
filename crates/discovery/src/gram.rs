//! Normal equations per block: all that folds, sandwiches and ties need.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::ops::Range;

use crate::case::N_CHANNELS;

/// Number of interleaved folds.
pub(crate) const FOLDS: usize = 5;

/// Normal equations of one block.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// `J' J`.
    pub gram: DMatrix<f64>,
    /// `J' r`.
    pub score: DVector<f64>,
    /// `r' r`.
    pub sse: f64,
}

/// Dot product in eight independent sums, so that it vectorises.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (head_a, head_b) = (a.chunks_exact(8), b.chunks_exact(8));
    let tail: f64 = head_a
        .remainder()
        .iter()
        .zip(head_b.remainder())
        .map(|(x, y)| x * y)
        .sum();
    for (x, y) in head_a.zip(head_b) {
        for k in 0..8 {
            sums[k] += x[k] * y[k];
        }
    }
    sums.iter().sum::<f64>() + tail
}

fn part<'a>(x: &'a [f64], rows: &Range<usize>) -> &'a [f64] {
    &x[rows.start * N_CHANNELS..rows.end * N_CHANNELS]
}

/// Normal equations per block for residual `r` and columns `j`.
pub(crate) fn blocks(rows: &[Range<usize>], r: &[f64], j: &[Vec<f64>]) -> Vec<Block> {
    let one = |rows: &Range<usize>| {
        let r = part(r, rows);
        let gram = symmetric(j.len(), |a, b| dot(part(&j[a], rows), part(&j[b], rows)));
        let score = DVector::from_fn(j.len(), |a, _| dot(part(&j[a], rows), r));
        Block {
            gram,
            score,
            sse: dot(r, r),
        }
    };
    rows.par_iter().map(one).collect()
}

fn symmetric(n: usize, f: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
    let mut m = DMatrix::zeros(n, n);
    for a in 0..n {
        for b in 0..=a {
            m[(a, b)] = f(a, b);
            m[(b, a)] = m[(a, b)];
        }
    }
    m
}

/// Adds the columns `extra` to the normal equations `base` of the columns `j`.
pub(crate) fn extended(
    base: &[Block],
    rows: &[Range<usize>],
    r: &[f64],
    j: &[Vec<f64>],
    extra: &[Vec<f64>],
) -> Vec<Block> {
    let n = j.len();
    let column = |k: usize| if k < n { &j[k] } else { &extra[k - n] };
    let one = |(block, rows): (&Block, &Range<usize>)| {
        let mut gram = block
            .gram
            .clone()
            .resize(n + extra.len(), n + extra.len(), 0.0);
        let mut score = block.score.clone().resize_vertically(n + extra.len(), 0.0);
        for a in n..n + extra.len() {
            let x = part(column(a), rows);
            score[a] = dot(x, part(r, rows));
            for b in 0..=a {
                gram[(a, b)] = dot(x, part(column(b), rows));
                gram[(b, a)] = gram[(a, b)];
            }
        }
        Block {
            gram,
            score,
            sse: block.sse,
        }
    };
    base.iter().zip(rows).map(one).collect()
}

/// Sum of blocks.
pub(crate) fn total(blocks: &[Block]) -> Block {
    let n = blocks[0].score.len();
    let zero = Block {
        gram: DMatrix::zeros(n, n),
        score: DVector::zeros(n),
        sse: 0.0,
    };
    blocks.iter().fold(zero, |mut sum, b| {
        sum.gram += &b.gram;
        sum.score += &b.score;
        sum.sse += b.sse;
        sum
    })
}

/// Quadratic penalty on the coordinates: `sum weight (z + step - centre)^2`.
#[derive(Clone, Debug)]
pub(crate) struct Penalty {
    /// Weight of each coordinate.
    pub weight: DVector<f64>,
    /// Centre minus the present coordinate.
    pub pull: DVector<f64>,
}

impl Penalty {
    /// Minimising step for the normal equations of `block`.
    pub fn solve(&self, block: &Block, damping: f64) -> Option<DVector<f64>> {
        let n = block.score.len();
        let mut a = block.gram.clone();
        for k in 0..n {
            a[(k, k)] += self.weight[k];
            a[(k, k)] *= 1.0 + damping;
            a[(k, k)] += f64::MIN_POSITIVE;
        }
        let b = &block.score + self.weight.component_mul(&self.pull);
        nalgebra::Cholesky::new(a).map(|c| c.solve(&b))
    }
}

/// Held-out squared error of each block: the step is fitted on the other folds (linearised).
pub(crate) fn held_out(blocks: &[Block], penalty: &Penalty) -> Vec<f64> {
    let all = total(blocks);
    let step_without = |fold: usize| {
        let mut rest = all.clone();
        for block in blocks.iter().skip(fold).step_by(FOLDS) {
            rest.gram -= &block.gram;
            rest.score -= &block.score;
        }
        penalty
            .solve(&rest, 0.0)
            .unwrap_or_else(|| DVector::zeros(all.score.len()))
    };
    let steps: Vec<_> = (0..FOLDS).map(step_without).collect();
    let error = |(k, b): (usize, &Block)| {
        let step = &steps[k % FOLDS];
        (b.sse - 2.0 * step.dot(&b.score) + step.dot(&(&b.gram * step))).max(0.0)
    };
    blocks.iter().enumerate().map(error).collect()
}

/// Score variance between blocks over its naive value, for the first `n` coordinates.
pub(crate) fn score_inflation(blocks: &[Block], n: usize) -> f64 {
    let all = total(blocks);
    let mean = &all.score / blocks.len() as f64;
    let ratio = |k: usize| {
        let spread = blocks.iter().map(|b| (b.score[k] - mean[k]).powi(2));
        spread.sum::<f64>() / all.gram[(k, k)].max(f64::MIN_POSITIVE)
    };
    let mut ratios: Vec<f64> = (0..n).map(ratio).collect();
    ratios.sort_by(f64::total_cmp);
    ratios.get(n / 2).copied().unwrap_or(1.0)
}

/// Covariance of the coordinates: a sandwich over blocks, never below the naive value.
///
/// The first `nominals` carry a prior `kappa` times too heavy because so many rows count as one; what the data
/// leave open keeps the uncertainty of the true prior.
pub(crate) fn covariance(
    blocks: &[Block],
    penalty: &Penalty,
    nominals: usize,
    kappa: f64,
) -> DMatrix<f64> {
    let all = total(blocks);
    let h = &all.gram + DMatrix::from_diagonal(&penalty.weight);
    let n = h.nrows();
    let inverse = h
        .clone()
        .try_inverse()
        .unwrap_or_else(|| DMatrix::zeros(n, n));
    let mean = &all.score / blocks.len() as f64;
    let spread = |m: DMatrix<f64>, b: &Block| {
        let d = &b.score - &mean;
        m + &d * d.transpose()
    };
    let meat = blocks.iter().fold(DMatrix::zeros(n, n), spread);
    let mut out = &inverse * meat * &inverse;
    for k in 0..n {
        let rows_per_datum = if k < nominals { kappa } else { 1.0 };
        out[(k, k)] = out[(k, k)].max(rows_per_datum * inverse[(k, k)]);
    }
    out
}
