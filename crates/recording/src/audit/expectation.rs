//! What the motor's nameplate lets one expect of a recording.

use motor::motor_file::Nameplate;
use std::f64::consts::TAU;

/// Rated values; each check uses those it needs and is skipped without them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expectation {
    /// Pole pairs.
    pub pole_pairs: Option<u32>,
    /// Rated frequency, Hz.
    pub frequency_hz: Option<f64>,
    /// Rated line-to-line voltage, V rms.
    pub voltage_line_rms_volt: Option<f64>,
    /// Rated line current, A rms.
    pub current_rms_amp: Option<f64>,
    /// Rated torque, N m.
    pub torque_nm: Option<f64>,
}

impl Expectation {
    /// Rated amplitude of the phase voltage, V.
    pub(super) fn voltage_amplitude(&self) -> Option<f64> {
        self.voltage_line_rms_volt
            .map(|line| line * (2.0_f64 / 3.0).sqrt())
    }

    /// Rated amplitude of the line current, A.
    pub(super) fn current_amplitude(&self) -> Option<f64> {
        self.current_rms_amp
            .map(|rms| rms * std::f64::consts::SQRT_2)
    }

    /// Rated angular frequency, rad/s.
    pub(super) fn omega(&self) -> Option<f64> {
        self.frequency_hz.map(|f| TAU * f)
    }
}

impl From<&Nameplate> for Expectation {
    fn from(nameplate: &Nameplate) -> Expectation {
        Expectation {
            pole_pairs: Some(nameplate.pole_pairs),
            frequency_hz: Some(nameplate.frequency_hz),
            voltage_line_rms_volt: Some(nameplate.voltage_line_rms_volt),
            current_rms_amp: Some(nameplate.current_rms_amp),
            torque_nm: Some(nameplate.torque_nm),
        }
    }
}
