//! `[sensors.chain]`: what lies between a quantity and its code: filter, delay, gain, offset, reference, converter.

mod read;

pub(crate) use read::read;

/// Channels of a chain: voltages a, b, c, then currents a, b, c.
pub const CHANNELS: usize = 6;

/// The order in which the board's converter takes the channels (`src/hardware/sampling.rs`): each voltage before its current.
pub const SEQUENCE: [usize; CHANNELS] = [0, 3, 1, 4, 2, 5];

/// One signal chain for each channel and the converter that they share. [`SignalChain::default`] changes nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalChain {
    /// Voltages a, b, c, then currents a, b, c.
    pub channels: [ChannelChain; CHANNELS],
    /// Ripple of an inverter on top of the signals, ahead of the filters.
    pub carrier: Carrier,
    /// Share of the difference to the channel converted just before (both in shares of their full scale) that leaks in, 0..=0.1.
    pub crosstalk: f64,
    /// Integral non-linearity of the converter.
    pub inl: Inl,
    /// The voltage that the converter compares with.
    pub reference: Reference,
    /// Conversions of each channel, evenly over the sampling time and the last one at its end, that a sample is the mean of,
    /// 1..=16; its codes are their sum.
    pub conversions: u32,
}

impl Default for SignalChain {
    fn default() -> Self {
        SignalChain {
            channels: Default::default(),
            carrier: Carrier::default(),
            crosstalk: 0.0,
            inl: Inl::default(),
            reference: Reference::default(),
            conversions: 1,
        }
    }
}

/// The way of one channel to the converter's pin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChannelChain {
    /// Time constants of a low-pass with two real poles, s, 0..=0.01 each; 0 is no pole.
    pub time_constants_s: [f64; 2],
    /// Pure delay behind the filter, s, 0..=0.001.
    pub delay_s: f64,
    /// Deviation of the gain from what the motor file says, -0.5..=0.5; 0.01 reads 1 % too much.
    pub gain_error: f64,
    /// Offset beyond the motor file's, V or A.
    pub offset: f64,
    /// Whether the sensor's output follows the converter's reference, so that a wrong reference does not show.
    pub ratiometric: bool,
}

/// A sinusoid of the same frequency in all channels, the phases a third of a turn apart and the currents a quarter turn
/// behind the voltages, as an inductance makes them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Carrier {
    /// Hz, 0..=1e6.
    pub frequency_hz: f64,
    /// Amplitude in the phase voltages, V.
    pub voltage_volt: f64,
    /// Amplitude in the phase currents, A.
    pub current_amp: f64,
}

/// Integral non-linearity: how far a code lies from the straight line through the ends of the range.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inl {
    /// Largest deviation, LSB of `adc_bits`, 0..=64.
    pub lsb: f64,
    /// Where it lies.
    pub shape: InlShape,
}

/// Shape of the integral non-linearity over the range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InlShape {
    /// `1 - s^2` of the share `s` of full scale: a second harmonic.
    #[default]
    Bow,
    /// `s - s^3`, scaled to 1 at its crest: a third harmonic and a gain that falls with the amplitude.
    Cubic,
    /// Steps at the codes where the six upper bits change, with bit weights drawn from the scenario's seed: what a
    /// converter by successive approximation has, with the largest step at mid-scale.
    Bits,
}

/// Deviation of the converter's reference from its nominal value. Too high a reference makes readings too small.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reference {
    /// At t = 0, -0.2..=0.2.
    pub error: f64,
    /// Change per second, -0.1..=0.1.
    pub drift_per_s: f64,
}

impl Reference {
    /// Nominal over true reference at `t`, s: the factor on readings of absolute sensors.
    pub(crate) fn factor(&self, t: f64) -> f64 {
        1.0 / (1.0 + self.error + self.drift_per_s * t)
    }
}
