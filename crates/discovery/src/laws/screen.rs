//! Tries every law at once: sensitivities of its modes against the normal equations of the present fit.

use crate::laws::modes::{self, Modes};
use crate::laws::sensitivity::Sensitivities;
use estimation::data::case::Case;
use estimation::fit::normal_equations::{self, Block, Penalty};
use estimation::fit::output_error::Fit;
use motor::effect::EffectConfig;
use nalgebra::DVector;
use rayon::prelude::*;

/// Stiffnesses that are tried, in units of the information over the stiffness of the mean mode.
const STIFFNESSES: [f64; 7] = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0];
/// Relative gain of held-out error that a softer curve must bring.
const SOFTER: f64 = 2e-4;

/// A law, linearised.
#[derive(Clone, Debug)]
pub(crate) struct Screened {
    /// The law with the stiffness that predicts best; its sizes are zero.
    pub config: EffectConfig,
    /// Held-out squared error of each block.
    pub held_out: Vec<f64>,
}

impl Screened {
    /// Held-out squared error.
    pub fn total(&self) -> f64 {
        self.held_out.iter().sum()
    }
}

/// All laws on top of a fit, best first.
pub(crate) fn screen(
    case: &Case,
    fit: &Fit,
    sensitivities: &Sensitivities<'_>,
    menu: &[EffectConfig],
) -> Vec<Screened> {
    let rows = case.blocks();
    let one = |law: &EffectConfig| {
        let columns = sensitivities.columns(law)?;
        let blocks =
            normal_equations::extended(&fit.blocks, &rows, &fit.residual, &fit.jacobian, &columns);
        Some(judged(fit, law, &blocks))
    };
    let mut all: Vec<Screened> = menu.par_iter().filter_map(one).collect();
    all.sort_by(|a, b| a.total().total_cmp(&b.total()));
    all
}

/// The stiffness that predicts blocks best which were not fitted.
fn judged(fit: &Fit, law: &EffectConfig, blocks: &[Block]) -> Screened {
    let (stiffness, held_out) = best_stiffness(fit.free.len(), &fit.penalty, law, blocks);
    let mut config = law.clone();
    modes::stiffen(&mut config, stiffness);
    Screened { config, held_out }
}

/// Stiffness and held-out squared errors of the law whose modes stand behind the first `first` coordinates.
pub(crate) fn best_stiffness(
    first: usize,
    base: &Penalty,
    law: &EffectConfig,
    blocks: &[Block],
) -> (f64, Vec<f64>) {
    let Some(modes) = Modes::of(law) else {
        return (0.0, normal_equations::held_out(blocks, base));
    };
    let of_mode = modes::stiffness(modes.action.coordinate);
    let all = normal_equations::total(blocks);
    let n = of_mode.len();
    let information: f64 = (first..first + n).map(|k| all.gram[(k, k)]).sum();
    let unit = information / of_mode.iter().sum::<f64>();
    let tried = |share: f64| {
        let stiffness = share * unit;
        let mut penalty = base.clone();
        penalty.weight = penalty.weight.resize_vertically(first + n, 0.0);
        penalty.pull = penalty.pull.resize_vertically(first + n, 0.0);
        let weights = of_mode.iter().map(|k| modes::weight(stiffness, *k));
        let weights = DVector::from_iterator(n, weights);
        penalty.weight.rows_mut(first, n).copy_from(&weights);
        (stiffness, normal_equations::held_out(blocks, &penalty))
    };
    let total = |held_out: &[f64]| held_out.iter().sum::<f64>();
    // From the stiffest on: a softer curve must be worth it.
    let mut best = tried(STIFFNESSES[STIFFNESSES.len() - 1]);
    for &share in STIFFNESSES.iter().rev().skip(1) {
        let softer = tried(share);
        if total(&softer.1) < (1.0 - SOFTER) * total(&best.1) {
            best = softer;
        }
    }
    best
}
