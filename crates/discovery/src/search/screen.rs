//! Tries every effect at once: secant columns against the normal equations of the present fit.

use estimation::data::case::Case;
use estimation::fit::normal_equations::{self, Block, Penalty};
use estimation::fit::output_error::Fit;
use estimation::model::differences::Differences;
use estimation::model::prior::{N_NOMINAL, Prior};
use estimation::model::speed_gain::is_scale;
use motor::effect::{Applies, Effect, EffectConfig, Parameter, Role, expression};
use motor::effects::ALL;
use nalgebra::DVector;
use rayon::prelude::*;

/// Size of the secant, in typical sizes.
const SECANT: f64 = 0.5;
/// Start of a refit whose linear estimate is impossible, in typical sizes.
const SMALL: f64 = 0.3;
/// Prior weight of an effect's size: one over the square of four typical sizes.
const SIZE_WEIGHT: f64 = 1.0 / 16.0;
/// Finest ratio between neighbouring frequencies of a resonance scan.
const SCAN_RATIO: f64 = 1.06;

/// One effect at one point of its shape grid, linearised.
#[derive(Clone, Debug)]
pub(crate) struct Screened {
    /// The effect with its shapes and estimated sizes.
    pub config: EffectConfig,
    /// Held-out squared error of each block.
    pub held_out: Vec<f64>,
    /// Whether physics allows the estimated sizes; linearised from a local minimum a sign may be wrong.
    pub possible: bool,
    /// Mean squared signature of a typical size that the nominals cannot imitate, in noise units.
    pub visible: f64,
    /// The same if a free scale of the speed were known; `None` without one.
    pub visible_with_known_scale: Option<f64>,
}

impl Screened {
    /// Held-out squared error.
    pub fn total(&self) -> f64 {
        self.held_out.iter().sum()
    }
}

/// Effects that can be asked about in this case and are not part of the model yet.
fn askable(case: &Case, prior: &Prior, fit: &Fit, excluded: &[&str]) -> Vec<&'static dyn Effect> {
    let present = |e: &&'static dyn Effect| {
        let asked = e.descriptor();
        // Forms of one effect exclude each other; each formula is an effect of its own.
        let same = |c: &EffectConfig| {
            let held = c.effect.descriptor();
            held.name == asked.name && (held.name != expression::NAME || held.form == asked.form)
        };
        let mut known = fit.hypothesis.effects.iter().chain(&prior.plant.effects);
        known.any(same) || excluded.contains(&asked.name)
    };
    let applies = |e: &&'static dyn Effect| match e.descriptor().applies {
        Applies::Always => true,
        Applies::Inverter => case.waveform().is_some_and(|waveform| waveform.inverter),
        Applies::Samples => !case.is_table(),
    };
    let all = ALL.iter().chain(&prior.formulas);
    all.copied().filter(|e| !present(e) && applies(e)).collect()
}

/// The grid of a parameter, refined where it is a resonance frequency.
fn grid(p: &Parameter) -> Vec<f64> {
    if p.role == Role::Size {
        return vec![0.0];
    }
    if p.role == Role::Form || !p.is_resonance {
        return p.grid.to_vec();
    }
    let (first, last) = (p.grid[0], p.grid[p.grid.len() - 1]);
    let steps = ((last / first).ln() / SCAN_RATIO.ln()).ceil().max(1.0);
    let ratio = (last / first).powf(1.0 / steps);
    (0..=steps as i32).map(|k| first * ratio.powi(k)).collect()
}

/// All points of an effect's shape grid, sizes zero.
pub(crate) fn grid_points(effect: &'static dyn Effect, prior: &Prior) -> Vec<EffectConfig> {
    let rated = &prior.plant.rated;
    let mut points = vec![EffectConfig::absent(effect, rated)];
    for (k, p) in effect.descriptor().parameters.iter().enumerate() {
        let scale = p.scale.of(rated);
        let spread = |c: &EffectConfig| {
            let with = |x: f64| {
                let mut c = c.clone();
                c.values[k] = x * scale;
                c
            };
            grid(p).into_iter().map(with).collect::<Vec<_>>()
        };
        points = points.iter().flat_map(spread).collect();
    }
    points
}

/// Effects at every point of their grids, in the order of the library.
pub(crate) fn screen(case: &Case, prior: &Prior, fit: &Fit, excluded: &[&str]) -> Vec<Screened> {
    let points: Vec<EffectConfig> = askable(case, prior, fit, excluded)
        .into_iter()
        .flat_map(|e| grid_points(e, prior))
        .collect();
    let rows = case.blocks();
    let differences = Differences::from(case, prior, &fit.hypothesis, &fit.outputs, fit.observer);
    let one = |config: &EffectConfig| {
        let columns = columns(&differences, prior, fit, config);
        if columns.iter().flatten().any(|x| !x.is_finite()) {
            return None;
        }
        let blocks =
            normal_equations::extended(&fit.blocks, &rows, &fit.residual, &fit.jacobian, &columns);
        Some(judge(prior, fit, config, &blocks, columns.len()))
    };
    points.par_iter().filter_map(one).collect()
}

/// Secant columns: one per size, or the whole difference for a resonance.
fn columns(
    differences: &Differences<'_>,
    prior: &Prior,
    fit: &Fit,
    config: &EffectConfig,
) -> Vec<Vec<f64>> {
    let rated = &prior.plant.rated;
    let difference =
        |config: EffectConfig, over: f64| differences.of(&fit.hypothesis.with(config, rated), over);
    let descriptor = config.effect.descriptor();
    if descriptor.is_resonance() {
        return vec![difference(config.clone(), 1.0)];
    }
    let sizes = descriptor.parameters.iter().enumerate();
    sizes
        .filter(|(_, p)| p.role == Role::Size)
        .map(|(k, p)| {
            let mut there = config.clone();
            there.values[k] = SECANT * p.typical * p.scale.of(rated);
            difference(there, SECANT)
        })
        .collect()
}

fn judge(prior: &Prior, fit: &Fit, config: &EffectConfig, blocks: &[Block], n: usize) -> Screened {
    let penalty = extended_penalty(&fit.penalty, n);
    let all = normal_equations::total(blocks);
    let first = fit.free.len();
    let step = penalty.solve(&all, 0.0);
    let mut config = config.clone();
    let possible = step.is_some_and(|s| estimate(prior, &mut config, &s.as_slice()[first..]));
    let held_out = if possible {
        normal_equations::held_out(blocks, &penalty)
    } else {
        normal_equations::held_out(&fit.blocks, &fit.penalty)
    };
    if !possible {
        make_small(prior, &mut config);
    }
    Screened {
        config,
        held_out,
        possible,
        visible: visible(&all, &penalty, first, n),
        visible_with_known_scale: known_scale(fit).map(|scale| {
            let (all, penalty) = without(&all, &penalty, scale);
            visible(&all, &penalty, first - 1, n)
        }),
    }
}

/// Position of a free scale of the speed among the fitted coordinates.
fn known_scale(fit: &Fit) -> Option<usize> {
    let h = &fit.hypothesis;
    let scales = |&k: &usize| k >= N_NOMINAL && is_scale(h.effects[h.effect_of(k)].effect);
    fit.free.iter().position(scales)
}

/// Normal equations without one coordinate: its value is known.
fn without(block: &Block, penalty: &Penalty, k: usize) -> (Block, Penalty) {
    let block = Block {
        gram: block.gram.clone().remove_row(k).remove_column(k),
        score: block.score.clone().remove_row(k),
        sse: block.sse,
    };
    let penalty = Penalty {
        weight: penalty.weight.clone().remove_row(k),
        pull: penalty.pull.clone().remove_row(k),
    };
    (block, penalty)
}

fn extended_penalty(base: &Penalty, n: usize) -> Penalty {
    let len = base.weight.len();
    Penalty {
        weight: base.weight.clone().resize_vertically(len + n, SIZE_WEIGHT),
        pull: base.pull.clone().resize_vertically(len + n, 0.0),
    }
}

/// Writes the estimated sizes into `config`; false if physics forbids their sign.
fn estimate(prior: &Prior, config: &mut EffectConfig, sizes: &[f64]) -> bool {
    let descriptor = config.effect.descriptor();
    if descriptor.is_resonance() {
        return sizes[0] > 0.0;
    }
    let indices = descriptor.parameters.iter().enumerate();
    let mut possible = true;
    for ((k, p), size) in indices.filter(|(_, p)| p.role == Role::Size).zip(sizes) {
        possible &= p.range[0] < 0.0 || *size > 0.0;
        let scale = p.scale.of(&prior.plant.rated);
        // A linear estimate may overshoot where the effect is curved.
        let limit = 6.0 * p.typical;
        config.values[k] =
            (size * p.typical).clamp(p.range[0].max(-limit), p.range[1].min(limit)) * scale;
    }
    possible
}

/// Sizes from which a refit may find out by itself: a little of what cannot be negative, nothing of the rest.
fn make_small(prior: &Prior, config: &mut EffectConfig) {
    let parameters = config.effect.descriptor().parameters.iter().enumerate();
    for (k, p) in parameters.filter(|(_, p)| p.role == Role::Size) {
        let one_sided = p.range[0] >= 0.0;
        let share = if one_sided { SMALL } else { 0.0 };
        config.values[k] = share * p.typical * p.scale.of(&prior.plant.rated);
    }
}

/// Largest squared signature of the columns behind the first `first`, after the nominals took their share.
fn visible(all: &Block, penalty: &Penalty, first: usize, n: usize) -> f64 {
    let nominal = all.gram.view((0, 0), (first, first)).into_owned();
    let nominal =
        nominal + nalgebra::DMatrix::from_diagonal(&penalty.weight.rows(0, first).into_owned());
    let Some(cholesky) = nalgebra::Cholesky::new(nominal) else {
        return 0.0;
    };
    let one = |k: usize| {
        let cross: DVector<f64> = all.gram.view((0, k), (first, 1)).column(0).into_owned();
        all.gram[(k, k)] - cross.dot(&cholesky.solve(&cross))
    };
    (first..first + n).map(one).fold(0.0, f64::max)
}

/// The best grid points of each effect form, best effect first; at most `keep` points each.
pub(crate) fn ranked(screened: &[Screened], keep: usize) -> Vec<Vec<Screened>> {
    let mut groups: Vec<Vec<Screened>> = Vec::new();
    for s in screened {
        let key = |c: &EffectConfig| {
            let d = c.effect.descriptor();
            (d.name, d.form)
        };
        match groups
            .iter_mut()
            .find(|g| key(&g[0].config) == key(&s.config))
        {
            Some(group) => group.push(s.clone()),
            None => groups.push(vec![s.clone()]),
        }
    }
    for group in &mut groups {
        group.sort_by(|a, b| a.total().total_cmp(&b.total()));
        group.truncate(keep);
    }
    groups.sort_by(|a, b| a[0].total().total_cmp(&b[0].total()));
    groups
}

#[cfg(test)]
mod tests;
