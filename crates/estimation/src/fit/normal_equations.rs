//! Normal equations per block: all that folds, sandwiches and ties need.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::ops::Range;

use crate::data::channels::N_CHANNELS;
use signal::dot;

/// Number of interleaved folds.
pub const FOLDS: usize = 5;

/// Normal equations of one block.
#[derive(Clone, Debug)]
pub struct Block {
    /// `J' J`.
    pub gram: DMatrix<f64>,
    /// `J' r`.
    pub score: DVector<f64>,
    /// `r' r`.
    pub sse: f64,
}

fn part<'a>(x: &'a [f64], rows: &Range<usize>) -> &'a [f64] {
    &x[rows.start * N_CHANNELS..rows.end * N_CHANNELS]
}

/// Normal equations per block for residual `r` and columns `j`.
pub fn blocks(rows: &[Range<usize>], r: &[f64], j: &[Vec<f64>]) -> Vec<Block> {
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
pub fn extended(
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
pub fn total(blocks: &[Block]) -> Block {
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
pub struct Penalty {
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
pub fn held_out(blocks: &[Block], penalty: &Penalty) -> Vec<f64> {
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
pub fn score_inflation(blocks: &[Block], n: usize) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64;

    /// Blocks of unequal length over all rows.
    const ROWS: [Range<usize>; 7] = [0..3, 3..7, 7..9, 9..14, 14..18, 18..21, 21..26];

    struct Data {
        r: Vec<f64>,
        j: Vec<Vec<f64>>,
    }

    fn data(columns: usize) -> Data {
        let mut rng = Pcg64::seed_from_u64(5);
        let mut column = || {
            (0..26 * N_CHANNELS)
                .map(|_| rng.random_range(-1.0..1.0))
                .collect()
        };
        Data {
            r: column(),
            j: (0..columns).map(|_| column()).collect(),
        }
    }

    impl Data {
        fn blocks(&self) -> Vec<Block> {
            blocks(&ROWS, &self.r, &self.j)
        }

        /// The values of some blocks as a matrix and a residual.
        fn only(&self, keep: impl Fn(usize) -> bool) -> (DMatrix<f64>, DVector<f64>) {
            let kept = ROWS.iter().enumerate().filter(|(k, _)| keep(*k));
            let at: Vec<usize> = kept
                .flat_map(|(_, r)| r.start * N_CHANNELS..r.end * N_CHANNELS)
                .collect();
            let j = DMatrix::from_fn(at.len(), self.j.len(), |a, b| self.j[b][at[a]]);
            (j, DVector::from_fn(at.len(), |a, _| self.r[at[a]]))
        }
    }

    fn penalty(weight: &[f64], pull: &[f64]) -> Penalty {
        Penalty {
            weight: DVector::from_column_slice(weight),
            pull: DVector::from_column_slice(pull),
        }
    }

    /// Whole numbers add up without rounding, whatever the order.
    #[test]
    fn a_dot_product_of_any_length_leaves_nothing_out() {
        for n in 0..40 {
            let a: Vec<f64> = (0..n).map(|k| f64::from(k) + 1.0).collect();
            let b: Vec<f64> = (0..n).map(|k| 3.0 - f64::from(k)).collect();
            let expected: f64 = (0..n)
                .map(|k| (f64::from(k) + 1.0) * (3.0 - f64::from(k)))
                .sum();
            assert_eq!(dot(&a, &b), expected, "{n}");
        }
    }

    #[test]
    fn blocks_hold_the_normal_equations_of_their_rows() {
        let data = data(3);
        for (k, block) in data.blocks().iter().enumerate() {
            let (j, r) = data.only(|b| b == k);
            assert!((&block.gram - j.transpose() * &j).norm() < 1e-12, "{k}");
            assert!((&block.score - j.transpose() * &r).norm() < 1e-12, "{k}");
            assert!((block.sse - r.norm_squared()).abs() < 1e-12, "{k}");
        }
        let (j, r) = data.only(|_| true);
        let all = total(&data.blocks());
        assert!((&all.gram - j.transpose() * &j).norm() < 1e-11);
        assert!((&all.score - j.transpose() * &r).norm() < 1e-11);
        assert!((all.sse - r.norm_squared()).abs() < 1e-11);
    }

    #[test]
    fn columns_that_are_added_later_make_the_same_equations() {
        let all = data(5);
        let base = blocks(&ROWS, &all.r, &all.j[..3]);
        let added = extended(&base, &ROWS, &all.r, &all.j[..3], &all.j[3..]);
        for (a, b) in added.iter().zip(all.blocks()) {
            assert!((&a.gram - b.gram).norm() < 1e-12);
            assert!((&a.score - b.score).norm() < 1e-12);
            assert_eq!(a.sse, b.sse);
        }
    }

    /// The step is where the gradient of squared error and penalty vanishes: `(G + W) s = b + W p`.
    #[test]
    fn a_step_is_the_least_of_error_and_penalty() {
        let all = total(&data(3).blocks());
        let penalty = penalty(&[2.0, 30.0, 0.0], &[0.5, -1.0, 7.0]);
        let step = penalty.solve(&all, 0.0).expect("positive definite");
        let weight = DMatrix::from_diagonal(&penalty.weight);
        let gradient = (&all.gram + &weight) * &step - &all.score - &weight * &penalty.pull;
        assert!(gradient.norm() < 1e-10, "{gradient}");
        // Levenberg and Marquardt: the diagonal grows by the damping.
        let damped = penalty.solve(&all, 0.5).expect("positive definite");
        let diagonal = DMatrix::from_diagonal(&(&all.gram + &weight).diagonal()) * 0.5;
        let gradient =
            (&all.gram + &weight + diagonal) * &damped - &all.score - &weight * &penalty.pull;
        assert!(gradient.norm() < 1e-10, "{gradient}");
    }

    #[test]
    fn a_coordinate_that_nothing_determines_stays() {
        let mut data = data(2);
        data.j[1].fill(0.0);
        let all = total(&data.blocks());
        let step = penalty(&[0.0; 2], &[0.0; 2])
            .solve(&all, 0.0)
            .expect("solvable");
        assert_eq!(step[1], 0.0);
        assert!((step[0] - all.score[0] / all.gram[(0, 0)]).abs() < 1e-12);
    }

    /// Every fifth block is left out, the rest is fitted, and the fold is judged with that fit.
    #[test]
    fn held_out_errors_are_those_of_fits_that_have_not_seen_the_block() {
        let data = data(3);
        let penalty = penalty(&[2.0, 30.0, 0.1], &[0.5, -1.0, 0.2]);
        let errors = held_out(&data.blocks(), &penalty);
        assert_eq!(errors.len(), ROWS.len());
        for (k, error) in errors.into_iter().enumerate() {
            let (j, r) = data.only(|b| b % FOLDS != k % FOLDS);
            let weight = DMatrix::from_diagonal(&penalty.weight);
            let left = j.transpose() * &j + &weight;
            let right = j.transpose() * &r + &weight * &penalty.pull;
            let step = left.lu().solve(&right).expect("regular");
            let (j, r) = data.only(|b| b == k);
            let expected = (r - j * step).norm_squared();
            assert!((error - expected).abs() < 1e-10, "{k}: {error} {expected}");
        }
    }

    fn scored(scores: &[f64], gram: f64) -> Vec<Block> {
        let one = |s: &f64| Block {
            gram: DMatrix::from_element(1, 1, gram),
            score: DVector::from_element(1, *s),
            sse: 0.0,
        };
        scores.iter().map(one).collect()
    }

    /// Scores 1, 2, 6 scatter by 14 about their mean; the naive variance is the sum of the grams, 3 x 2.
    #[test]
    fn inflation_is_the_scatter_of_scores_over_what_white_noise_gives() {
        let blocks = scored(&[1.0, 2.0, 6.0], 2.0);
        assert!((score_inflation(&blocks, 1) - 14.0 / 6.0).abs() < 1e-12);
        assert_eq!(score_inflation(&blocks, 0), 1.0);
    }

    /// The median over the coordinates: one wild coordinate decides nothing.
    #[test]
    fn inflation_is_that_of_the_middle_coordinate() {
        let block = |s: [f64; 3]| Block {
            gram: DMatrix::identity(3, 3),
            score: DVector::from_column_slice(&s),
            sse: 0.0,
        };
        // Scatter 2 x 1, 2 x 4, 2 x 100 over grams of 2.
        let blocks = [block([1.0, 2.0, 10.0]), block([-1.0, -2.0, -10.0])];
        assert!((score_inflation(&blocks, 3) - 4.0).abs() < 1e-12);
    }
}
