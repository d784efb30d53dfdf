//! From ADC codes to SI units: the one place where codes become volts and amperes.

use crate::input::chain::AnalogueChain;
use crate::input::sample::{CHANNELS, ClippedChannels, RawSample, Sample, SpeedSample};
use crate::sync::phasor::{CodeRange, Unit};
use frames::Abc;

/// Codes within this distance of a rail count as clipped: a converter's last code is reached
/// before its input stops rising.
const RAIL_MARGIN_CODES: u16 = 1;

/// How one group of three channels turns codes into SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelScale {
    /// V or A per code.
    pub unit_per_code: f32,
    /// Code of 0 V or 0 A.
    pub zero_code: f32,
    /// Gain correction of each channel, 1 when uncalibrated; applied after the offset.
    pub gain: Abc,
    /// Offset of each channel, V or A before the gain: what it shows at standstill.
    pub offset: Abc,
}

/// Calibration of the six analogue channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Converter {
    /// Phase voltages.
    pub voltage: ChannelScale,
    /// Phase currents.
    pub current: ChannelScale,
    /// Largest code of the converter, `2^bits - 1`.
    pub max_code: u16,
    /// What lies ahead of the converter; undone on the phasors of codes, not by [`Converter::convert`].
    pub chain: AnalogueChain,
    /// Whether the sensors of voltages and of currents follow the converter's supply, so that it does not show in their codes.
    pub ratiometric: [bool; 2],
}

impl ChannelScale {
    /// A bipolar channel whose range `-full_scale..full_scale` (V or A) spans all codes of `bits` bits.
    pub fn bipolar(full_scale: f32, bits: u8) -> Self {
        let codes = (1_u32 << bits.min(16)) as f32;
        ChannelScale {
            unit_per_code: 2.0 * full_scale / codes,
            zero_code: codes / 2.0,
            gain: Abc::splat(1.0),
            offset: Abc::default(),
        }
    }

    /// The same quantity in sums of `conversions` codes.
    fn summed(self, conversions: u16) -> Self {
        let conversions = f32::from(conversions);
        ChannelScale {
            unit_per_code: self.unit_per_code / conversions,
            zero_code: self.zero_code * conversions,
            ..self
        }
    }

    fn units(&self) -> [Unit; 3] {
        let [gains, offsets] = [self.gain, self.offset].map(Abc::to_array);
        core::array::from_fn(|phase| {
            let (gain, offset) = (gains[phase], offsets[phase]);
            Unit {
                scale: self.unit_per_code * gain,
                offset: offset * gain,
            }
        })
    }

    fn convert(&self, codes: [u16; 3]) -> Abc {
        let raw = Abc::from_array(codes.map(|code| f32::from(code) - self.zero_code));
        raw.zip(self.offset, |x, offset| x * self.unit_per_code - offset)
            .zip(self.gain, |x, gain| x * gain)
    }
}

impl Converter {
    /// Uncalibrated bipolar channels: full scales in V and A, resolution in bits (at most 16).
    pub fn bipolar(voltage_full_scale: f32, current_full_scale: f32, bits: u8) -> Self {
        Converter {
            voltage: ChannelScale::bipolar(voltage_full_scale, bits),
            current: ChannelScale::bipolar(current_full_scale, bits),
            max_code: ((1_u32 << bits.min(16)) - 1) as u16,
            chain: AnalogueChain::NONE,
            ratiometric: [false; 2],
        }
    }

    /// The same channels where `conversions` codes of each are added up to one code of an instant: 1 to as many as 16 bits hold,
    /// 16 of a converter of 12 bits. Nothing is divided, so that no bit of the mean is lost. A single conversion at a rail does
    /// not show in a sum: it has to be marked ([`RawSample::clipped`]).
    #[must_use]
    pub fn summed(self, conversions: u16) -> Self {
        Converter {
            voltage: self.voltage.summed(conversions),
            current: self.current.summed(conversions),
            max_code: self.max_code.saturating_mul(conversions),
            ..self
        }
    }

    /// What brings each channel back that was read against a supply of `share` of the nominal one: a low supply makes absolute
    /// readings large.
    pub(crate) fn supply_gains(&self, share: f32) -> [f32; CHANNELS] {
        let [voltage, current] = self
            .ratiometric
            .map(|follows| if follows { 1.0 } else { share });
        [voltage, voltage, voltage, current, current, current]
    }

    /// One instant in SI units, with the channels at a rail marked.
    pub fn convert(&self, raw: &RawSample) -> Sample {
        Sample {
            u_s_abc: Some(self.voltage.convert(raw.voltage_codes)),
            i_s_abc: Some(self.current.convert(raw.current_codes)),
            speed: SpeedSample::Count(raw.encoder_count),
            tau_load: None,
            clipped: self.clipped(&[raw.interleaved()]).union(raw.clipped),
        }
    }

    /// Units of sums over codes above the code of zero: voltages a, b, c, then currents a, b, c.
    pub(crate) fn units(&self) -> [Unit; CHANNELS] {
        let [v_a, v_b, v_c] = self.voltage.units();
        let [i_a, i_b, i_c] = self.current.units();
        [v_a, v_b, v_c, i_a, i_b, i_c]
    }

    /// What the codes are summed up with.
    pub(crate) fn code_range(&self) -> CodeRange {
        CodeRange {
            zero: [self.voltage.zero_code, self.current.zero_code],
            lowest: i32::from(RAIL_MARGIN_CODES) + 1,
            highest: i32::from(self.max_code) - i32::from(RAIL_MARGIN_CODES) - 1,
        }
    }

    /// Channels at a rail in any of the instants, whose codes are in the order of [`crate::RawBlock`].
    pub(crate) fn clipped(&self, codes: &[[u16; CHANNELS]]) -> ClippedChannels {
        let mut clipped = ClippedChannels::NONE;
        for instant in codes {
            let (phases, _) = instant.as_chunks::<2>();
            for (phase, [voltage, current]) in phases.iter().enumerate() {
                if self.at_rail(*voltage) {
                    clipped.mark_voltage(phase);
                }
                if self.at_rail(*current) {
                    clipped.mark_current(phase);
                }
            }
        }
        clipped
    }

    fn at_rail(&self, code: u16) -> bool {
        code <= RAIL_MARGIN_CODES || code >= self.max_code.saturating_sub(RAIL_MARGIN_CODES)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_become_volts_and_amperes() {
        let converter = Converter::bipolar(600.0, 60.0, 12);
        let sample = converter.convert(&RawSample {
            voltage_codes: [2048, 3072, 1024],
            current_codes: [2048, 2049, 2047],
            encoder_count: 7,
            ..RawSample::default()
        });
        assert_eq!(
            sample.u_s_abc,
            Some(Abc {
                a: 0.0,
                b: 300.0,
                c: -300.0
            })
        );
        let lsb = 120.0 / 4096.0;
        assert_eq!(
            sample.i_s_abc,
            Some(Abc {
                a: 0.0,
                b: lsb,
                c: -lsb
            })
        );
        assert_eq!(sample.speed, SpeedSample::Count(7));
        assert!(!sample.clipped.any());
    }

    #[test]
    fn calibration_corrects_offset_then_gain() {
        let mut converter = Converter::bipolar(2048.0, 2048.0, 12);
        converter.voltage.gain.b = 1.1;
        converter.voltage.offset.b = 5.0;
        let sample = converter.convert(&RawSample {
            voltage_codes: [2148; 3],
            ..RawSample::default()
        });
        let voltages = sample.u_s_abc.unwrap_or_default();
        assert_eq!(voltages.a, 100.0);
        assert!((voltages.b - 104.5).abs() < 1e-4); // f32 rounding of 110
    }

    #[test]
    fn both_rails_are_marked_per_channel() {
        let converter = Converter::bipolar(600.0, 60.0, 12);
        let sample = converter.convert(&RawSample {
            voltage_codes: [4095, 2048, 2048],
            current_codes: [2048, 2048, 0],
            encoder_count: 0,
            ..RawSample::default()
        });
        assert!(sample.clipped.voltage(0) && sample.clipped.current(2));
        assert!(!sample.clipped.voltage(1) && !sample.clipped.current(0));
    }

    /// Sums of codes and single codes become the same V and A: `scale * code - offset` is the converted value.
    #[test]
    fn units_of_sums_agree_with_single_codes() {
        let mut converter = Converter::bipolar(600.0, 60.0, 12);
        converter.voltage.gain.b = 1.1;
        converter.voltage.offset.b = 5.0;
        converter.current.gain.c = 0.9;
        converter.current.offset.c = -0.5;
        let sample = converter.convert(&RawSample {
            voltage_codes: [2100; 3],
            current_codes: [2000; 3],
            encoder_count: 0,
            ..RawSample::default()
        });
        let volts = sample.u_s_abc.unwrap_or_default().to_array();
        let amperes = sample.i_s_abc.unwrap_or_default().to_array();
        let [volt_zero, ampere_zero] = converter.code_range().zero;
        for (k, unit) in converter.units().into_iter().enumerate() {
            let (code, expected) = if k < 3 {
                (2100.0 - volt_zero, volts[k])
            } else {
                (2000.0 - ampere_zero, amperes[k - 3])
            };
            let si = unit.scale * code - unit.offset;
            assert!(
                (si - expected).abs() < 1e-5,
                "channel {k}: {si} and {expected}"
            );
        }
    }

    /// The range within which nothing is clipped ends exactly where a code counts as clipped.
    #[test]
    fn the_range_of_sound_codes_ends_at_the_rails() {
        let converter = Converter::bipolar(600.0, 60.0, 12);
        let range = converter.code_range();
        for code in [0, 1, 2, 3, 2048, 4092, 4093, 4094, 4095_u16] {
            let sound = (range.lowest..=range.highest).contains(&i32::from(code));
            assert_eq!(sound, (2..=4093).contains(&code), "{code}");
            assert_eq!(
                converter.clipped(&[[code; CHANNELS]]).any(),
                !sound,
                "{code}"
            );
        }
    }

    /// Sixteen conversions added up are the mean in V and A, to the bit where the mean is a code.
    #[test]
    fn a_sum_of_codes_is_their_mean() {
        let mut single = Converter::bipolar(600.0, 60.0, 12);
        single.voltage.offset.b = 5.0;
        single.current.gain.c = 0.9;
        let summed = single.summed(16);
        let raw = |factor: u16| RawSample {
            voltage_codes: [3_000, 2_048, 17].map(|code| factor * code),
            current_codes: [2_047, 1_000, 4_000].map(|code| factor * code),
            ..RawSample::default()
        };
        assert_eq!(summed.convert(&raw(16)), single.convert(&raw(1)));
        assert_eq!(summed.max_code, 65_520);
        // A sixteenth of a code counts.
        let mut more = raw(16);
        more.voltage_codes[0] += 1;
        let moved = summed.convert(&more).u_s_abc.unwrap_or_default().a
            - summed.convert(&raw(16)).u_s_abc.unwrap_or_default().a;
        assert!((moved - 1_200.0 / 65_536.0).abs() < 3e-5); // f32 at 280 V
    }

    #[test]
    fn a_marked_conversion_is_clipped_whatever_the_sum_is() {
        let converter = Converter::bipolar(600.0, 60.0, 12).summed(16);
        let mut raw = RawSample {
            voltage_codes: [32_768; 3],
            current_codes: [32_768; 3],
            ..RawSample::default()
        };
        assert!(!converter.convert(&raw).clipped.any());
        raw.clipped.mark_current(1);
        assert!(converter.convert(&raw).clipped.current(1));
    }

    #[test]
    fn a_converter_of_any_resolution_spans_its_range() {
        for (bits, max_code) in [(8, 255), (12, 4095), (16, 65_535), (20, 65_535)] {
            let converter = Converter::bipolar(100.0, 10.0, bits);
            assert_eq!(converter.max_code, max_code);
            let lowest = converter.convert(&RawSample::default());
            assert_eq!(lowest.u_s_abc, Some(Abc::splat(-100.0)));
            assert_eq!(lowest.i_s_abc, Some(Abc::splat(-10.0)));
        }
    }
}
