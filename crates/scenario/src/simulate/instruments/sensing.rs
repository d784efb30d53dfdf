//! The instruments: faults, noise, resolution and limits between the truth and the sample.

use super::chain::{Chain, Range};
use crate::chain::CHANNELS;
use crate::simulate::{Measured, Truth};
use crate::{Change, DqSignal, Fault, Probe, Scenario, SensorSpec, SpeedSensor, Target};
use motor::dynamic::{clarke, phases};
use motor::motor_file::Sensors;
use num_complex::Complex64;
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// An encoder's speed is its counts over this time, s.
const ENCODER_WINDOW_S: f64 = 0.01;
const COUNTS_PER_PULSE: f64 = 4.0;

#[derive(Clone, Debug)]
pub(in crate::simulate) struct Instruments {
    spec: SensorSpec,
    t_sample: f64,
    /// Voltages a, b, c, then currents a, b, c.
    channels: [Channel; CHANNELS],
    tachometer: Channel,
    torque_meter: Channel,
    random: Pcg64,
    last_theta: Option<f64>,
    encoder_angle: f64,
    counts: VecDeque<i64>,
    chain: Option<Chain>,
}

/// One analogue channel; corrected value = (raw - offset) * gain.
#[derive(Clone, Copy, Debug)]
struct Channel {
    full_scale: f64,
    /// One code, V or A, and its inverse: a sample may have a hundred conversions, and a division takes the longest.
    step: f64,
    per_step: f64,
    middle: f64,
    largest: u32,
    /// Standard deviation, V or A.
    noise: f64,
    gain: f64,
    offset: f64,
}

impl Channel {
    fn new(own: &Sensors, full_scale: f64, gain: f64, offset: f64) -> Channel {
        let codes = 1_u32 << own.adc_bits;
        let step = 2.0 * full_scale / f64::from(codes);
        Channel {
            full_scale,
            per_step: 1.0 / step,
            step,
            middle: f64::from(codes / 2),
            largest: codes - 1,
            noise: own.noise_sigma_fraction_of_full_scale * full_scale,
            gain,
            offset,
        }
    }

    /// A channel without calibration, such as the tachometer.
    fn plain(own: &Sensors, full_scale: f64) -> Channel {
        Channel::new(own, full_scale, 1.0, 0.0)
    }

    /// Channel `k`: voltages a, b, c, then currents a, b, c.
    fn of(own: &Sensors, k: usize) -> Channel {
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
        Channel::new(own, full_scale, gain, offset)
    }

    fn range(&self) -> Range {
        Range {
            full_scale: self.full_scale,
            step: self.step,
        }
    }

    /// The ADC code of a raw value: 0 V or 0 A is the middle code.
    fn code(&self, raw: f64) -> u16 {
        let code = (raw * self.per_step + self.middle).clamp(0.0, f64::from(self.largest));
        // Rounded, and within the codes of at most 16 bits.
        (code + 0.5) as u16
    }

    /// As the core sees it: within a code of either end.
    fn is_at_rail(&self, code: u16) -> bool {
        u32::from(code) <= 1 || u32::from(code) + 1 >= self.largest
    }

    /// The calibrated value: of a code, or of what there is where nothing is rounded.
    fn value(&self, raw: f64, code: u16, quantise: bool) -> f64 {
        let shown = match quantise {
            true => (f64::from(code) - self.middle) * self.step,
            false => raw,
        };
        (shown - self.offset) * self.gain
    }
}

/// What the channels show: values, codes, and whether any conversion was at a rail.
#[derive(Clone, Copy, Default)]
struct Shown {
    values: [f64; CHANNELS],
    codes: [u16; CHANNELS],
    clipped: [bool; CHANNELS],
}

impl Shown {
    /// What a conversion of each channel shows of what reaches its pin.
    fn new(raw: &[f64; CHANNELS], channels: &[Channel; CHANNELS], quantise: bool) -> Shown {
        let codes = std::array::from_fn(|k| channels[k].code(raw[k]));
        Shown {
            values: std::array::from_fn(|k| channels[k].value(raw[k], codes[k], quantise)),
            clipped: std::array::from_fn(|k| channels[k].is_at_rail(codes[k])),
            codes,
        }
    }

    /// Adds a conversion. The scenario's reader sees to it that the codes of all fit into 16 bits.
    fn add(&mut self, one: &Shown) {
        for k in 0..CHANNELS {
            self.values[k] += one.values[k];
            self.codes[k] = self.codes[k].saturating_add(one.codes[k]);
            self.clipped[k] |= one.clipped[k];
        }
    }

    /// The mean of so many conversions; the codes stay a sum.
    fn of(self, number: f64) -> Shown {
        Shown {
            values: self.values.map(|value| value / number),
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
        let own = &scenario.sensors.instrument;
        let channels = std::array::from_fn(|k| Channel::of(own, k));
        let ranges = channels.map(|channel: Channel| channel.range());
        let (seed, t_sample) = (scenario.seed, scenario.t_sample());
        Instruments {
            channels,
            tachometer: Channel::plain(own, own.speed_full_scale_rad_s),
            torque_meter: Channel::plain(own, own.torque_full_scale_nm),
            spec: scenario.sensors.clone(),
            t_sample,
            random: Pcg64::seed_from_u64(seed),
            last_theta: None,
            encoder_angle: 0.0,
            counts: VecDeque::new(),
            chain: chain.map(|chain| Chain::new(chain, seed, t_sample, ranges)),
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
        let shown = self.sample(t, sensed(truth, &active));
        let (u_s_abc, i_s_abc) = halves(shown.values);
        let (voltage_codes, current_codes) = halves(shown.codes);
        let count = self.count(truth, &active);
        Measured {
            u_s_abc,
            i_s_abc,
            omega_mech: self.speed(truth, count, &active),
            tau_load: self.plain(self.torque_meter, truth.tau_load),
            voltage_codes,
            current_codes,
            clipped: shown.clipped,
            // The hardware counter has 16 bits and wraps.
            encoder_count: count as u16,
        }
    }

    /// A sample: one conversion of each channel, or the mean of those that the chain asks for.
    fn sample(&mut self, t: f64, sensed: [f64; CHANNELS]) -> Shown {
        let (channels, quantise) = (&self.channels, self.spec.quantise);
        let Some(chain) = &mut self.chain else {
            let mut raw = uncorrected(sensed, channels);
            add_noise(&mut raw, channels, &mut self.random);
            return Shown::new(&raw, channels, quantise);
        };
        chain.observe(t, sensed);
        let (mut sum, mut number) = (Shown::default(), 0.0);
        for conversion in chain.conversions(t) {
            let pins = uncorrected(chain.filtered(conversion), channels);
            let mut raw = chain.distorted(conversion, pins);
            add_noise(&mut raw, channels, &mut self.random);
            chain.bend(&mut raw);
            sum.add(&Shown::new(&raw, channels, quantise));
            number += 1.0;
        }
        sum.of(number)
    }

    /// What an instrument of its own shows, such as the tachometer.
    fn plain(&mut self, channel: Channel, x: f64) -> f64 {
        let raw = x + noise(&channel, &mut self.random);
        channel.value(raw, channel.code(raw), self.spec.quantise)
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
            SpeedSensor::Tachometer => self.plain(self.tachometer, omega),
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

fn noise(channel: &Channel, random: &mut Pcg64) -> f64 {
    if channel.noise == 0.0 {
        return 0.0;
    }
    let normal: f64 = random.sample(StandardNormal);
    channel.noise * normal
}

fn add_noise(raw: &mut [f64; CHANNELS], channels: &[Channel; CHANNELS], random: &mut Pcg64) {
    for (raw, channel) in raw.iter_mut().zip(channels) {
        *raw += noise(channel, random);
    }
}

/// Voltages, and currents.
fn halves<T: Copy>([a, b, c, d, e, f]: [T; CHANNELS]) -> ([T; 3], [T; 3]) {
    ([a, b, c], [d, e, f])
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
