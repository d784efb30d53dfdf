//! What was learnt on the running motor: channel corrections, thresholds and healthy statistics, and their record in flash.
//!
//! A record names the motor constants that it belongs to and carries a schema version and a CRC-32, so that neither a
//! half-written record nor one of another motor is ever computed with.

mod record;
mod store;

pub use record::RECORD_BYTES;
pub use store::{Loaded, PAGE_BYTES, PAGES, Store, StoreError};

use monitor::{Abc, ChannelScale, MonitorConfig, RESIDUALS};
use serde::{Deserialize, Serialize};

use crate::checksum::crc32;

/// Entries of a symmetric matrix over the residuals: its upper triangle, row by row.
pub const COVARIANCES: usize = RESIDUALS * (RESIDUALS + 1) / 2;

/// Correction of three channels of a kind, as in [`ChannelScale`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChannelTrim {
    /// V or A, before the gain.
    pub offset: [f32; 3],
    /// Factor, after the offset.
    pub gain: [f32; 3],
}

impl From<&ChannelScale> for ChannelTrim {
    fn from(scale: &ChannelScale) -> Self {
        let array = |abc: Abc| [abc.a, abc.b, abc.c];
        ChannelTrim {
            offset: array(scale.offset),
            gain: array(scale.gain),
        }
    }
}

impl ChannelTrim {
    /// Gains as far from 1 as `drivemon`'s motor files allow channel corrections to be, and offsets that are numbers.
    fn is_sound(&self) -> bool {
        self.offset.iter().all(|offset| offset.is_finite())
            && self.gain.iter().all(|gain| (0.1..=10.0).contains(gain))
    }

    fn apply(&self, scale: &mut ChannelScale) {
        scale.offset = Abc::from_array(self.offset);
        scale.gain = Abc::from_array(self.gain);
    }
}

/// How the residuals of the healthy motor are spread, as shares of their scales.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Healthy {
    /// Judged windows behind the numbers.
    pub windows: u32,
    /// Means of r1..r4.
    pub mean: [f32; RESIDUALS],
    /// Covariance of r1..r4: upper triangle, row by row.
    pub covariance: [f32; COVARIANCES],
}

/// Places of the variances in the upper triangle.
const DIAGONAL: [usize; RESIDUALS] = [0, 4, 7, 9];

impl Healthy {
    /// Standard deviations of r1..r4.
    pub fn deviation(&self) -> [f32; RESIDUALS] {
        DIAGONAL.map(|place| processor::sqrtf(self.covariance[place].max(0.0)))
    }
}

/// A calibration of this board on this motor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// [`crate::MotorImage::identification`] of the motor constants that it belongs to.
    pub motor: u32,
    /// Voltage channels.
    pub voltage: ChannelTrim,
    /// Current channels.
    pub current: ChannelTrim,
    /// Thresholds of r1..r4 as shares of their scales.
    pub thresholds: [f32; RESIDUALS],
    /// What the thresholds rest on.
    pub healthy: Healthy,
}

impl Calibration {
    /// What tells it from others: the checksum of its bytes, never 0.
    #[inline(never)]
    pub fn identification(&self) -> u32 {
        record::Record::new(0, *self)
            .to_bytes()
            .map_or(1, |bytes| crc32(&bytes).max(1))
    }

    /// Puts it in the place of the compiled-in values. Ranges are checked by [`monitor::Monitor::new`].
    pub fn apply(&self, config: &mut MonitorConfig) {
        self.voltage.apply(&mut config.converter.voltage);
        self.current.apply(&mut config.converter.current);
        config.thresholds = self.thresholds;
    }

    /// The same where every value is within its range; otherwise nothing changes and the answer is `false`.
    #[inline(never)]
    pub fn apply_checked(&self, config: &mut MonitorConfig) -> bool {
        let before = *config;
        self.apply(config);
        let trims = [self.voltage, self.current];
        let sound = trims.iter().all(ChannelTrim::is_sound) && config.validate().is_ok();
        if !sound {
            *config = before;
        }
        sound
    }
}

/// Which values the board computes with. The numbers are those of the Modbus register.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum CalibrationSource {
    /// The motor file's; nothing was ever learnt.
    #[default]
    CompiledIn = 0,
    /// Learnt ones.
    Flash = 1,
    /// The motor file's, because no learnt ones are whole or within their ranges, or flash cannot be read.
    Lost = 2,
    /// The motor file's, because the learnt ones belong to other motor constants.
    OtherMotor = 3,
}

impl CalibrationSource {
    /// Whether there was a calibration that could not be used.
    pub fn is_ignored(self) -> bool {
        matches!(
            self,
            CalibrationSource::Lost | CalibrationSource::OtherMotor
        )
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn example(motor: u32) -> Calibration {
        let trim = ChannelTrim {
            offset: [0.25, -0.5, 1.0],
            gain: [1.0, 0.98, 1.02],
        };
        Calibration {
            motor,
            voltage: trim,
            current: trim,
            thresholds: [0.01, 0.02, 0.03, 0.04],
            healthy: Healthy {
                windows: u32::MAX,
                mean: [f32::MIN; RESIDUALS],
                covariance: [1.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 9.0, 0.0, 16.0],
            },
        }
    }

    #[test]
    fn values_beyond_their_ranges_change_nothing() {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../motors/assumed-300w.toml"
        );
        let file = motor::motor_file::MotorFile::read(path).expect("a shipped motor file");
        let factory = MonitorConfig::from_motor_file(&file, 1e-4).expect("no effects");
        let mut config = factory;
        assert!(example(0).apply_checked(&mut config) && config != factory);
        let breakages: [fn(&mut Calibration); 3] = [
            |calibration| calibration.thresholds[2] = f32::NAN,
            |calibration| calibration.voltage.gain[1] = 0.0,
            |calibration| calibration.current.offset[0] = f32::INFINITY,
        ];
        for change in breakages {
            let (mut config, mut calibration) = (factory, example(0));
            change(&mut calibration);
            assert!(!calibration.apply_checked(&mut config));
            assert_eq!(config, factory);
        }
    }

    #[test]
    fn the_diagonal_of_the_triangle_holds_the_variances() {
        assert_eq!(example(0).healthy.deviation(), [1.0, 2.0, 3.0, 4.0]);
    }
}
