//! What the analogue chain does to a sinusoid, undone on its phasor.

use num_complex::Complex32;

use crate::input::sample::CHANNELS;
use pll::small_rotation;

/// Delay and roll-off of the way from the motor's terminals to the codes: filter, order of conversion, isolation.
///
/// A channel shows `x(t - delay)` by a filter whose gain at the low frequency `w` is `1 - (w T)^2/2`; the square of `T` is the
/// sum of the squares of all its parts. Gain and offset are those of [`crate::ChannelScale`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnalogueChain {
    /// By how much each channel is late, s, in -5e-5..=2e-4: voltages a, b, c, then currents a, b, c.
    pub delay: [f32; CHANNELS],
    /// Time constant of the roll-off of all channels, s, in 0..=3e-4.
    pub roll_off: f32,
}

impl AnalogueChain {
    /// Neither late nor filtered.
    pub const NONE: AnalogueChain = AnalogueChain {
        delay: [0.0; CHANNELS],
        roll_off: 0.0,
    };
    /// Shortest and longest delay, s.
    pub const DELAYS: [f32; 2] = [-5e-5, 2e-4];
    /// Smallest and largest time constant of the roll-off, s.
    pub const ROLL_OFFS: [f32; 2] = [0.0, 3e-4];

    /// What brings each channel's phasor at `omega`, rad/s, back to the terminals: `(1 + (w T)^2/2) e^(j w delay)`.
    ///
    /// Up to 100 Hz what remains of a second-order filter of T = 84 us is below 0.001 % and, once its delay is known, 0.01 degrees.
    pub(crate) fn undone(&self, omega: f32) -> [Complex32; CHANNELS] {
        let turn = omega * self.roll_off;
        let gain = 1.0 + 0.5 * turn * turn;
        self.delay.map(|delay| small_rotation(omega * delay) * gain)
    }
}

/// Supply of the converter as a share of the one that the full scales are meant for; 1 where nobody measures it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ConverterSupply(pub f32);

impl ConverterSupply {
    /// Beyond these shares it is the measurement that is wrong.
    const CREDIBLE: core::ops::RangeInclusive<f32> = 0.9..=1.1;

    pub fn measured(share: f32) -> Self {
        match Self::CREDIBLE.contains(&share) {
            true => ConverterSupply(share),
            false => ConverterSupply::default(),
        }
    }
}

impl Default for ConverterSupply {
    fn default() -> Self {
        ConverterSupply(1.0)
    }
}

impl Default for AnalogueChain {
    fn default() -> Self {
        AnalogueChain::NONE
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;
    use num_complex::Complex64;

    /// 9.53 kohm and 8.2 nF, then 150 ohm and 47 nF behind the buffer: docs/wiring.md.
    const POLES: [f64; 2] = [9.53e3 * 8.2e-9, 150.0 * 47e-9];
    /// Isolated amplifier, half the mean over 100 us, order of conversion.
    const PURE: f64 = 1.6e-6 + 46.9e-6 + 0.6e-6;

    fn shown(omega: f64) -> Complex64 {
        let filter = POLES
            .map(|t| 1.0 / Complex64::new(1.0, omega * t))
            .iter()
            .product::<Complex64>();
        filter * Complex64::from_polar(1.0, -omega * PURE)
    }

    /// Against the exact transfer function of the documented stage, 5 to 100 Hz.
    #[test]
    fn the_documented_stage_is_undone() {
        let [first, second] = POLES;
        let chain = AnalogueChain {
            delay: [(first + second + PURE) as f32; CHANNELS],
            roll_off: first.hypot(second) as f32,
        };
        for hertz in 5..=100 {
            let omega = TAU * f64::from(hertz);
            let [factor, ..] = chain.undone(omega as f32);
            let whole = shown(omega) * Complex64::new(f64::from(factor.re), f64::from(factor.im));
            // (w T)^4 3/8 at 100 Hz is 2e-6; the angle keeps (w T)^3/3, 0.0023 degrees, and single precision 1e-7.
            assert!((whole.norm() - 1.0).abs() < 1e-5, "{hertz} Hz: {whole}");
            assert!(
                whole.arg().abs() < 5e-3_f64.to_radians(),
                "{hertz} Hz: {whole}"
            );
        }
    }

    #[test]
    fn channels_that_are_late_by_different_times_come_back_to_one_angle() {
        let delays = [-5e-5, 0.0, 2e-5, 8.894e-5, 1.3e-4, 2e-4_f32];
        let chain = AnalogueChain {
            delay: delays,
            roll_off: 0.0,
        };
        let omega = TAU as f32 * 60.0;
        let exact =
            delays.map(|late| Complex64::from_polar(1.0, -f64::from(omega) * f64::from(late)));
        for (factor, exact) in chain.undone(omega).iter().zip(exact) {
            let back = exact * Complex64::new(f64::from(factor.re), f64::from(factor.im));
            assert!((back - 1.0).norm() < 3e-7, "{back}");
        }
    }

    #[test]
    fn no_chain_changes_no_bit() {
        let factors = AnalogueChain::NONE.undone(314.16);
        assert_eq!(factors, [Complex32::ONE; CHANNELS]);
    }
}
