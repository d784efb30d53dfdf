//! What the motor's nameplate lets one expect of a recording.

use motor::MotorFile;
use motor::motor_file::Nameplate;
use motor::steady_state::SteadyState;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// What the motor file's equivalent circuit says about the power that slip asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circuit {
    /// Resistance of a stator phase, ohm.
    pub stator_ohm: f64,
    /// Power that crosses the air gap, W, per slip and per squared amplitude of the phase voltage, V^2, at small slip.
    pub slip_watt_per_volt2: f64,
}

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
    /// The equivalent circuit, where a whole motor file is known.
    pub circuit: Option<Circuit>,
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
            circuit: None,
        }
    }
}

impl From<&MotorFile> for Expectation {
    fn from(motor: &MotorFile) -> Expectation {
        Expectation {
            circuit: Some(Circuit::from(motor)),
            ..Expectation::from(&motor.nameplate)
        }
    }
}

impl From<&MotorFile> for Circuit {
    fn from(motor: &MotorFile) -> Circuit {
        /// Small enough for the torque curve to be straight.
        const SLIP: f64 = 1e-4;
        let nameplate = &motor.nameplate;
        let (volt, omega) = (nameplate.phase_voltage_amplitude(), nameplate.omega_sync());
        let pole_pairs = f64::from(nameplate.pole_pairs);
        let supply = Complex64::new(volt, 0.0);
        let steady = SteadyState::new(&motor.parameters, pole_pairs, supply, omega);
        let air_gap = steady.at_slip_speed(SLIP * omega).tau_em * omega / pole_pairs;
        Circuit {
            stator_ohm: motor.parameters.r_s,
            slip_watt_per_volt2: air_gap / (SLIP * volt * volt),
        }
    }
}
