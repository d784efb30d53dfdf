//! A recording made ready for simulation: denoised inputs, weighted outputs, what is known about its start.

use super::judged_speed::JudgedSpeed;
use super::switched_off::switched_off;
use super::whole_blocks;
use crate::data::channels::{N_CHANNELS, SPEED};
use crate::data::inputs::{InputNoise, Load, measured_speed};
use crate::data::unsupported::{Unsupported, check_clock, check_size};
use crate::fit::nuisance::Nuisance;
use crate::model::speed_gain::gain_of;
use audit::turns_from_the_start;
use motor::dynamic::clarke;
use motor::effect::{Between, Inputs, Plant, Rated, Timeline};
use num_complex::Complex64;
use recording::{Channel, Recording, StartsFrom, Supply as SupplyKind, VoltageKind};
use signal::{Supply, Windows, denoise, refined, sigma};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// Trust in the model of a current sensor beside its noise: half a per cent of the reading.
pub const RELATIVE_CURRENT: f64 = 0.005;
/// Length of a block, s: short, so that a direct-on-line start reaches every fold.
const BLOCK: f64 = 0.04;
/// Time after an interruption of the current during which it is not judged, s.
const AFTER_SWITCH: f64 = 0.03;
/// Longest sampling time at which two samples make one step of integration, s ...
const LONGEST_SMOOTH: f64 = 2.6e-4;
/// ... and that of finer inputs of a slower recording.
const FINE: f64 = 2e-4;
/// Residual rows per second that are worth their time.
const ROW_RATE: f64 = 5500.0;

/// Measured speeds in the scale of a hypothesis.
pub struct Speeds<'a> {
    /// Smoothed speed, rad/s.
    pub speed: Cow<'a, [f64]>,
    /// Speed at the start, rad/s.
    pub running_at: Option<f64>,
    /// Speeds after the cuts of the timeline, rad/s.
    pub running_at_cuts: Vec<Option<f64>>,
    /// Supply and measured angle.
    pub timeline: Arc<Timeline>,
}

/// A recording made ready.
#[derive(Clone, Debug)]
pub struct Waveform {
    /// Voltage and load torque as measured, denoised.
    pub inputs: Inputs,
    /// Voltage between samples.
    pub between: Between,
    /// Supply frequency and measured angle.
    pub timeline: Arc<Timeline>,
    /// Smoothed speed for simulations in which it is given, rad/s; empty without a speed channel.
    pub speed: Vec<f64>,
    /// Whether the mechanical equation cannot be judged: the speed is an input.
    pub speed_is_input: bool,
    /// Speed at the start unless from standstill.
    pub running_at: Option<f64>,
    /// Speed at the first sample after each cut of the timeline; `None` from standstill.
    pub running_at_cuts: Vec<Option<f64>>,
    /// Whether the speed at the start is not measured, but that at which the model carries the load.
    pub settles: bool,
    /// Samples at which a switch has taken the motor off the supply.
    pub open: Vec<Range<usize>>,
    /// Integration steps per residual row.
    pub decimation: usize,
    /// Measured rows.
    pub measured: Vec<[f64; N_CHANNELS]>,
    /// One over the standard deviation; zero where not judged.
    pub weight: Vec<[f64; N_CHANNELS]>,
    /// Rows per block.
    pub block: usize,
    /// Denoised supply, one value per input sample.
    pub supply: Supply,
    /// Input samples per sample of the recording.
    pub finer: usize,
    /// The supply as it was denoised, at the rate of the recording, where the inputs are finer.
    pub coarse: Option<Supply>,
    /// Noise of the inputs before they were smoothed.
    pub input_noise: InputNoise,
    /// How the load torque was smoothed.
    pub load_windows: Windows,
    /// How the speed was smoothed.
    pub speed_windows: Windows,
    /// Time for which each value of the speed is shown, s; zero where each sample has a new one.
    pub speed_held_s: f64,
    /// Whether an inverter feeds the motor.
    pub inverter: bool,
    /// Whether the scale of the speed is a free parameter: the speeds here are right up to a factor near one.
    pub speed_scale_is_free: bool,
    /// What nothing is judged by: the state in which the motor was when a recording began.
    pub nuisance: Nuisance,
}

impl Waveform {
    /// Prepares a recording.
    ///
    /// # Errors
    /// Without voltages or currents, with a clock that is not even, or with fewer than five blocks.
    pub fn new(rec: &Recording, rated: &Rated<f64>) -> Result<Self, Unsupported> {
        let voltages = rec.voltages().ok_or_else(|| {
            Unsupported::new(
                "the recording has no three phase voltages",
                "record va, vb and vc: the model is driven by them",
            )
        })?;
        let currents = rec.currents().ok_or_else(|| {
            Unsupported::new(
                "the recording has no three currents",
                "record ia, ib and ic",
            )
        })?;
        check_clock(rec)?;
        check_size(rec)?;
        let t_sample = rec.t_sample();
        let sigma_u = sigma(rec, Channel::VOLTAGES[0], voltages[0]);
        let raw: Vec<_> = vectors(voltages);
        // Clarke's transform of three independent noises: sqrt(2/3) of one phase in each axis.
        let axis_noise = sigma_u * (2.0f64 / 3.0).sqrt();
        let supply = denoise(&raw, t_sample, axis_noise, rated.omega_sync);
        check_between_samples(rec, &supply)?;
        let load = Load::new(rec)?;
        let speed = measured_speed(rec, t_sample);
        let finer = finer(rec, &supply);
        let (supply, coarse) = match finer {
            1 => (supply, None),
            _ => (supply.finer(finer), Some(supply)),
        };
        let t_sample = t_sample / finer as f64;
        let between = between(rec, t_sample);
        let fine = |x: Vec<f64>| refined(x, finer);
        let theta_mech = fine(measured_angle(rec));
        let running_at = running_at(rec, rated);
        let mut case = Self {
            inputs: Inputs {
                t_sample,
                u_s: supply.u_s.clone(),
                tau_load: fine(load.torque.value),
            },
            between,
            timeline: Arc::new(Timeline {
                t_sample,
                omega_sync: supply.omega_sync.clone(),
                theta_mech,
                cuts: Vec::new(),
            }),
            speed: fine(speed.value),
            speed_is_input: load.unknown,
            running_at,
            running_at_cuts: Vec::new(),
            settles: rec.speed().is_none(),
            open: Vec::new(),
            decimation: 1,
            measured: Vec::new(),
            weight: Vec::new(),
            block: 1,
            supply,
            finer,
            coarse,
            input_noise: InputNoise {
                voltage: axis_noise,
                torque: load.torque.noise,
                speed: if load.unknown { speed.noise } else { 0.0 },
            },
            load_windows: load.torque.windows,
            speed_windows: speed.windows,
            speed_held_s: 0.0,
            inverter: rec.metadata.supply == SupplyKind::Inverter,
            speed_scale_is_free: false,
            nuisance: Nuisance::default(),
        };
        case.fill_rows(rec, voltages, currents, sigma_u);
        if case.blocks().len() < 5 {
            return Err(Unsupported::new(
                "the recording is shorter than five blocks of 40 ms",
                "record at least one second",
            ));
        }
        Ok(case)
    }

    /// Time between residual rows, s.
    pub fn t_row(&self) -> f64 {
        self.inputs.t_sample * self.samples_per_row() as f64
    }

    /// Time of an integration step, s.
    pub fn t_step(&self) -> f64 {
        self.inputs.t_sample * self.between.stride() as f64
    }

    /// Whether the speed was measured and the model is judged by it: it is not what drives the model.
    pub fn judges_speed(&self) -> bool {
        !self.speed.is_empty() && !self.speed_is_input
    }

    /// Input samples per residual row.
    pub fn samples_per_row(&self) -> usize {
        self.between.stride() * self.decimation
    }

    /// Time of a residual row since the first sample, s, parts that were left out counted.
    pub fn time_of(&self, row: usize) -> f64 {
        self.timeline.clock(row as f64 * self.t_row())
    }

    /// The measured speeds that drive a simulation of `plant`, from the smoothed `speed`: with a free scale they are what
    /// the plant's speed sensor would have to see to show the channel.
    pub fn speeds<'a>(&self, plant: &Plant, speed: &'a [f64]) -> Speeds<'a> {
        let gain = gain_of(&plant.effects);
        if !self.speed_scale_is_free || gain == 1.0 {
            return Speeds {
                speed: Cow::Borrowed(speed),
                running_at: self.running_at,
                running_at_cuts: self.running_at_cuts.clone(),
                timeline: self.timeline.clone(),
            };
        }
        let over = |x: &[f64]| x.iter().map(|x| x / gain).collect::<Vec<f64>>();
        Speeds {
            speed: Cow::Owned(over(speed)),
            running_at: self.running_at.map(|x| x / gain),
            running_at_cuts: self
                .running_at_cuts
                .iter()
                .map(|omega| omega.map(|x| x / gain))
                .collect(),
            timeline: Arc::new(Timeline {
                theta_mech: over(&self.timeline.theta_mech),
                ..(*self.timeline).clone()
            }),
        }
    }

    /// The same with the scale of the speed as a plant has it, for everything that looks at the measured speed.
    pub fn as_seen_by(&self, plant: &Plant) -> Self {
        let mut case = self.clone();
        let speeds = self.speeds(plant, &self.speed);
        case.speed = speeds.speed.into_owned();
        (case.running_at, case.timeline) = (speeds.running_at, speeds.timeline);
        case.running_at_cuts = speeds.running_at_cuts;
        if self.speed_scale_is_free {
            let gain = gain_of(&plant.effects);
            for (y, w) in case.measured.iter_mut().zip(&mut case.weight) {
                y[SPEED] /= gain;
                w[SPEED] *= gain;
            }
        }
        case
    }

    /// Rows of each block; a short rest joins the last block.
    pub fn blocks(&self) -> Vec<Range<usize>> {
        whole_blocks(self.measured.len(), self.block)
    }

    fn fill_rows(
        &mut self,
        rec: &Recording,
        voltages: [&[f64]; 3],
        currents: [&[f64]; 3],
        sigma_u: f64,
    ) {
        let h = self.t_step();
        // Every sample of a slow recording is a row.
        let step = match self.finer {
            1 => ((1.0 / ROW_RATE / h).round() as usize).max(1),
            finer => finer / self.between.stride(),
        };
        self.decimation = step;
        self.block = ((BLOCK / self.t_row()) as usize).max(1);
        let sigma_i = [0, 1, 2].map(|k| sigma(rec, Channel::CURRENTS[k], currents[k]));
        let speed = rec.speed().filter(|_| !self.speed_is_input);
        let speed = speed.map(|x| JudgedSpeed::new(rec, x));
        let held_for = speed.as_ref().map_or(0.0, JudgedSpeed::held_for);
        self.speed_held_s = held_for * rec.t_sample();
        let w_zero = 3f64.sqrt() / sigma_u;
        let stride = self.samples_per_row() / self.finer;
        let whole = (self.between.stride() / self.finer).max(1);
        let last = (rec.len() - 1) / whole * whole;
        let limits = [0, 1, 2].map(|k| clip_limit(rec, k, currents[k]));
        let open = switched_off(currents, sigma_i, rec.t_sample());
        let settles = (AFTER_SWITCH / rec.t_sample()) as usize;
        for k in (0..=last).step_by(stride) {
            let i = currents.map(|c| c[k]);
            let w_i = |p: usize| {
                let settled = open
                    .iter()
                    .all(|off| k + 10 < off.start || k > off.start + settles);
                let judged = settled && i[p].abs() < limits[p];
                f64::from(u8::from(judged)) / sigma_i[p].hypot(RELATIVE_CURRENT * i[p])
            };
            let zero = (voltages[0][k] + voltages[1][k] + voltages[2][k]) / 3.0;
            let row = (k + 1).saturating_sub(stride)..k + 1;
            let (omega, w_speed) = speed.as_ref().map_or((0.0, 0.0), |speed| speed.in_row(row));
            self.measured.push([i[0], i[1], i[2], omega, zero]);
            self.weight.push([w_i(0), w_i(1), w_i(2), w_speed, w_zero]);
        }
        let times = |r: &Range<usize>| r.start * self.finer..r.end * self.finer;
        self.open = open.iter().map(times).collect();
    }
}

/// Magnitude from which a current counts as clipped: its largest, if it stands still there.
fn clip_limit(rec: &Recording, phase: usize, x: &[f64]) -> f64 {
    if let Some(full) = rec.metadata.sensors.full_scale(Channel::CURRENTS[phase]) {
        return 0.999 * full;
    }
    let top = x.iter().fold(0.0f64, |a, b| a.max(b.abs()));
    let flat = x
        .windows(3)
        .filter(|w| w[0].abs() > 0.995 * top && w[0] == w[1] && w[1] == w[2]);
    if flat.count() > 2 {
        0.99 * top
    } else {
        f64::INFINITY
    }
}

fn vectors(abc: [&[f64]; 3]) -> Vec<Complex64> {
    (0..abc[0].len())
        .map(|k| clarke(abc.map(|x| x[k])))
        .collect()
}

/// Input samples per sample of a recording: voltages that are smooth between samples are known there too, as far as
/// amplitude, angle and harmonics describe them, and a slow recording takes finer steps.
fn finer(rec: &Recording, supply: &Supply) -> usize {
    let held = rec.metadata.voltage == VoltageKind::Hold || !supply.denoised;
    match held || rec.t_sample() <= LONGEST_SMOOTH {
        true => 1,
        // An even number: a step spans two input samples.
        false => 2 * (rec.t_sample() / (2.0 * FINE)).ceil() as usize,
    }
}

/// A slow recording needs a voltage that is known between its samples.
fn check_between_samples(rec: &Recording, supply: &Supply) -> Result<(), Unsupported> {
    let known = rec.metadata.voltage == VoltageKind::Hold || supply.denoised;
    if known || rec.t_sample() <= LONGEST_SMOOTH {
        return Ok(());
    }
    Err(Unsupported::new(
        "fundamental and harmonics do not describe the voltage, so it is unknown between samples this far apart",
        "record at 4 kHz or faster; where an inverter holds the voltage between samples, declare voltage = \"hold\"",
    ))
}

/// Double steps while they stay below a quarter of a millisecond.
fn between(rec: &Recording, t_sample: f64) -> Between {
    if rec.metadata.voltage == VoltageKind::Hold || t_sample > LONGEST_SMOOTH {
        Between::Held
    } else {
        Between::Smooth
    }
}

/// Shaft angle by integrating the measured speed (trapezoids), rad.
fn measured_angle(rec: &Recording) -> Vec<f64> {
    let Some(speed) = rec.speed() else {
        return Vec::new();
    };
    let mut theta = 0.0;
    let mut next = |w: &[f64]| {
        theta += 0.5 * (w[0] + w[1]) * rec.t_sample();
        theta
    };
    std::iter::once(0.0)
        .chain(speed.windows(2).map(&mut next))
        .collect()
}

/// Speed at the first sample, rad/s, if the motor already runs: the mean of 20 ms, or rated speed where none was recorded.
pub fn running_at(rec: &Recording, rated: &Rated<f64>) -> Option<f64> {
    let currents = rec.currents()?;
    let first_period = |speed: &[f64]| {
        let n = ((0.02 / rec.t_sample()) as usize).clamp(1, speed.len());
        speed[..n].iter().sum::<f64>() / n as f64
    };
    let initial = rec.speed().map_or(rated.speed(), first_period);
    match rec.metadata.starts_from {
        StartsFrom::Standstill => turns_from_the_start(rec, rated.speed())
            .is_some()
            .then_some(initial),
        StartsFrom::Running => Some(initial),
        StartsFrom::Unknown => {
            let quiet = (currents[0][0].abs()).max(currents[1][0].abs()) < 0.1 * rated.current;
            let still = rec
                .speed_at_first()
                .is_none_or(|speed| speed.abs() < 0.05 * rated.speed());
            (!(quiet && still)).then_some(initial)
        }
    }
}

#[cfg(test)]
mod tests;
