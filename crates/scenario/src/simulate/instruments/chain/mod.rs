//! A signal chain at work: each channel's filter and delay, and the converter behind them.

mod converter;
mod line;

use crate::chain::{CHANNELS, ChannelChain, SignalChain};
use converter::Linearity;
use line::Line;
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, TAU};

/// A channel's range.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range {
    /// V, A.
    pub(super) full_scale: f64,
    /// One code, V, A.
    pub(super) step: f64,
}

/// What turns a value at the pin into a share of full scale, and back: the inverses once, not at every conversion.
#[derive(Clone, Copy, Debug)]
struct Scale {
    full: f64,
    per_full: f64,
    step: f64,
    factor: f64,
    offset: f64,
}

impl Scale {
    fn new(channel: &ChannelChain, range: Range) -> Scale {
        let per_full = range.full_scale.recip();
        Scale {
            full: range.full_scale,
            per_full,
            step: range.step,
            factor: (1.0 + channel.gain_error) * per_full,
            offset: channel.offset * per_full,
        }
    }
}

/// One of the conversions of a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Conversion {
    /// When it is taken, s.
    t: f64,
    /// How far the carrier is then: of length 1, or nought without a carrier.
    carrier: Complex64,
}

#[derive(Clone, Debug)]
pub(super) struct Chain {
    spec: SignalChain,
    lines: [Line; CHANNELS],
    /// The carrier's ripple behind each channel's filter and delay: a phasor at t = 0.
    ripples: [Complex64; CHANNELS],
    /// How far the carrier turns from one conversion to the next.
    turn: Complex64,
    linearity: Linearity,
    scales: [Scale; CHANNELS],
    /// From one conversion of a channel to the next, s.
    apart_s: f64,
    last_t: Option<f64>,
    /// What the converter took last, as a share of full scale.
    last_share: f64,
}

impl Chain {
    /// `t_sample` is the time, s, over which the conversions of a sample lie.
    pub(super) fn new(
        spec: &SignalChain,
        seed: u64,
        t_sample: f64,
        ranges: [Range; CHANNELS],
    ) -> Chain {
        let apart = t_sample / f64::from(spec.conversions.max(1));
        let span = t_sample - apart;
        Chain {
            apart_s: apart,
            lines: spec.channels.map(|channel| Line::new(channel, span)),
            ripples: std::array::from_fn(|k| ripple(spec, k)),
            turn: Complex64::cis(TAU * spec.carrier.frequency_hz * apart),
            linearity: Linearity::new(&spec.inl, seed),
            scales: std::array::from_fn(|k| Scale::new(&spec.channels[k], ranges[k])),
            spec: spec.clone(),
            last_t: None,
            last_share: 0.0,
        }
    }

    /// The conversions of the sample at `t`, s, the last of them.
    pub(super) fn conversions(&self, t: f64) -> impl Iterator<Item = Conversion> + use<> {
        let (apart, turn) = (self.apart_s, self.turn);
        let number = self.spec.conversions.max(1);
        let mut carrier = self.carrier_at(t - f64::from(number - 1) * apart);
        (0..number).rev().map(move |k| {
            let now = Conversion {
                t: t - f64::from(k) * apart,
                carrier,
            };
            // A sine for each of them would take a tenth of the whole simulation.
            carrier *= turn;
            now
        })
    }

    fn carrier_at(&self, t: f64) -> Complex64 {
        let carrier = &self.spec.carrier;
        match carrier.voltage_volt == 0.0 && carrier.current_amp == 0.0 {
            true => Complex64::ZERO,
            false => Complex64::cis(TAU * carrier.frequency_hz * t),
        }
    }

    /// Takes the six quantities at `t`, s, later than the last ones: V, A.
    pub(super) fn observe(&mut self, t: f64, quantities: [f64; CHANNELS]) {
        let step = self.last_t.map_or(0.0, |last| t - last);
        let rate = step.recip();
        self.last_t = Some(t);
        for (line, x) in self.lines.iter_mut().zip(quantities) {
            line.observe(t, step, rate, x);
        }
    }

    /// What is behind the filters and delays at a conversion, with the carrier's ripple: V, A.
    pub(super) fn filtered(&mut self, at: Conversion) -> [f64; CHANNELS] {
        std::array::from_fn(|k| self.lines[k].at(at.t) + (self.ripples[k] * at.carrier).re)
    }

    /// Gain, offset, neighbour and reference: from values at the pins, V, A, to what is converted.
    pub(super) fn distorted(&mut self, at: Conversion, values: [f64; CHANNELS]) -> [f64; CHANNELS] {
        let scales = &self.scales;
        let mut shares: [f64; CHANNELS] =
            std::array::from_fn(|k| values[k] * scales[k].factor + scales[k].offset);
        self.last_share = converter::crosstalk(&mut shares, self.last_share, self.spec.crosstalk);
        let factor = self.spec.reference.factor(at.t);
        std::array::from_fn(|k| {
            let ratiometric = self.spec.channels[k].ratiometric;
            let factor = if ratiometric { 1.0 } else { factor };
            shares[k] * factor * scales[k].full
        })
    }

    /// The converter's deviation from the straight line, V, A.
    pub(super) fn bend(&self, values: &mut [f64; CHANNELS]) {
        for (value, scale) in values.iter_mut().zip(&self.scales) {
            *value += self.linearity.lsb(*value * scale.per_full) * scale.step;
        }
    }
}

/// A carrier does not change, so that its filtered and delayed sinusoid is known without steps.
fn ripple(spec: &SignalChain, k: usize) -> Complex64 {
    let (carrier, channel) = (&spec.carrier, &spec.channels[k]);
    let (amplitude, lag) = match k < 3 {
        true => (carrier.voltage_volt, 0.0),
        false => (carrier.current_amp, FRAC_PI_2),
    };
    let omega = TAU * carrier.frequency_hz;
    let angle = -omega * channel.delay_s - lag - TAU / 3.0 * (k % 3) as f64;
    response(channel, omega) * Complex64::from_polar(amplitude, angle)
}

/// Frequency response of a channel's filter.
fn response(channel: &ChannelChain, omega: f64) -> Complex64 {
    let pole = |tau: f64| Complex64::new(1.0, omega * tau).inv();
    channel.time_constants_s.into_iter().map(pole).product()
}
