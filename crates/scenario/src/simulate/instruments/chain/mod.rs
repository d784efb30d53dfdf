//! A signal chain at work: each channel's filter and delay, and the converter behind them.

mod converter;
mod line;

use crate::chain::{CHANNELS, ChannelChain, SignalChain};
use converter::Linearity;
use line::Line;
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, TAU};

#[derive(Debug)]
pub(super) struct Chain {
    spec: SignalChain,
    lines: [Line; CHANNELS],
    /// The carrier's ripple behind each channel's filter and delay: a phasor at t = 0.
    ripples: [Complex64; CHANNELS],
    linearity: Linearity,
    /// From one conversion of a channel to the next, s.
    apart_s: f64,
    last_t: Option<f64>,
    /// What the converter took last, as a share of full scale.
    last_share: f64,
}

impl Chain {
    /// `t_sample` is the time, s, over which the conversions of a sample lie.
    pub(super) fn new(spec: &SignalChain, seed: u64, t_sample: f64) -> Chain {
        let apart = t_sample / f64::from(spec.conversions.max(1));
        let span = t_sample - apart;
        Chain {
            apart_s: apart,
            lines: spec.channels.map(|channel| Line::new(channel, span)),
            ripples: std::array::from_fn(|k| ripple(spec, k)),
            linearity: Linearity::new(&spec.inl, seed),
            spec: spec.clone(),
            last_t: None,
            last_share: 0.0,
        }
    }

    /// Times of the conversions of the sample at `t`, s, the last of them.
    pub(super) fn conversions(&self, t: f64) -> impl Iterator<Item = f64> + use<> {
        let apart = self.apart_s;
        let number = self.spec.conversions.max(1);
        (0..number).rev().map(move |k| t - f64::from(k) * apart)
    }

    /// Takes the six quantities at `t`, s, later than the last ones: V, A.
    pub(super) fn observe(&mut self, t: f64, quantities: [f64; CHANNELS]) {
        let step = self.last_t.map_or(0.0, |last| t - last);
        self.last_t = Some(t);
        for (line, x) in self.lines.iter_mut().zip(quantities) {
            line.observe(t, step, x);
        }
    }

    /// What stands behind the filters and delays at `t`, one of the times of a sample's conversions, with the carrier's ripple: V, A.
    pub(super) fn filtered(&self, t: f64) -> [f64; CHANNELS] {
        let carrier = &self.spec.carrier;
        let turned = match carrier.voltage_volt == 0.0 && carrier.current_amp == 0.0 {
            true => Complex64::ZERO,
            false => Complex64::cis(TAU * carrier.frequency_hz * t),
        };
        std::array::from_fn(|k| self.lines[k].at(t) + (self.ripples[k] * turned).re)
    }

    /// Gain, offset, neighbour and reference: from values at the pins, V, A, to what is converted.
    pub(super) fn distorted(
        &mut self,
        t: f64,
        values: [f64; CHANNELS],
        full_scales: [f64; CHANNELS],
    ) -> [f64; CHANNELS] {
        let channels = &self.spec.channels;
        let mut shares: [f64; CHANNELS] = std::array::from_fn(|k| {
            (values[k] * (1.0 + channels[k].gain_error) + channels[k].offset) / full_scales[k]
        });
        self.last_share = converter::crosstalk(&mut shares, self.last_share, self.spec.crosstalk);
        let factor = self.spec.reference.factor(t);
        std::array::from_fn(|k| {
            let factor = if channels[k].ratiometric { 1.0 } else { factor };
            shares[k] * factor * full_scales[k]
        })
    }

    /// Deviation of the code of a share of full scale, LSB.
    pub(super) fn inl_lsb(&self, share: f64) -> f64 {
        self.linearity.lsb(share)
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
