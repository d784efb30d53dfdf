//! What the sample path knows and keeps about ADC codes.

use num_complex::Complex32;

use crate::beside::CodeUnits;
use crate::config::MonitorConfig;
use crate::input::sample::CHANNELS;
use crate::input::validity::reference_scales;
use crate::sync::phasor::{CodeRange, Unit};

/// Most instants that wait to be summed up.
const PART: usize = 32;

/// Axes of the instants that wait to be summed up. Kept in the state only to spare their initialisation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Axes(pub [Complex32; PART]);

/// What the sample path needs to know about ADC codes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Codes {
    pub range: CodeRange,
    pub units: [Unit; CHANNELS],
    /// Turns `2a - b - c` of voltage codes and of current codes into shares of rated.
    pub reference_per_code: [f32; 2],
}

impl Codes {
    /// Units of the codes of an instant at the terminals; each channel's gain is what is known of the instrument beside its scale.
    pub fn at_terminals(&self, gains: [f32; CHANNELS]) -> [CodeUnits; CHANNELS] {
        let [volt, ampere] = self.range.zero;
        let zeros = [volt, volt, volt, ampere, ampere, ampere];
        let mut units = [CodeUnits::default(); CHANNELS];
        let channels = self.units.iter().zip(zeros).zip(gains);
        for (place, ((unit, zero), gain)) in units.iter_mut().zip(channels) {
            *place = CodeUnits {
                scale: unit.scale * gain,
                offset: (unit.scale * zero + unit.offset) * gain,
            };
        }
        units
    }

    pub fn new(config: &MonitorConfig) -> Self {
        let converter = &config.converter;
        let [per_volt, per_ampere] = reference_scales(config.rated_channels());
        Codes {
            range: converter.code_range(),
            units: converter.units(),
            reference_per_code: [
                converter.voltage.unit_per_code * per_volt,
                converter.current.unit_per_code * per_ampere,
            ],
        }
    }
}
