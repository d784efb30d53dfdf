//! What the sample path knows and keeps about ADC codes.

use num_complex::Complex32;

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
