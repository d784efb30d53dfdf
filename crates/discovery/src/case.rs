//! A recording made ready for simulation: denoised inputs, weighted outputs, what is known about its start.

use crate::free_scale;
use crate::signal::{Supply, denoise, estimated_sigma, smooth};
use crate::table::{self, Point};
use motor::dynamic::clarke;
use motor::effects::{Between, Inputs, Plant, Rated, Timeline};
use num_complex::Complex64;
use recording::{
    Channel, LoadTable, LoadTorque, Recording, StartsFrom, Supply as SupplyKind, VoltageKind,
};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// Output channels in the order of a residual row.
pub(crate) const CHANNELS: [&str; 5] = ["ia", "ib", "ic", "speed", "v0"];
/// The speed among them.
const SPEED: usize = 3;
/// Number of output channels.
pub(crate) const N_CHANNELS: usize = CHANNELS.len();
/// Trust in the model of a current sensor beside its noise: half a per cent of the reading.
pub(crate) const RELATIVE_CURRENT: f64 = 0.005;
/// Length of a block, s: short, so that a direct-on-line start reaches every fold.
const BLOCK: f64 = 0.04;
/// Time after an interruption of the current during which it is not judged, s.
const AFTER_SWITCH: f64 = 0.03;
/// Mean square of a current, in units of its noise, from which it is more than noise ...
const CARRIES: f64 = 20.0;
/// ... and up to which it is only noise: three standard deviations over a period of 200 samples are 1.3.
const NOISE_ONLY: f64 = 1.6;
/// Residual rows per second that are worth their time.
const ROW_RATE: f64 = 5500.0;

/// Why a recording cannot be judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Unsupported {
    /// What is missing or wrong.
    pub reason: String,
    /// What to do about it.
    pub remedy: String,
}

impl Unsupported {
    pub(crate) fn new(reason: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self {
            reason: reason.into(),
            remedy: remedy.into(),
        }
    }
}

/// Measured speeds in the scale of a hypothesis.
pub(crate) struct Speeds<'a> {
    /// Smoothed speed, rad/s.
    pub speed: Cow<'a, [f64]>,
    /// Speed at the start, rad/s.
    pub running_at: Option<f64>,
    /// Supply and measured angle.
    pub timeline: Arc<Timeline>,
}

/// A recording made ready.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    /// Inputs as measured, voltage denoised.
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
    /// Denoised supply.
    pub supply: Supply,
    /// Noise of the raw voltage, V per axis, and of the torque, N m.
    pub input_noise: (f64, f64),
    /// Whether an inverter feeds the motor.
    pub inverter: bool,
    /// Whether the scale of the speed is a free parameter: the speeds here are right up to a factor near one.
    pub speed_scale_is_free: bool,
    /// Operating points instead of samples.
    pub table: Option<Vec<Point>>,
}

impl Case {
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
        let t_sample = rec.t_sample();
        let sigma_u = sigma(rec, Channel::VOLTAGES[0], voltages[0]);
        let raw: Vec<_> = vectors(voltages);
        // Clarke's transform of three independent noises: sqrt(2/3) of one phase in each axis.
        let axis_noise = sigma_u * (2.0f64 / 3.0).sqrt();
        let supply = denoise(&raw, t_sample, axis_noise, rated.omega_sync);
        let between = between(rec, t_sample);
        let load = Load::new(rec);
        let theta_mech = measured_angle(rec);
        let speed = smoothed_speed(rec, t_sample);
        let running_at = running_at(rec, currents, rated);
        let mut case = Self {
            inputs: Inputs {
                t_sample,
                u_s: supply.u_s.clone(),
                tau_load: load.torque,
            },
            between,
            timeline: Arc::new(Timeline {
                t_sample,
                omega_sync: supply.omega_sync.clone(),
                theta_mech,
            }),
            speed,
            speed_is_input: load.unknown,
            running_at,
            open: Vec::new(),
            decimation: 1,
            measured: Vec::new(),
            weight: Vec::new(),
            block: 1,
            supply,
            input_noise: (axis_noise, load.noise),
            inverter: rec.metadata.supply == SupplyKind::Inverter,
            speed_scale_is_free: false,
            table: None,
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

    /// Prepares a load-test table.
    ///
    /// # Errors
    /// With fewer than five points.
    pub fn of_table(table: &LoadTable, rated: &Rated<f64>) -> Result<Self, Unsupported> {
        let (points, measured, weight) = table::rows(table, rated)?;
        Ok(Self {
            inputs: Inputs::default(),
            between: Between::Held,
            timeline: Arc::new(Timeline::constant(rated.omega_sync)),
            speed: Vec::new(),
            speed_is_input: false,
            running_at: None,
            open: Vec::new(),
            decimation: 1,
            measured,
            weight,
            block: 1,
            supply: Supply::default(),
            input_noise: (0.0, 0.0),
            inverter: false,
            speed_scale_is_free: false,
            table: Some(points),
        })
    }

    /// Time between residual rows, s.
    pub fn t_row(&self) -> f64 {
        self.inputs.t_sample * (self.between.stride() * self.decimation) as f64
    }

    /// The measured speeds that drive a simulation of `plant`: with a free scale they are what the plant's speed sensor
    /// would have to see to show the channel.
    pub fn speeds(&self, plant: &Plant) -> Speeds<'_> {
        let gain = free_scale::gain_of(&plant.effects);
        if !self.speed_scale_is_free || gain == 1.0 {
            return Speeds {
                speed: Cow::Borrowed(&self.speed),
                running_at: self.running_at,
                timeline: self.timeline.clone(),
            };
        }
        let over = |x: &[f64]| x.iter().map(|x| x / gain).collect::<Vec<f64>>();
        Speeds {
            speed: Cow::Owned(over(&self.speed)),
            running_at: self.running_at.map(|x| x / gain),
            timeline: Arc::new(Timeline {
                theta_mech: over(&self.timeline.theta_mech),
                ..(*self.timeline).clone()
            }),
        }
    }

    /// The same with the scale of the speed as a plant has it, for everything that looks at the measured speed.
    pub fn as_seen_by(&self, plant: &Plant) -> Self {
        let mut case = self.clone();
        let speeds = self.speeds(plant);
        case.speed = speeds.speed.into_owned();
        (case.running_at, case.timeline) = (speeds.running_at, speeds.timeline);
        if self.speed_scale_is_free {
            let gain = free_scale::gain_of(&plant.effects);
            for (y, w) in case.measured.iter_mut().zip(&mut case.weight) {
                y[SPEED] /= gain;
                w[SPEED] *= gain;
            }
        }
        case
    }

    /// Rows of each block; a short rest joins the last block.
    pub fn blocks(&self) -> Vec<Range<usize>> {
        let n = self.measured.len() / self.block;
        let end = |k: usize| {
            if k + 1 == n {
                self.measured.len()
            } else {
                (k + 1) * self.block
            }
        };
        (0..n).map(|k| k * self.block..end(k)).collect()
    }

    /// Number of values that are judged.
    pub fn judged(&self) -> f64 {
        let one = |w: &[f64; N_CHANNELS]| w.iter().filter(|&&w| w > 0.0).count();
        self.weight.iter().map(one).sum::<usize>() as f64
    }

    fn fill_rows(
        &mut self,
        rec: &Recording,
        voltages: [&[f64]; 3],
        currents: [&[f64]; 3],
        sigma_u: f64,
    ) {
        let h = self.inputs.t_sample * self.between.stride() as f64;
        self.decimation = ((1.0 / ROW_RATE / h).round() as usize).max(1);
        self.block = ((BLOCK / self.t_row()) as usize).max(1);
        let sigma_i = [0, 1, 2].map(|k| sigma(rec, Channel::CURRENTS[k], currents[k]));
        let speed = rec.speed().filter(|_| !self.speed_is_input);
        let w_speed = speed.map_or(0.0, |x| 1.0 / sigma(rec, Channel::SPEED, x));
        let w_zero = 3f64.sqrt() / sigma_u;
        let stride = self.between.stride() * self.decimation;
        let last = (rec.len() - 1) / self.between.stride() * self.between.stride();
        let limits = [0, 1, 2].map(|k| clip_limit(rec, k, currents[k]));
        self.open = switched_off(currents, sigma_i, self.inputs.t_sample);
        let settles = (AFTER_SWITCH / self.inputs.t_sample) as usize;
        for k in (0..=last).step_by(stride) {
            let i = currents.map(|c| c[k]);
            let w_i = |p: usize| {
                let settled = self
                    .open
                    .iter()
                    .all(|off| k + 10 < off.start || k > off.start + settles);
                let judged = settled && i[p].abs() < limits[p];
                f64::from(u8::from(judged)) / sigma_i[p].hypot(RELATIVE_CURRENT * i[p])
            };
            let zero = (voltages[0][k] + voltages[1][k] + voltages[2][k]) / 3.0;
            let omega = speed.map_or(0.0, |x| x[k]);
            self.measured.push([i[0], i[1], i[2], omega, zero]);
            self.weight.push([w_i(0), w_i(1), w_i(2), w_speed, w_zero]);
        }
    }
}

/// Samples during which the motor is off its supply: the phases carried current, now they carry noise.
///
/// The voltage impulse that forces the current to zero falls between two samples: no model driven by the sampled
/// voltage can follow it. An arc or a snubber that still conducts is no open switch.
fn switched_off(currents: [&[f64]; 3], sigma: [f64; 3], t_sample: f64) -> Vec<Range<usize>> {
    let window = ((0.02 / t_sample) as usize).max(8);
    let n = currents[0].len();
    let running: Vec<Running> = (0..3)
        .map(|p| Running::new(currents[p], sigma[p]))
        .collect();
    let loudest = |of: &dyn Fn(&Running) -> f64| running.iter().map(of).fold(0.0, f64::max);
    let carried = |k: usize| loudest(&|r| r.power(k - window..k)) > CARRIES;
    let silent = |k: usize| loudest(&|r| r.variance(k..k + window)) < NOISE_ONLY;
    let back = |k: usize| loudest(&|r| r.variance(k..k + 4)) > CARRIES;
    let mut open = Vec::new();
    let mut k = window;
    while k + window < n {
        if silent(k) && carried(k) {
            let end = (k..n - 4).find(|&j| back(j)).unwrap_or(n);
            open.push(k..end);
            k = end;
        }
        k += 1;
    }
    open
}

/// Running sums of a current in units of its noise.
struct Running {
    sum: Vec<f64>,
    square: Vec<f64>,
}

impl Running {
    fn new(x: &[f64], sigma: f64) -> Self {
        let total = |f: &dyn Fn(f64) -> f64| {
            let mut sum = 0.0;
            let next = |x: &f64| {
                sum += f(x / sigma);
                sum
            };
            std::iter::once(0.0).chain(x.iter().map(next)).collect()
        };
        Self {
            sum: total(&|x| x),
            square: total(&|x| x * x),
        }
    }

    /// Mean square.
    fn power(&self, r: Range<usize>) -> f64 {
        (self.square[r.end] - self.square[r.start]) / r.len() as f64
    }

    /// Mean square about the mean: an offset carries no current.
    fn variance(&self, r: Range<usize>) -> f64 {
        let mean = (self.sum[r.end] - self.sum[r.start]) / r.len() as f64;
        self.power(r) - mean * mean
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

fn check_clock(rec: &Recording) -> Result<(), Unsupported> {
    let t_sample = rec.t_sample();
    let uneven = |pair: &[f64]| (pair[1] - pair[0] - t_sample).abs() > 0.01 * t_sample;
    match rec.t().windows(2).position(uneven) {
        None => Ok(()),
        Some(k) => Err(Unsupported::new(
            format!("the clock is not even at t = {} s", rec.t()[k]),
            "cut the recording at its gaps, or resample it",
        )),
    }
}

/// Declared noise of a channel, or an estimate, never zero.
fn sigma(rec: &Recording, channel: Channel, x: &[f64]) -> f64 {
    let declared = rec.metadata.sensors.sigma(channel);
    let sigma = declared.unwrap_or_else(|| estimated_sigma(x));
    let top = x.iter().fold(0.0f64, |a, b| a.max(b.abs()));
    sigma.max(1e-6 * top).max(1e-9)
}

fn vectors(abc: [&[f64]; 3]) -> Vec<Complex64> {
    (0..abc[0].len())
        .map(|k| clarke(abc.map(|x| x[k])))
        .collect()
}

/// Double steps while they stay below a quarter of a millisecond.
fn between(rec: &Recording, t_sample: f64) -> Between {
    if rec.metadata.voltage == VoltageKind::Hold || t_sample > 2.6e-4 {
        Between::Held
    } else {
        Between::Smooth
    }
}

struct Load {
    torque: Vec<f64>,
    noise: f64,
    unknown: bool,
}

impl Load {
    fn new(rec: &Recording) -> Self {
        let none = vec![0.0; rec.len()];
        match (rec.metadata.load_torque, rec.torque()) {
            (LoadTorque::Friction, _) => Self::known(none, 0.0),
            (_, Some(torque)) => Self::known(torque.to_vec(), sigma(rec, Channel::TORQUE, torque)),
            _ => Self {
                torque: none,
                noise: 0.0,
                unknown: rec.speed().is_some(),
            },
        }
    }

    fn known(torque: Vec<f64>, noise: f64) -> Self {
        Self {
            torque,
            noise,
            unknown: false,
        }
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

/// Speed smoothed over 10 ms, rad/s.
fn smoothed_speed(rec: &Recording, t_sample: f64) -> Vec<f64> {
    let Some(speed) = rec.speed() else {
        return Vec::new();
    };
    let x: Vec<_> = speed.iter().map(|&w| Complex64::new(w, 0.0)).collect();
    let smoothed = smooth(&x, (0.01 / t_sample) as usize);
    smoothed.value.iter().map(|x| x.re).collect()
}

/// Initial speed if the motor already runs.
fn running_at(rec: &Recording, currents: [&[f64]; 3], rated: &Rated<f64>) -> Option<f64> {
    let n = (0.02 / rec.t_sample()) as usize;
    let head = |x: &[f64]| x[..n.clamp(1, x.len())].iter().sum::<f64>() / n.max(1) as f64;
    let initial = rec.speed().map_or(rated.speed(), head);
    match rec.metadata.starts_from {
        StartsFrom::Standstill => None,
        StartsFrom::Running => Some(initial),
        StartsFrom::Unknown => {
            let quiet = (currents[0][0].abs()).max(currents[1][0].abs()) < 0.1 * rated.current;
            let still = rec
                .speed()
                .is_none_or(|_| initial.abs() < 0.05 * rated.speed());
            (!(quiet && still)).then_some(initial)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen::{self, SIGMA, T_SAMPLE};
    use recording::Metadata;

    fn rated() -> Rated<f64> {
        specimen::belief("").plant.rated
    }

    fn case_of(rec: &Recording) -> Case {
        Case::new(rec, &rated()).expect("judged")
    }

    fn reason(rec: &Recording) -> String {
        Case::new(rec, &rated()).expect_err("refused").reason
    }

    /// The same recording with its channels changed, or without them.
    fn changed(
        rec: &Recording,
        change: impl Fn(Channel, Vec<f64>) -> Option<Vec<f64>>,
    ) -> Recording {
        let empty = Recording::new("changed", rec.t().to_vec(), rec.metadata.clone());
        rec.channels()
            .fold(empty.expect("a clock"), |to, (channel, x)| {
                match change(channel, x.to_vec()) {
                    Some(x) => to.with_channel(channel, x).expect("as long"),
                    None => to,
                }
            })
    }

    #[test]
    fn rows_hold_every_second_sample_and_weigh_it_by_its_noise() {
        let rec = specimen::recording(1.0, |_| 1.0);
        let case = case_of(&rec);
        assert_eq!((case.between, case.decimation), (Between::Smooth, 1));
        assert!((case.t_row() - 2.0 * T_SAMPLE).abs() < 1e-12);
        assert_eq!(case.measured.len(), 2500);
        let [volt, ampere, speed, _] = SIGMA;
        let (i, omega) = (rec.currents().expect("three"), rec.speed().expect("one"));
        for row in [0, 1, 777, 2499] {
            let k = 2 * row;
            for (p, phase) in i.iter().enumerate() {
                assert_eq!(case.measured[row][p], phase[k]);
                let sigma = (ampere * ampere + (0.005 * phase[k]).powi(2)).sqrt();
                assert!((case.weight[row][p] * sigma - 1.0).abs() < 1e-12);
            }
            assert_eq!(case.measured[row][3], omega[k]);
            assert!((case.weight[row][3] * speed - 1.0).abs() < 1e-12);
            // The mean of three phases has a third of the variance of one.
            assert!(case.measured[row][4].abs() < 1e-9);
            assert!((case.weight[row][4] * volt / 3f64.sqrt() - 1.0).abs() < 1e-12);
        }
        assert_eq!(case.judged(), 5.0 * 2500.0);
        assert!((case.input_noise.0 - (2.0f64 / 3.0).sqrt() * volt).abs() < 1e-12);
        assert!((case.input_noise.1 - SIGMA[3]).abs() < 1e-12);
        assert!(!case.inverter && case.open.is_empty() && !case.speed_is_input);
    }

    #[test]
    fn blocks_of_forty_milliseconds_cover_every_row_once() {
        let case = case_of(&specimen::recording(1.03, |_| 1.0));
        let blocks = case.blocks();
        assert_eq!(blocks[0].start, 0);
        assert!(blocks.windows(2).all(|w| w[0].end == w[1].start));
        assert_eq!(blocks.last().map(|b| b.end), Some(case.measured.len()));
        for block in &blocks[..blocks.len() - 1] {
            let seconds = block.len() as f64 * case.t_row();
            assert!((seconds - BLOCK).abs() < 1.01 * case.t_row(), "{seconds}");
        }
        let last = blocks[blocks.len() - 1].len();
        assert!(
            last >= blocks[0].len() && last < 2 * blocks[0].len(),
            "the rest joins the last"
        );
    }

    #[test]
    fn fast_samples_are_thinned_out() {
        let mut rec = specimen::recording(1.0, |_| 1.0);
        // The same columns read as a clock of 20 kHz.
        let t = (0..rec.len()).map(|k| 5e-5 * k as f64).collect();
        let fast = Recording::new("fast", t, rec.metadata.clone()).expect("a clock");
        rec = rec.channels().fold(fast, |to, (c, x)| {
            to.with_channel(c, x.to_vec()).expect("as long")
        });
        let case = case_of(&rec);
        // 10 kHz of double steps to about 5.5 kHz.
        assert_eq!(case.decimation, 2);
        assert!((case.t_row() - 2e-4).abs() < 1e-12);
    }

    #[test]
    fn what_cannot_be_judged_is_told_with_a_remedy() {
        let rec = specimen::recording(1.0, |_| 1.0);
        let without = |channel| changed(&rec, |c, x| (c != channel).then_some(x));
        assert!(reason(&without(Channel::VOLTAGES[1])).contains("voltages"));
        assert!(reason(&without(Channel::CURRENTS[0])).contains("currents"));
        assert!(reason(&specimen::recording(0.19, |_| 1.0)).contains("shorter"));
        assert!(Case::new(&specimen::recording(0.21, |_| 1.0), &rated()).is_ok());
        let mut t = rec.t().to_vec();
        t[100..].iter_mut().for_each(|t| *t += 0.02 * T_SAMPLE);
        let torn = Recording::new("torn", t, rec.metadata.clone()).expect("rising");
        assert!(
            check_clock(&torn)
                .expect_err("uneven")
                .reason
                .contains("t = 0.0198")
        );
        assert_eq!(check_clock(&rec), Ok(()));
    }

    /// Declared noise; without a declaration what the samples show; never nothing.
    #[test]
    fn noise_is_declared_or_estimated_and_never_zero() {
        let rec = specimen::recording(0.3, |_| 1.0);
        let current = rec.currents().expect("three")[0];
        assert_eq!(sigma(&rec, Channel::CURRENTS[0], current), 0.005);
        let bare = Recording::new("bare", rec.t().to_vec(), Metadata::default()).expect("a clock");
        let noisy: Vec<f64> = (0..1000).map(|k| f64::from(k * k % 1009)).collect();
        assert_eq!(
            sigma(&bare, Channel::SPEED, &noisy),
            estimated_sigma(&noisy)
        );
        assert_eq!(sigma(&bare, Channel::SPEED, &[3.0; 100]), 3e-6);
        assert_eq!(sigma(&bare, Channel::SPEED, &[0.0; 100]), 1e-9);
    }

    #[test]
    fn a_current_at_its_full_scale_is_not_judged() {
        let rec = specimen::recording(0.3, |_| 1.0);
        let clipped = changed(&rec, |c, x| {
            Some(if c == Channel::CURRENTS[1] {
                x.iter().map(|x| if *x > 1.0 { 5.0 } else { *x }).collect()
            } else {
                x
            })
        });
        let case = case_of(&clipped);
        for (measured, weight) in case.measured.iter().zip(&case.weight) {
            assert_eq!(weight[1] == 0.0, measured[1] == 5.0);
            assert!(weight[0] > 0.0);
        }
    }

    /// Without a declared full scale a top that stands still is a clipped one.
    #[test]
    fn a_flat_top_is_the_end_of_the_scale() {
        let bare = Recording::new("bare", vec![0.0, 1.0], Metadata::default()).expect("a clock");
        let wave = |limit: f64| -> Vec<f64> {
            (0..1000)
                .map(|k| (0.05 * f64::from(k)).sin().clamp(-limit, limit))
                .collect()
        };
        assert_eq!(clip_limit(&bare, 0, &wave(2.0)), f64::INFINITY);
        assert!((clip_limit(&bare, 0, &wave(0.8)) - 0.99 * 0.8).abs() < 1e-12);
        // A level that is held below the top is no clipping.
        let mut held = wave(2.0);
        held[300..320].fill(0.5);
        assert_eq!(clip_limit(&bare, 0, &held), f64::INFINITY);
    }

    #[test]
    fn running_sums_give_power_and_variance_of_any_range() {
        let x = [1.0, -3.0, 2.0, 4.0, 7.0];
        let running = Running::new(&x, 2.0);
        // In units of the noise: -1.5, 1, 2.
        let (power, mean) = ((2.25 + 1.0 + 4.0) / 3.0, 0.5);
        assert!((running.power(1..4) - power).abs() < 1e-12);
        assert!((running.variance(1..4) - (power - mean * mean)).abs() < 1e-12);
    }

    /// A motor that is switched off at 0.5 s and on again at 0.8 s.
    #[test]
    fn an_open_switch_is_found_and_its_moments_are_not_judged() {
        let rec = specimen::recording(1.2, |_| 1.0);
        let off = |k: usize| (2500..4000).contains(&k);
        let noise = |k: usize| 0.005 * ((k * 7_919 % 1000) as f64 / 500.0 - 1.0);
        let rec = changed(&rec, |c, x| {
            let current = Channel::CURRENTS.contains(&c);
            let at = |(k, x): (usize, &f64)| if current && off(k) { noise(k) } else { *x };
            Some(x.iter().enumerate().map(at).collect())
        });
        let case = case_of(&rec);
        assert_eq!(case.open.len(), 1, "{:?}", case.open);
        let open = case.open[0].clone();
        assert!(
            open.start.abs_diff(2500) <= 2 && open.end.abs_diff(4000) <= 4,
            "{open:?}"
        );
        let judged = |k: usize| case.weight[k / 2][0] > 0.0;
        // Just before the switch opens, and 30 ms after, nothing can be said about the current.
        assert!(judged(open.start - 14) && !judged(open.start - 8));
        assert!(!judged(open.start + 148) && judged(open.start + 154));
        // Speed and voltage are judged all the time.
        assert!(case.weight.iter().all(|w| w[3] > 0.0 && w[4] > 0.0));
    }

    #[test]
    fn a_motor_that_never_carried_current_is_not_switched_off() {
        let quiet: Vec<f64> = (0..2000)
            .map(|k| 0.005 * ((k * 7_919 % 1000) as f64 / 500.0 - 1.0))
            .collect();
        let all = [&quiet[..]; 3];
        assert!(switched_off(all, [0.005; 3], T_SAMPLE).is_empty());
    }

    #[test]
    fn held_or_slow_voltages_are_not_interpolated() {
        let mut rec = specimen::recording(0.3, |_| 1.0);
        assert_eq!(between(&rec, 2.5e-4), Between::Smooth);
        assert_eq!(between(&rec, 2.7e-4), Between::Held);
        rec.metadata.voltage = VoltageKind::Hold;
        assert_eq!(between(&rec, 1e-4), Between::Held);
    }

    #[test]
    fn the_load_is_what_is_declared_or_measured() {
        let rec = specimen::recording(0.3, |_| 1.0);
        let load = Load::new(&rec);
        assert!(!load.unknown && load.torque.iter().all(|x| *x == 1.0));
        assert!((load.noise - SIGMA[3]).abs() < 1e-12);
        let mut friction = rec.clone();
        friction.metadata.load_torque = LoadTorque::Friction;
        let load = Load::new(&friction);
        assert!(!load.unknown && load.noise == 0.0 && load.torque.iter().all(|x| *x == 0.0));
        let free = changed(&rec, |c, x| (c != Channel::TORQUE).then_some(x));
        assert!(
            Load::new(&free).unknown,
            "the measured speed takes the place of the load"
        );
        let nothing = changed(&free, |c, x| (c != Channel::SPEED).then_some(x));
        assert!(!Load::new(&nothing).unknown);
    }

    #[test]
    fn a_free_load_makes_the_speed_an_input() {
        let rec = specimen::recording(0.5, |_| 1.0);
        let free = changed(&rec, |c, x| (c != Channel::TORQUE).then_some(x));
        let case = case_of(&free);
        assert!(case.speed_is_input);
        assert!(
            case.weight.iter().all(|w| w[3] == 0.0),
            "an input is not judged"
        );
    }

    #[test]
    fn angle_and_smoothed_speed_follow_the_measured_speed() {
        let rec = specimen::recording(0.5, |_| 1.0);
        let ramp: Vec<f64> = rec.t().iter().map(|t| 100.0 + 40.0 * t).collect();
        let rec = changed(&rec, |c, x| {
            Some(if c == Channel::SPEED { ramp.clone() } else { x })
        });
        let theta = measured_angle(&rec);
        let speed = smoothed_speed(&rec, T_SAMPLE);
        for (k, t) in rec.t().iter().enumerate() {
            // Trapezoids of a straight line are exact.
            assert!((theta[k] - (100.0 * t + 20.0 * t * t)).abs() < 1e-9);
            assert!((speed[k] - (100.0 + 40.0 * t)).abs() < 1e-9);
        }
        let without = changed(&rec, |c, x| (c != Channel::SPEED).then_some(x));
        assert!(
            measured_angle(&without).is_empty() && smoothed_speed(&without, T_SAMPLE).is_empty()
        );
    }

    #[test]
    fn a_motor_runs_at_the_start_if_it_is_declared_or_seen() {
        let rated = rated();
        let omega = specimen::point(1.0).omega_mech;
        let at = |starts_from, scale: f64, speed: bool| {
            let mut rec = changed(&specimen::recording(0.3, |_| 1.0), |c, x| {
                let gain = if c == Channel::TORQUE { 1.0 } else { scale };
                (speed || c != Channel::SPEED).then(|| x.iter().map(|x| gain * x).collect())
            });
            rec.metadata.starts_from = starts_from;
            let currents = rec.currents().expect("three");
            running_at(&rec, currents, &rated)
        };
        assert_eq!(at(StartsFrom::Standstill, 1.0, true), None);
        let close = |got: Option<f64>, expected: f64| {
            assert!(
                (got.expect("running") - expected).abs() < 1e-9,
                "{got:?} {expected}"
            );
        };
        close(at(StartsFrom::Running, 1.0, true), omega);
        close(at(StartsFrom::Unknown, 1.0, true), omega);
        assert_eq!(
            at(StartsFrom::Unknown, 0.01, true),
            None,
            "neither current nor speed"
        );
        close(at(StartsFrom::Running, 1.0, false), rated.speed());
    }

    #[test]
    fn a_table_is_a_case_of_points() {
        use recording::TableColumn::{Current, Speed, Torque};
        let columns = [
            (Torque, vec![0.0, 0.5, 1.0, 1.5, 1.7]),
            (Current, vec![0.8, 0.9, 1.0, 1.2, 1.3]),
            (Speed, vec![1795.0, 1770.0, 1740.0, 1700.0, 1680.0]),
        ];
        let table = LoadTable::new("table", columns.into_iter().collect()).expect("valid");
        let case = Case::of_table(&table, &rated()).expect("five points");
        assert_eq!(case.table.as_ref().map(Vec::len), Some(5));
        assert_eq!((case.blocks().len(), case.judged()), (5, 10.0));
    }
}
