//! The supply: unbalance and harmonics of the voltages.

use crate::context::Context;
use crate::finding::{Code, Finding, names};
use crate::measure::blocks::{Block, Three};
use crate::measure::fit::Fit;
use crate::measure::harmonics::{self as measure, HIGHEST, Ratios};
use crate::measure::sequence::a;
use crate::measure::statistics::median_phasor;
use crate::wiring::zero_sequence::gain_error;
use num_complex::Complex64;
use recording::{Channel, Supply};
use std::f64::consts::TAU;

/// Smallest unbalance worth a word, percent; motors are derated from 1 % on (NEMA MG 1).
const UNBALANCE_PERCENT: f64 = 0.5;
/// Smallest distortion worth a word, percent; a quiet grid has 1 to 2.
const HARMONICS_PERCENT: f64 = 2.5;
/// A sensor's gain explains negative and zero sequence together when they agree to this share.
const AGREES: f64 = 0.25;

pub(crate) fn check(context: &Context<'_>) -> Vec<Finding> {
    if !context.sound(Channel::VOLTAGES) {
        return Vec::new();
    }
    unbalance(context)
        .into_iter()
        .chain(harmonics(context))
        .collect()
}

fn unbalance(context: &Context<'_>) -> Option<Finding> {
    let (zero, counter): (Vec<_>, Vec<_>) = context.ratios(Channel::VOLTAGES).into_iter().unzip();
    let (zero, counter) = (median_phasor(&zero)?, median_phasor(&counter)?);
    let percent = 100.0 * without_gain_error(zero, counter).norm();
    (percent > UNBALANCE_PERCENT).then(|| {
        Finding::new(Code::SupplyUnbalance, names(&Channel::VOLTAGES), percent, "%").detail(format!(
            "The supply has {percent:.2} % negative sequence (V2/V1, angle {:.0} degrees). The motor model \
             takes the measured voltages, so this is no fault of the motor; above 1 % it heats it.",
            counter.arg().to_degrees()
        ))
    })
}

/// Takes out what a gain error of one channel adds to the negative sequence, if zero and negative
/// sequence agree that there is one: over the positive one both are `g/(3 + g)` with a gain `1 + g` in
/// phase a; in phase b the negative one is turned by `a`, in phase c by `a^2`.
fn without_gain_error(zero: Complex64, counter: Complex64) -> Complex64 {
    let Some((k, along)) = gain_error(zero) else {
        return counter;
    };
    let direction = [Complex64::new(1.0, 0.0), a(), a().conj()][k];
    let rest = counter - direction * along;
    if rest.norm() < AGREES * counter.norm() {
        rest
    } else {
        counter
    }
}

fn harmonics(context: &Context<'_>) -> Option<Finding> {
    if context.recording.metadata.supply != Supply::Grid {
        return None;
    }
    let settled = context.settled(Channel::VOLTAGES);
    if largest_percent(&settled) < HARMONICS_PERCENT {
        return None;
    }
    let per_period = TAU / (context.omega()? * context.recording.t_sample());
    // From 0.4 of the sampling rate on, anti-alias filters distort.
    let highest = HIGHEST.min((0.4 * per_period) as usize);
    let orders = 2..=highest;
    let voltages = context.recording.voltages()?;
    let t = context.recording.t();
    let of_block = |(block, three): &(&Block, &Three)| {
        let x = voltages.map(|x| &x[block.range.clone()]);
        measure::harmonics(&t[block.range.clone()], x, block.omega, &three.fits)
    };
    let ratios: Vec<Ratios> = settled.iter().map(of_block).collect();
    let shares: Vec<f64> = orders.clone().map(|order| share(&ratios, order)).collect();
    let percent = 100.0 * shares.iter().map(|share| share * share).sum::<f64>().sqrt();
    let (strongest, _) = orders.zip(&shares).max_by(|a, b| a.1.total_cmp(b.1))?;
    (percent > HARMONICS_PERCENT).then(|| {
        Finding::new(Code::SupplyHarmonics, names(&Channel::VOLTAGES), percent, "%").detail(format!(
            "The supply has {percent:.1} % harmonics up to order {highest}, most of it order {strongest}. The \
             motor model takes the measured voltages, so this is no fault of the motor."
        ))
    })
}

/// What the harmonics of all orders cannot exceed, percent, without computing one.
///
/// Of a residual of mean square `p` the harmonics of a block have at most `2 p` together (Bessel), four times that where half
/// of its samples are missing and the rest is uneven. The median over blocks of each is no more than twice its mean square: at
/// least half of the blocks reach it. So the sum of their squares is at most `16 p` over the square of the amplitude. The residual is what
/// the fit leaves with the slope that it takes out.
fn largest_percent(settled: &[(&Block, &Three)]) -> f64 {
    let of_phase = |fit: &Fit| 2.0 * (fit.rest + fit.slope.norm_sqr()) / fit.phasor.norm_sqr();
    let of_block =
        |(_, three): &(&Block, &Three)| three.fits.iter().map(of_phase).sum::<f64>() / 3.0;
    let mean = settled.iter().map(of_block).sum::<f64>() / settled.len().max(1) as f64;
    100.0 * (16.0 * mean).sqrt()
}

/// One harmonic over the fundamental, effective over the phases, averaged coherently over blocks.
fn share(blocks: &[Ratios], order: usize) -> f64 {
    let phases = (0..3).map(|k| {
        let ratios: Vec<Complex64> = blocks.iter().map(|block| block[k][order]).collect();
        median_phasor(&ratios).map_or(0.0, |ratio| ratio.norm_sqr())
    });
    (phases.sum::<f64>() / 3.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expectation::Expectation;
    use recording::{Metadata, Recording};

    /// Voltages with a fifth, an eleventh and an unevenness of the samples: the bound is above what is found, and not far.
    #[test]
    fn the_bound_lies_above_the_harmonics() {
        for (fifth, eleventh) in [(0.0, 0.0), (0.004, 0.0), (0.0, 0.02), (0.03, 0.05)] {
            let t: Vec<f64> = (0..20_000).map(|k| f64::from(k) * 1e-4).collect();
            let mut recording = Recording::new("x", t, Metadata::default()).expect("a clock");
            for (k, channel) in Channel::VOLTAGES.into_iter().enumerate() {
                let wave = |t: &f64| {
                    let x = TAU * (50.0 * t - k as f64 / 3.0);
                    300.0 * (x.cos() + fifth * (5.0 * x).cos() + eleventh * (11.0 * x).cos())
                };
                let values = recording.t().iter().map(wave).collect();
                recording.set(channel, values).expect("a channel");
            }
            let expectation = Expectation::default();
            let context = Context::new(&recording, &expectation);
            let bound = largest_percent(&context.settled(Channel::VOLTAGES));
            let percent = 100.0 * fifth.hypot(eleventh);
            assert!(
                bound >= percent && bound <= 5.0 * percent + 0.1,
                "{percent} {bound}"
            );
            let found = harmonics(&context).map(|finding| finding.value);
            match percent > HARMONICS_PERCENT {
                true => assert!((found.expect("a finding") - percent).abs() < 0.05),
                false => assert_eq!(found, None),
            }
        }
    }
}
