//! How far the coordinates of a fit may be off: noise, instruments and priors together.
//!
//! The fit minimises `|r|^2 + (z - z0)' W (z - z0)`. Its error is `H^-1 s`, where `H = J' J + W` and `s` is the sum of
//! the scores of everything that is not as the fit takes it: noise of the outputs, which may be correlated from
//! sample to sample; noise of the inputs as it passes through the model; instruments that are off by their class; and the
//! priors, whose pull is not zero where the true motor is not as believed. The covariances of these scores add up.

use crate::data::case::Waveform;
use crate::data::channels::{N_CHANNELS, SPEED};
use crate::data::instrument_class::{CHANNEL_GAIN, SPEED_GAIN, TORQUE_GAIN};
use crate::data::noise_floor::noise_draws;
use crate::data::study::{Study, Trial};
use crate::fit::normal_equations::{self, Block};
use crate::fit::output_error::Fit;
use crate::model::prediction::{Drive, outputs_on};
use crate::model::prior::N_NOMINAL;
use motor::effect::{Instrument, Plant};
use nalgebra::{DMatrix, DVector};
use signal::dot;
use std::borrow::Cow;

/// Gain for which the derivative is taken.
const GAIN_STEP: f64 = 1e-3;
/// Draws of the input noise.
const DRAWS: u64 = 12;
/// Seed of the draws.
const SEED: u64 = 8372;
/// Lengths of the batches over which scores are held against the sum of their squares, blocks.
const BATCHES: [usize; 3] = [1, 5, 25];
/// Batches from which a variance is worth something.
const LEAST_BATCHES: usize = 8;

/// Covariance of the fitted coordinates, in their order.
pub fn covariance(study: &Study, fit: &Fit) -> DMatrix<f64> {
    let case = &study.fitted.case;
    let all = normal_equations::total(&fit.blocks);
    let curvature = &all.gram + DMatrix::from_diagonal(&fit.penalty.weight);
    let n = curvature.nrows();
    let inverse = curvature
        .try_inverse()
        .unwrap_or_else(|| DMatrix::zeros(n, n));
    let mut scores = &all.gram * rows_per_datum(study, fit) + priors(fit);
    if let Some(waveform) = case.waveform() {
        let plant = fit.hypothesis.plant(&study.prior);
        scores += inputs(waveform, &plant, fit) + instruments(waveform, &plant, fit);
    }
    &inverse * scores * &inverse
}

/// So many values of the residual count as one, because neighbours go together.
fn rows_per_datum(study: &Study, fit: &Fit) -> f64 {
    if study.fitted.case.is_table() {
        return fit.inflation;
    }
    let nominals = fit.free.iter().filter(|&&k| k < N_NOMINAL).count();
    let of = |&length: &usize| {
        let batches: Vec<Block> = fit
            .blocks
            .chunks_exact(length)
            .map(normal_equations::total)
            .collect();
        match batches.len() < LEAST_BATCHES {
            true => 1.0,
            false => normal_equations::score_inflation(&batches, nominals),
        }
    };
    BATCHES.iter().map(of).fold(1.0, f64::max)
}

/// The pull of the priors on a motor that is not as believed: `W Sigma W` with the variances `Sigma` of the priors.
fn priors(fit: &Fit) -> DMatrix<f64> {
    let pull = |(&k, &weight): (&usize, &f64)| {
        // Priors weigh `inflation` times their inverse variance in the fit.
        let believed = fit.hypothesis.is_prior(k);
        weight * if believed { fit.inflation } else { 1.0 }
    };
    let all = fit.free.iter().zip(fit.penalty.weight.iter());
    DMatrix::from_diagonal(&DVector::from_iterator(fit.free.len(), all.map(pull)))
}

/// Score of a change of the residual.
fn score(fit: &Fit, change: &[f64]) -> DVector<f64> {
    DVector::from_iterator(fit.free.len(), fit.jacobian.iter().map(|j| dot(j, change)))
}

fn outer(score: &DVector<f64>, variance: f64) -> DMatrix<f64> {
    score * score.transpose() * variance
}

/// Noise of the inputs, drawn and passed through the model.
fn inputs(waveform: &Waveform, plant: &Plant, fit: &Fit) -> DMatrix<f64> {
    let n = fit.free.len();
    let of = |change: Vec<f64>| outer(&score(fit, &change), 1.0 / DRAWS as f64);
    let draws = noise_draws(waveform, plant, SEED, DRAWS, of);
    draws
        .into_iter()
        .fold(DMatrix::zeros(n, n), |sum, m| sum + m)
}

/// Gains of the channels, each off by its class.
fn instruments(waveform: &Waveform, plant: &Plant, fit: &Fit) -> DMatrix<f64> {
    let n = fit.free.len();
    let measured = |channel: usize| {
        let mut change = vec![0.0; waveform.measured.len() * N_CHANNELS];
        for (row, (y, w)) in waveform.measured.iter().zip(&waveform.weight).enumerate() {
            change[row * N_CHANNELS + channel] = y[channel] * w[channel];
        }
        score(fit, &change)
    };
    let driven = |drive: Drive<'_>| {
        let there = outputs_on(waveform, plant, &drive);
        let change = there.iter().zip(&fit.outputs);
        score(
            fit,
            &change
                .map(|(a, b)| (a - b) / GAIN_STEP)
                .collect::<Vec<f64>>(),
        )
    };
    let mut sum = DMatrix::zeros(n, n);
    if !fit.hypothesis.refits_instrument(Instrument::Currents) {
        for current in 0..3 {
            sum += outer(&measured(current), CHANNEL_GAIN.powi(2));
        }
    }
    if !fit.hypothesis.refits_instrument(Instrument::Voltages) {
        // What all three share of their gains: the rest is unbalance and zero sequence.
        sum += outer(
            &driven(louder_voltage(waveform)),
            CHANNEL_GAIN.powi(2) / 3.0,
        );
    }
    if waveform.input_noise.torque > 0.0 {
        sum += outer(&driven(louder_torque(waveform)), TORQUE_GAIN.powi(2));
    }
    let speed = match waveform.speed_is_input {
        true => driven(faster(waveform)),
        false => measured(SPEED),
    };
    sum + outer(&speed, SPEED_GAIN.powi(2))
}

fn louder_voltage(waveform: &Waveform) -> Drive<'_> {
    let mut drive = Drive::of(waveform);
    let u_s = &mut drive.inputs.to_mut().u_s;
    u_s.iter_mut().for_each(|u| *u *= 1.0 + GAIN_STEP);
    drive
}

fn louder_torque(waveform: &Waveform) -> Drive<'_> {
    let mut drive = Drive::of(waveform);
    let torque = &mut drive.inputs.to_mut().tau_load;
    torque.iter_mut().for_each(|x| *x *= 1.0 + GAIN_STEP);
    drive
}

fn faster(waveform: &Waveform) -> Drive<'_> {
    let faster = waveform
        .speed
        .iter()
        .map(|x| x * (1.0 + GAIN_STEP))
        .collect();
    Drive {
        speed: Cow::Owned(faster),
        ..Drive::of(waveform)
    }
}

/// Standard error of coordinate `k`, zero if it was not fitted.
pub fn coordinate_error(trial: &Trial, covariance: &DMatrix<f64>, k: usize) -> f64 {
    let position = trial.fit.free.iter().position(|&free| free == k);
    position.map_or(0.0, |p| covariance[(p, p)].max(0.0).sqrt())
}

#[cfg(test)]
mod tests;
