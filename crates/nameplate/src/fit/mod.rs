//! From the values of a plate to the circuit that meets them, with the prior for what they leave open.

mod least_squares;
mod misfit;
mod spread;
mod start;

pub use least_squares::Fit;
pub use misfit::{MISFITS, Misfit, Misfits, Targets};
pub use spread::Spread;
pub use start::{BOUNDS, PRIOR_SPREAD, start};
pub(crate) use start::{bounds, prior_spread};

use least_squares::Problem;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use crate::circuit::Logs;

/// Relative standard deviation with which a given value is to be met: far below any rounding, so that a circuit that can
/// meet a value does.
pub const MEETS: f64 = 0.002;
/// A start whose worst error is below is good enough.
const GOOD: f64 = 0.005;
/// Sum of squares, in prior standard deviations, that most catalogue motors stay below; a stranger circuit may be a local
/// minimum.
const USUAL: f64 = 10.0;
/// Starts: the first from the values, the others drawn from the prior around it.
const STARTS: usize = 6;

/// The circuit nearest to the targets; `seed` draws the further starts.
pub fn solve(targets: &Targets, meets: &Misfits, seed: u64) -> Fit {
    solve_with_starts(targets, meets, seed, STARTS)
}

/// As [`solve`], with at most `starts` starts.
pub fn solve_with_starts(targets: &Targets, meets: &Misfits, seed: u64, starts: usize) -> Fit {
    let problem = Problem::new(targets, meets);
    let mut best = problem.descend(&problem.centre);
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    for _ in 1..starts {
        if best.worst < GOOD && best.cost < USUAL {
            break;
        }
        let draw = Logs::from_fn(|k, _| {
            let normal: f64 = StandardNormal.sample(&mut rng);
            problem.centre[k] + normal * problem.spread[k]
        });
        let other = problem.descend(&problem.inside(draw));
        if other.cost < best.cost {
            best = other;
        }
    }
    best
}
