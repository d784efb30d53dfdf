//! Gains and delays from the phasors of all blocks and recordings.

use std::f64::consts::SQRT_2;

use nalgebra::{Matrix2, Vector2};
use num_complex::Complex64;

use super::{CHANNELS, Setup, Sine};

/// Largest over smallest frequency from which on a delay is told from a rotation.
const APART: f64 = 1.2;
/// Standard errors below it are rounding of the recording, not knowledge.
const LEAST_ERROR: f64 = 1e-7;

/// A number and its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its standard error by the scatter of the blocks.
    pub error: f64,
}

/// What was found of the channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Factor on what each channel shows.
    pub gain: [Estimate; CHANNELS],
    /// By how much each channel is later than the mean of the current channels, s.
    pub delay_s: [Estimate; CHANNELS],
    /// Rotation that does not grow with the frequency, rad; `None` where the recordings have one frequency.
    pub rotation_rad: Option<[Estimate; CHANNELS]>,
    /// Frequencies of the recordings, Hz.
    pub frequencies_hz: Vec<f64>,
    /// Root mean square of the voltage and of the current that the channels show, the largest of the recordings, V and A.
    pub amplitude_rms: [f64; 2],
    /// Blocks of ten cycles.
    pub blocks: usize,
}

/// Logarithm of the gain and phase of each channel in one recording.
pub(super) struct Relative {
    pub omega: f64,
    pub log_gain: [Estimate; CHANNELS],
    pub phase: [Estimate; CHANNELS],
}

pub(super) fn combine(sines: &[Sine], setup: &Setup) -> Found {
    let all: Vec<Relative> = sines.iter().map(|sine| relative(sine, setup)).collect();
    let gain = std::array::from_fn(|k| {
        let log = pooled(all.iter().map(|one| one.log_gain[k]));
        Estimate {
            value: log.value.exp(),
            error: log.error,
        }
    });
    let (delay_s, rotation_rad) = delays(&all);
    Found {
        gain,
        delay_s,
        rotation_rad,
        frequencies_hz: all
            .iter()
            .map(|one| one.omega / std::f64::consts::TAU)
            .collect(),
        amplitude_rms: [0, 3].map(|first| {
            let amplitude = |sine: &Sine| sine.seen_from_the_first()[first].norm() / SQRT_2;
            sines.iter().map(amplitude).fold(0.0, f64::max)
        }),
        blocks: sines.iter().map(|sine| sine.blocks.len()).sum(),
    }
}

pub(super) fn relative(sine: &Sine, setup: &Setup) -> Relative {
    let roll_off = sine.omega * setup.roll_off_s;
    let truth = [setup.true_volt, setup.true_amp]
        .map(|rms| rms.map(|rms| (rms * SQRT_2).ln() - (0.5 * roll_off * roll_off).ln_1p()));
    let load = sine.omega * setup.load_time_constant_s;
    let each = |of: &dyn Fn(&[Complex64; CHANNELS], usize) -> f64| {
        std::array::from_fn(|k| {
            let scatter = scattered(sine.blocks.iter().map(|block| of(block, k)));
            Estimate {
                error: scatter.error.hypot(sine.rounding[k]),
                ..scatter
            }
        })
    };
    Relative {
        omega: sine.omega,
        log_gain: each(&|block, k| {
            let group = &block[k / 3 * 3..][..3];
            let mean = group.iter().map(|p| p.norm().ln()).sum::<f64>() / 3.0;
            truth[k / 3].unwrap_or(mean) - block[k].norm().ln()
        }),
        phase: each(&|block, k| {
            let currents: Complex64 = block[3..].iter().map(|p| p / p.norm()).sum();
            let ahead = if k < 3 { load } else { 0.0 };
            (block[k] * currents.conj()).arg() - ahead
        }),
    }
}

/// Mean and its standard error.
fn scattered(values: impl Iterator<Item = f64> + Clone) -> Estimate {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    let squares = values.map(|x| (x - mean) * (x - mean)).sum::<f64>();
    Estimate {
        value: mean,
        error: (squares / (n - 1.0) / n).sqrt().max(LEAST_ERROR),
    }
}

/// Mean weighted by the errors.
fn pooled(estimates: impl Iterator<Item = Estimate>) -> Estimate {
    let (mut sum, mut weight) = (0.0, 0.0);
    for one in estimates {
        let w = one.error.powi(-2);
        sum += w * one.value;
        weight += w;
    }
    Estimate {
        value: sum / weight,
        error: weight.powf(-0.5),
    }
}

/// Delays, and rotations where frequencies tell them apart: `phase = rotation - w delay`.
fn delays(all: &[Relative]) -> ([Estimate; CHANNELS], Option<[Estimate; CHANNELS]>) {
    let (least, most) = all
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(least, most), one| {
            (least.min(one.omega), most.max(one.omega))
        });
    if most < APART * least {
        let late = |one: &Relative, k: usize| Estimate {
            value: -one.phase[k].value / one.omega,
            error: one.phase[k].error / one.omega,
        };
        let delay = std::array::from_fn(|k| pooled(all.iter().map(|one| late(one, k))));
        return (delay, None);
    }
    let lines: [[Estimate; 2]; CHANNELS] = std::array::from_fn(|k| line(all, k));
    (lines.map(|line| line[1]), Some(lines.map(|line| line[0])))
}

/// Rotation and delay of one channel by weighted least squares.
fn line(all: &[Relative], k: usize) -> [Estimate; 2] {
    let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
    for one in all {
        let row = Vector2::new(1.0, -one.omega);
        let weight = one.phase[k].error.powi(-2);
        normal += row * row.transpose() * weight;
        right += row * one.phase[k].value * weight;
    }
    let covariance = normal.try_inverse().unwrap_or_else(Matrix2::zeros);
    let solution = covariance * right;
    [0, 1].map(|i| Estimate {
        value: solution[i],
        error: covariance[(i, i)].max(0.0).sqrt(),
    })
}
