//! The instruments: faults, noise, resolution and limits between the truth and the sample.

use super::chain::Chain;
use crate::chain::CHANNELS;
use crate::simulate::{Measured, Truth};
use crate::{Change, DqSignal, Fault, Probe, Scenario, SensorSpec, SpeedSensor, Target};
use motor::dynamic::{clarke, phases};
use num_complex::Complex64;
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// An encoder's speed is its counts over this time, s.
const ENCODER_WINDOW_S: f64 = 0.01;
const COUNTS_PER_PULSE: f64 = 4.0;

#[derive(Debug)]
pub(in crate::simulate) struct Instruments {
    spec: SensorSpec,
    t_sample: f64,
    random: Pcg64,
    last_theta: Option<f64>,
    encoder_angle: f64,
    counts: VecDeque<i64>,
    chain: Option<Chain>,
}

/// One analogue channel; corrected value = (raw - offset) * gain.
struct Channel {
    full_scale: f64,
    bits: u32,
    /// One code, V or A.
    step: f64,
    gain: f64,
    offset: f64,
}

impl Channel {
    fn new(full_scale: f64, bits: u32, gain: f64, offset: f64) -> Channel {
        Channel {
            full_scale,
            bits,
            step: 2.0 * full_scale / f64::from(1_u32 << bits),
            gain,
            offset,
        }
    }

    /// The ADC code of a raw value: 0 V or 0 A is the middle code.
    fn code(&self, raw: f64) -> u16 {
        let middle = f64::from(1_u32 << (self.bits - 1));
        let largest = f64::from((1_u32 << self.bits) - 1);
        let code = (raw / self.step + middle).clamp(0.0, largest);
        // Rounded, and within the codes of at most 16 bits.
        (code + 0.5) as u16
    }

    /// As the core sees it: within a code of either end.
    fn is_at_rail(&self, code: u16) -> bool {
        u32::from(code) <= 1 || u32::from(code) + 2 >= 1_u32 << self.bits
    }

    fn raw_of(&self, code: u16) -> f64 {
        let middle = f64::from(1_u32 << (self.bits - 1));
        (f64::from(code) - middle) * self.step
    }
}

/// What one channel shows: value, code, and whether any conversion of it was at a rail.
#[derive(Clone, Copy, Default)]
struct Shown {
    value: f64,
    code: u16,
    clipped: bool,
}

impl Shown {
    /// Adds a conversion. The scenario's reader sees to it that the codes of all fit into 16 bits.
    fn add(&mut self, one: Shown) {
        self.value += one.value;
        self.code = self.code.saturating_add(one.code);
        self.clipped |= one.clipped;
    }

    /// The mean of so many conversions; the codes stay a sum.
    fn of(self, number: f64) -> Shown {
        Shown {
            value: self.value / number,
            ..self
        }
    }
}

/// Values at the pins ahead of the motor file's correction.
fn uncorrected(x: [f64; CHANNELS], channels: &[Channel; CHANNELS]) -> [f64; CHANNELS] {
    std::array::from_fn(|k| x[k] / channels[k].gain + channels[k].offset)
}

impl Instruments {
    pub(in crate::simulate) fn new(scenario: &Scenario) -> Instruments {
        let chain = scenario.sensors.chain.as_ref();
        Instruments {
            spec: scenario.sensors.clone(),
            t_sample: scenario.t_sample(),
            random: Pcg64::seed_from_u64(scenario.seed),
            last_theta: None,
            encoder_angle: 0.0,
            counts: VecDeque::new(),
            chain: chain.map(|chain| Chain::new(chain, scenario.seed, scenario.t_sample())),
        }
    }

    /// Shows a signal chain what is so at `t`, s, between samples; nothing else looks.
    pub(in crate::simulate) fn observe(&mut self, t: f64, truth: &Truth, faults: &[Fault]) {
        if let Some(chain) = &mut self.chain {
            chain.observe(t, sensed(truth, &active(faults, t)));
        }
    }

    pub(in crate::simulate) fn read(
        &mut self,
        t: f64,
        truth: &Truth,
        faults: &[Fault],
    ) -> Measured {
        let active = active(faults, t);
        let channels: [Channel; CHANNELS] = std::array::from_fn(|k| self.channel(k));
        let shown = self.sample(t, sensed(truth, &active), &channels);
        let [a, b, c, d, e, f] = shown;
        let (u, i) = ([a, b, c], [d, e, f]);
        let count = self.count(truth, &active);
        Measured {
            u_s_abc: u.map(|one| one.value),
            i_s_abc: i.map(|one| one.value),
            omega_mech: self.speed(truth, count, &active),
            tau_load: self.plain(truth.tau_load, self.spec.instrument.torque_full_scale_nm),
            voltage_codes: u.map(|one| one.code),
            current_codes: i.map(|one| one.code),
            clipped: shown.map(|one| one.clipped),
            // The hardware counter has 16 bits and wraps.
            encoder_count: count as u16,
        }
    }

    /// Channel `k`: voltages a, b, c, then currents a, b, c.
    fn channel(&self, k: usize) -> Channel {
        let own = &self.spec.instrument;
        let phase = k % 3;
        let (full_scale, gain, offset) = match k < 3 {
            true => (
                own.voltage_full_scale_volt,
                own.voltage_gain[phase],
                own.voltage_offset_volt[phase],
            ),
            false => (
                own.current_full_scale_amp,
                own.current_gain[phase],
                own.current_offset_amp[phase],
            ),
        };
        Channel::new(full_scale, own.adc_bits, gain, offset)
    }

    /// All channels of a sample: one conversion, or the mean of those that the chain asks for.
    fn sample(
        &mut self,
        t: f64,
        sensed: [f64; CHANNELS],
        channels: &[Channel; CHANNELS],
    ) -> [Shown; CHANNELS] {
        let Some(chain) = &mut self.chain else {
            let raw = uncorrected(sensed, channels);
            return std::array::from_fn(|k| self.convert(&channels[k], raw[k]));
        };
        chain.observe(t, sensed);
        let times = chain.conversions(t);
        let (mut sums, mut number) = ([Shown::default(); CHANNELS], 0.0);
        for t in times {
            let raw = self.raw(t, channels);
            for (k, sum) in sums.iter_mut().enumerate() {
                sum.add(self.convert(&channels[k], raw[k]));
            }
            number += 1.0;
        }
        sums.map(|sum| sum.of(number))
    }

    /// What reaches the converter's pins at `t`, s, before the motor file's correction.
    fn raw(&mut self, t: f64, channels: &[Channel; CHANNELS]) -> [f64; CHANNELS] {
        let full_scales = std::array::from_fn(|k| channels[k].full_scale);
        match &mut self.chain {
            Some(chain) => {
                let pins = uncorrected(chain.filtered(t), channels);
                chain.distorted(t, pins, full_scales)
            }
            None => [0.0; CHANNELS],
        }
    }

    /// The calibrated value and the code of what reaches the pin.
    fn convert(&mut self, channel: &Channel, raw: f64) -> Shown {
        let raw = raw + self.noise(channel.full_scale);
        let bent = match &self.chain {
            Some(chain) => raw + chain.inl_lsb(raw / channel.full_scale) * channel.step,
            None => raw,
        };
        self.shown(channel, bent)
    }

    /// The calibrated value and the code.
    fn shown(&self, channel: &Channel, raw: f64) -> Shown {
        let code = channel.code(raw);
        let shown = if self.spec.quantise {
            channel.raw_of(code)
        } else {
            raw
        };
        Shown {
            value: (shown - channel.offset) * channel.gain,
            code,
            clipped: channel.is_at_rail(code),
        }
    }

    /// A channel without calibration, such as the tachometer.
    fn plain(&mut self, x: f64, full_scale: f64) -> f64 {
        let channel = Channel::new(full_scale, self.spec.instrument.adc_bits, 1.0, 0.0);
        let raw = x + self.noise(full_scale);
        self.shown(&channel, raw).value
    }

    fn noise(&mut self, full_scale: f64) -> f64 {
        let sigma = self.spec.instrument.noise_sigma_fraction_of_full_scale * full_scale;
        if sigma == 0.0 {
            return 0.0;
        }
        let normal: f64 = self.random.sample(StandardNormal);
        sigma * normal
    }

    /// Counts of the encoder since the beginning, four per pulse.
    fn count(&mut self, truth: &Truth, active: &[&Fault]) -> i64 {
        let turned = truth.theta_mech - self.last_theta.unwrap_or(truth.theta_mech);
        self.last_theta = Some(truth.theta_mech);
        let speed = probed(turned / self.t_sample, Probe::Speed, active);
        self.encoder_angle += speed * self.t_sample;
        // Far inside 64 bits: a day at 60000 rpm and a million pulses is 3e14 counts.
        (self.encoder_angle * self.counts_per_radian()).floor() as i64
    }

    fn speed(&mut self, truth: &Truth, count: i64, active: &[&Fault]) -> f64 {
        let omega = probed(truth.omega_mech, Probe::Speed, active);
        match self.spec.speed {
            SpeedSensor::None => 0.0,
            SpeedSensor::Encoder => self.encoder_speed(count, omega),
            SpeedSensor::Tachometer => {
                self.plain(omega, self.spec.instrument.speed_full_scale_rad_s)
            }
        }
    }

    /// Counts of the window in a second; before the first sample the encoder turned as it does there, `omega`, rad/s.
    fn encoder_speed(&mut self, count: i64, omega: f64) -> f64 {
        let window = (ENCODER_WINDOW_S / self.t_sample).round().max(1.0);
        if self.counts.is_empty() {
            let per_sample = self.counts_per_radian() * omega * self.t_sample;
            let before = |k: i32| count - (f64::from(k) * per_sample).round() as i64;
            self.counts.extend((1..=window as i32).rev().map(before));
        }
        self.counts.push_back(count);
        if self.counts.len() > window as usize + 1 {
            self.counts.pop_front();
        }
        let counts = (count - self.counts[0]) as f64;
        counts / self.counts_per_radian() / (window * self.t_sample)
    }

    fn counts_per_radian(&self) -> f64 {
        let pulses = f64::from(self.spec.instrument.encoder_pulses_per_revolution);
        COUNTS_PER_PULSE * pulses / TAU
    }
}

fn active(faults: &[Fault], t: f64) -> Vec<&Fault> {
    faults.iter().filter(|fault| fault.is_active(t)).collect()
}

/// Voltages and currents behind the faults of their signals and sensors.
fn sensed(truth: &Truth, active: &[&Fault]) -> [f64; CHANNELS] {
    let (u, i) = transformed(truth, active);
    std::array::from_fn(|k| match k {
        0..3 => probed(u[k], Probe::Voltage(k), active),
        _ => probed(i[k - 3], Probe::Current(k - 3), active),
    })
}

/// Phase voltages and currents behind the faults of d-q signals.
fn transformed(truth: &Truth, active: &[&Fault]) -> ([f64; 3], [f64; 3]) {
    let (mut u, mut i) = (truth.u_s_abc, truth.i_s_abc);
    for fault in active {
        let Target::Dq(signal, frame) = fault.target else {
            continue;
        };
        let theta = truth.theta(frame);
        match signal {
            DqSignal::Vd | DqSignal::Vq => u = in_frame(u, theta, signal, fault),
            DqSignal::Id | DqSignal::Iq => i = in_frame(i, theta, signal, fault),
        }
    }
    (u, i)
}

fn in_frame(abc: [f64; 3], theta: f64, signal: DqSignal, fault: &Fault) -> [f64; 3] {
    let turn = Complex64::from_polar(1.0, theta);
    let mut dq = clarke(abc) * turn.conj();
    match signal {
        DqSignal::Id | DqSignal::Vd => dq.re = fault.apply(dq.re),
        DqSignal::Iq | DqSignal::Vq => dq.im = fault.apply(dq.im),
    }
    phases(dq * turn)
}

/// A value behind the faults of its own sensor; a dead one shows its zero.
fn probed(x: f64, probe: Probe, active: &[&Fault]) -> f64 {
    active
        .iter()
        .filter(|fault| fault.target == Target::Probe(probe))
        .fold(x, |x, fault| match fault.change {
            Change::Factor(factor) => x * factor,
            Change::Offset(offset) => x + offset,
        })
}
