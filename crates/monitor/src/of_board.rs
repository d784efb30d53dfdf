//! What the board of this project does with a motor file (feature `motor-file`; hosts and build scripts only).

use std::format;

use motor::FileError;
use motor::motor_file::MotorFile;

use crate::config::MonitorConfig;

/// s; samples of the board.
pub const BOARD_T_SAMPLE: f64 = 1e-4;
/// Conversions of each channel that the board adds up to a sample: over exactly [`BOARD_T_SAMPLE`], so that ripple at its
/// multiples, which else would fold onto the supply, drops out of the mean.
pub const BOARD_CONVERSIONS: u16 = 16;
/// Bits of the board's converter.
const BOARD_ADC_BITS: u32 = 12;

impl MonitorConfig {
    /// What the board computes with: samples every [`BOARD_T_SAMPLE`], each the sum of [`BOARD_CONVERSIONS`] codes.
    ///
    /// # Errors
    /// As of [`MonitorConfig::from_motor_file`], and a converter that is not the board's.
    pub fn of_board(file: &MotorFile) -> Result<Self, FileError> {
        let bits = file.sensors.adc_bits;
        if bits != BOARD_ADC_BITS {
            let message = format!(
                "sensors.adc_bits: the board's converter has {BOARD_ADC_BITS} bits, not {bits}: write {BOARD_ADC_BITS} for it"
            );
            return Err(FileError::whole(&file.name, message));
        }
        let mut summed = file.clone();
        summed.sensors.conversions = u32::from(BOARD_CONVERSIONS);
        MonitorConfig::from_motor_file(&summed, BOARD_T_SAMPLE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::sample::RawSample;

    fn motor() -> MotorFile {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../motors/assumed-300w.toml"
        );
        MotorFile::read(path).expect("a shipped motor file")
    }

    #[test]
    fn sums_of_sixteen_codes_are_the_same_volts_and_amperes() {
        let single = MonitorConfig::from_motor_file(&motor(), BOARD_T_SAMPLE).expect("shipped");
        let board = MonitorConfig::of_board(&motor()).expect("shipped");
        let raw = |factor: u16| RawSample {
            voltage_codes: [100, 2_048, 3_999].map(|code| factor * code),
            current_codes: [2_047, 2_050, 7].map(|code| factor * code),
            ..RawSample::default()
        };
        assert_eq!(
            board.converter.convert(&raw(BOARD_CONVERSIONS)),
            single.converter.convert(&raw(1))
        );
        assert!(board.validate().is_ok());
    }

    #[test]
    fn a_converter_that_is_not_the_boards_is_refused() {
        let mut motor = motor();
        motor.sensors.adc_bits = 14;
        let error = MonitorConfig::of_board(&motor).expect_err("another converter");
        let told = std::string::ToString::to_string(&error);
        assert!(
            told.contains("sensors.adc_bits") && told.contains("write 12"),
            "{told}"
        );
    }
}
