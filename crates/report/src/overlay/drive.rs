//! A recording as the inputs of a simulation.

use std::ops::Range;
use std::sync::Arc;

use discovery::{carried_speed, running_at};
use motor::dynamic::clarke;
use motor::effect::{Between, Inputs, Outputs, Plant, Rated, Run, SpeedSource, Timeline, simulate};
use num_complex::Complex64;
use recording::{LoadTorque, Recording, VoltageKind};

/// Longest sampling time at which two samples make one integration step, s.
const SMOOTH_BELOW_S: f64 = 2.6e-4;
/// Half the time over which frequency and imposed speed are smoothed, s: half a period of 50 Hz.
const SMOOTHING_S: f64 = 0.01;

/// What drives the models.
pub struct Drive {
    t_start: f64,
    inputs: Inputs,
    between: Between,
    timeline: Arc<Timeline>,
    imposed_speed: Option<Vec<f64>>,
    running_at: Option<f64>,
    /// Whether the speed at the start is not measured, but that at which a model carries the load.
    settles: bool,
    /// Whether the recording holds the torque at the shaft.
    torque_measured: bool,
}

/// Supply over some samples.
pub struct Point {
    /// Mean amplitude of the phase voltage, V.
    pub amplitude: f64,
    /// Mean frequency, rad/s.
    pub omega_sync: f64,
}

impl Drive {
    /// The drive of a recording; `None` without voltages, currents or an even clock.
    pub fn new(recording: &Recording, rated: &Rated<f64>) -> Option<Self> {
        let voltages = recording.voltages()?;
        recording.currents()?;
        let t_sample = recording.t_sample();
        if !is_even(recording) {
            return None;
        }
        let u_s: Vec<Complex64> = (0..recording.len())
            .map(|k| clarke(voltages.map(|u| u[k])))
            .collect();
        let half = (SMOOTHING_S / t_sample).ceil() as usize;
        Some(Drive {
            t_start: recording.t()[0],
            between: between(recording),
            timeline: Arc::new(Timeline {
                t_sample,
                omega_sync: frequency(&u_s, t_sample, half),
                theta_mech: angle(recording),
                cuts: Vec::new(),
            }),
            imposed_speed: imposed_speed(recording, half),
            running_at: running_at(recording, rated),
            settles: recording.speed().is_none(),
            torque_measured: recording.metadata.load_torque != LoadTorque::Friction
                && recording.torque().is_some(),
            inputs: Inputs {
                t_sample,
                tau_load: load(recording),
                u_s,
            },
        })
    }

    /// Runs a motor on this drive.
    pub fn run(&self, plant: &Plant) -> Outputs {
        let imposed = self.imposed_speed.as_deref();
        let mut plant = plant.clone();
        if self.torque_measured {
            // A measured brake torque holds the friction of the load.
            plant.mechanics.load_friction = 0.0;
        }
        simulate(
            &plant,
            &Run {
                inputs: &self.inputs,
                between: self.between,
                speed: imposed.map_or(SpeedSource::Free, SpeedSource::Imposed),
                timeline: &self.timeline,
                running_at: self.begins_at(&plant),
                running_at_cuts: &[],
                offsets: &[],
                open: &[],
            },
        )
    }

    /// Speed with which a model begins, rad/s; `None` from standstill.
    fn begins_at(&self, plant: &Plant) -> Option<f64> {
        let measured = self.running_at?;
        let omega_sync = self.timeline.omega_sync[0];
        let carried = || carried_speed(plant, &self.inputs, omega_sync, 0);
        self.settles.then(carried).flatten().or(Some(measured))
    }

    /// Whether the measured speed is given to the models instead of compared with theirs.
    pub fn imposes_speed(&self) -> bool {
        self.imposed_speed.is_some()
    }

    /// Rows of a simulation.
    pub fn rows(&self) -> usize {
        (self.inputs.u_s.len() - 1) / self.between.stride() + 1
    }

    /// The sample of a row.
    pub fn sample(&self, row: usize) -> usize {
        row * self.between.stride()
    }

    /// Time of a row, s.
    pub fn t(&self, row: usize) -> f64 {
        self.t_start + row as f64 * self.t_row()
    }

    /// Time between rows, s.
    pub fn t_row(&self) -> f64 {
        self.inputs.t_sample * self.between.stride() as f64
    }

    /// The rows within a stretch of `length_s` around `t`.
    pub fn rows_around(&self, t: f64, length_s: f64) -> Range<usize> {
        let at = |t: f64| ((t - self.t_start) / self.t_row()).max(0.0) as usize;
        at(t - 0.5 * length_s)..(at(t + 0.5 * length_s) + 1).min(self.rows())
    }

    /// The supply over some samples.
    pub fn point(&self, samples: Range<usize>) -> Point {
        let n = samples.len().max(1) as f64;
        let amplitude = self.inputs.u_s[samples.clone()].iter().map(|u| u.norm());
        let omega = &self.timeline.omega_sync[samples];
        Point {
            amplitude: amplitude.sum::<f64>() / n,
            omega_sync: omega.iter().sum::<f64>() / n,
        }
    }
}

fn is_even(recording: &Recording) -> bool {
    let t_sample = recording.t_sample();
    let off = |pair: &[f64]| (pair[1] - pair[0] - t_sample).abs() > 0.01 * t_sample;
    !recording.t().windows(2).any(off)
}

fn between(recording: &Recording) -> Between {
    let held = recording.metadata.voltage == VoltageKind::Hold;
    if held || recording.t_sample() > SMOOTH_BELOW_S {
        Between::Held
    } else {
        Between::Smooth
    }
}

/// Frequency of the voltage vector, from its turn over `half` samples to either side, rad/s.
fn frequency(u_s: &[Complex64], t_sample: f64, half: usize) -> Vec<f64> {
    let mut theta = Vec::with_capacity(u_s.len());
    let mut turned = 0.0;
    for (k, u) in u_s.iter().enumerate() {
        if k > 0 {
            turned += (u * u_s[k - 1].conj()).arg();
        }
        theta.push(turned);
    }
    let last = theta.len() - 1;
    let slope = |k: usize| {
        let (from, to) = (k.saturating_sub(half), (k + half).min(last));
        (theta[to] - theta[from]) / ((to - from).max(1) as f64 * t_sample)
    };
    (0..=last).map(slope).collect()
}

/// Shaft angle by integrating the measured speed, rad; empty without one.
fn angle(recording: &Recording) -> Vec<f64> {
    let mut theta = 0.0;
    let steps = recording
        .speed()
        .unwrap_or_default()
        .windows(2)
        .map(|pair| {
            theta += 0.5 * (pair[0] + pair[1]) * recording.t_sample();
            theta
        });
    let steps: Vec<f64> = steps.collect();
    if steps.is_empty() {
        return steps;
    }
    [vec![0.0], steps].concat()
}

fn load(recording: &Recording) -> Vec<f64> {
    match (recording.metadata.load_torque, recording.torque()) {
        (LoadTorque::Friction, _) | (_, None) => vec![0.0; recording.len()],
        (_, Some(torque)) => torque.to_vec(),
    }
}

/// The smoothed speed where the load is unknown, so that nothing but the measurement can tell it.
fn imposed_speed(recording: &Recording, half: usize) -> Option<Vec<f64>> {
    let known =
        recording.metadata.load_torque == LoadTorque::Friction || recording.torque().is_some();
    let speed = recording.speed().filter(|_| !known)?;
    let mut sums = vec![0.0];
    for x in speed {
        sums.push(sums[sums.len() - 1] + x);
    }
    let mean = |k: usize| {
        let reach = half.min(k).min(speed.len() - 1 - k);
        (sums[k + reach + 1] - sums[k - reach]) / (2 * reach + 1) as f64
    };
    Some((0..speed.len()).map(mean).collect())
}
