//! The supply: unbalance and harmonics of the voltages.

use crate::context::Context;
use crate::finding::{Code, Finding, names};
use crate::measure::blocks::{Block, Three};
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
/// sequence agree that there is one: with a gain `1 + g` in phase a both are `g/3`, in phase b the
/// negative one is `a g/3`, in phase c `a^2 g/3`.
fn without_gain_error(zero: Complex64, counter: Complex64) -> Complex64 {
    let Some((k, percent)) = gain_error(zero) else {
        return counter;
    };
    let direction = [Complex64::new(1.0, 0.0), a(), a().conj()][k];
    let rest = counter - direction * percent / 300.0;
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

/// One harmonic over the fundamental, effective over the phases, averaged coherently over blocks.
fn share(blocks: &[Ratios], order: usize) -> f64 {
    let phases = (0..3).map(|k| {
        let ratios: Vec<Complex64> = blocks.iter().map(|block| block[k][order]).collect();
        median_phasor(&ratios).map_or(0.0, |ratio| ratio.norm_sqr())
    });
    (phases.sum::<f64>() / 3.0).sqrt()
}
