//! The steady operating point in d-q coordinates, in the paper's frame or in the rotor-flux frame.

use motor::TParams;
use motor::steady_state::rotor_flux;
use num_complex::Complex32;

use crate::model::effects::Corrected;
use crate::rehearsal::Rehearsal;
use frames::{Dq, magnitude};

/// Where the d axis lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Frame {
    /// On the rotor flux, where (13)-(29) hold exactly.
    #[default]
    RotorFlux,
    /// 90 degrees behind the supply voltage, as the paper's zero-crossing instrument has it.
    Voltage,
}

/// A steady operating point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OperatingPoint {
    /// Stator voltage, V.
    pub u_s_dq: Dq,
    /// Stator current, A.
    pub i_s_dq: Dq,
    /// Length of the voltage vector, V.
    pub u_amplitude: f32,
    /// Length of the rotor flux, V s.
    pub psi_r: f32,
    /// Parameters that hold at this point.
    pub params: TParams<f32>,
    /// Torque that physical effects take from the shaft beside viscous friction, N m.
    pub tau_extra: f32,
    /// Supply frequency, rad/s.
    pub omega_sync: f32,
    /// Electrical rotor speed, rad/s.
    pub omega_el: f32,
}

impl OperatingPoint {
    /// From what one window measured, corrected for physical effects, and speeds, rad/s electrical.
    ///
    /// `None` when there is no voltage, no flux or no frequency: then there is no frame either.
    #[inline(never)]
    pub fn new(measured: &Corrected, frame: Frame, omega_sync: f32, omega_el: f32) -> Option<Self> {
        let Corrected { u_s, i_s, .. } = *measured;
        let params = &measured.params;
        let psi_r = rotor_flux(params, u_s, i_s, omega_sync);
        let axis = match frame {
            Frame::RotorFlux => unit(psi_r)?,
            Frame::Voltage => unit(u_s)? * Complex32::new(0.0, -1.0),
        };
        let (u, i) = (u_s * axis.conj(), i_s * axis.conj());
        Some(OperatingPoint {
            u_s_dq: Dq { d: u.re, q: u.im },
            i_s_dq: Dq { d: i.re, q: i.im },
            u_amplitude: magnitude(u_s),
            psi_r: magnitude(psi_r),
            params: *params,
            tau_extra: measured.tau_extra,
            omega_sync,
            omega_el,
        })
    }

    /// Slip speed `w_s - w_r`, rad/s electrical.
    pub fn omega_slip(&self) -> f32 {
        self.omega_sync - self.omega_el
    }

    /// The same point as a rehearsed sensor fault would show it.
    pub fn rehearse(self, gains: &Rehearsal) -> Self {
        OperatingPoint {
            u_s_dq: Dq {
                d: self.u_s_dq.d * gains.voltage_gain,
                q: self.u_s_dq.q * gains.voltage_gain,
            },
            i_s_dq: Dq {
                d: self.i_s_dq.d,
                q: self.i_s_dq.q * gains.current_q_gain,
            },
            u_amplitude: self.u_amplitude * gains.voltage_gain,
            omega_el: self.omega_el * gains.speed_gain,
            ..self
        }
    }
}

fn unit(x: Complex32) -> Option<Complex32> {
    let length = magnitude(x);
    (length.is_finite() && length > f32::MIN_POSITIVE).then(|| x / length)
}

#[cfg(test)]
mod tests {
    use motor::steady_state::SteadyState;
    use num_complex::Complex64;

    use super::*;

    const PARAMS: TParams<f64> = TParams {
        r_s: 8.0,
        r_r: 7.0,
        l_ls: 0.028,
        l_lr: 0.035,
        l_m: 0.42,
    };
    const OMEGA_SYNC: f64 = 377.0;

    fn single(x: Complex64) -> Complex32 {
        Complex32::new(x.re as f32, x.im as f32)
    }

    /// A motor at 5 % slip whose voltage stands at `angle`, rad.
    fn measured(angle: f64) -> (Corrected, f32) {
        let supply = Complex64::from_polar(180.0, angle);
        let point = SteadyState::new(&PARAMS, 2.0, supply, OMEGA_SYNC).at_friction(0.0043);
        let measured = Corrected {
            u_s: single(point.u_s),
            i_s: single(point.i_s),
            omega_mech: point.omega_mech as f32,
            params: TParams {
                r_s: 8.0,
                r_r: 7.0,
                l_ls: 0.028,
                l_lr: 0.035,
                l_m: 0.42,
            },
            tau_extra: 0.25,
        };
        (measured, point.omega_el as f32)
    }

    fn point(frame: Frame, angle: f64) -> OperatingPoint {
        let (measured, omega_el) = measured(angle);
        OperatingPoint::new(&measured, frame, OMEGA_SYNC as f32, omega_el)
            .expect("there is a frame")
    }

    /// The paper's frame: the voltage lies on the q axis.
    #[test]
    fn the_voltage_frame_has_all_voltage_on_q() {
        for angle in [0.0, 1.0, -2.5] {
            let point = point(Frame::Voltage, angle);
            assert!(point.u_s_dq.d.abs() < 1e-4, "{point:?}");
            assert!((point.u_s_dq.q - 180.0).abs() < 1e-3, "{point:?}");
        }
    }

    /// In steady state the rotor flux is `L_m I_d`, and the slip follows from (16).
    #[test]
    fn the_rotor_flux_frame_obeys_the_rotor_equations() {
        for angle in [0.0, 1.0, -2.5] {
            let point = point(Frame::RotorFlux, angle);
            let l_r = 0.455;
            assert!((point.psi_r - 0.42 * point.i_s_dq.d).abs() < 1e-4);
            let slip = 7.0 * 0.42 / l_r * point.i_s_dq.q / point.psi_r;
            assert!((point.omega_slip() - slip).abs() < 1e-2, "{slip} {point:?}");
            assert!((point.u_amplitude - 180.0).abs() < 1e-3);
            assert_eq!(point.tau_extra, 0.25);
        }
    }

    #[test]
    fn without_voltage_or_flux_there_is_no_frame() {
        let (mut measured, omega_el) = measured(0.3);
        measured.u_s = Complex32::ZERO;
        let new =
            |measured: &Corrected, frame| OperatingPoint::new(measured, frame, 377.0, omega_el);
        assert_eq!(new(&measured, Frame::Voltage), None);
        measured.i_s = Complex32::ZERO;
        assert_eq!(new(&measured, Frame::RotorFlux), None);
        measured.u_s = Complex32::new(f32::INFINITY, 0.0);
        assert_eq!(new(&measured, Frame::Voltage), None);
    }

    /// The paper's sensor faults act on the signals in the frame that the sound signals have given.
    #[test]
    fn a_rehearsed_fault_multiplies_its_signal_and_no_other() {
        let sound = point(Frame::RotorFlux, 0.3);
        let gains = Rehearsal {
            voltage_gain: 1.5,
            current_q_gain: 0.5,
            speed_gain: 2.0,
        };
        let seen = sound.rehearse(&gains);
        let expected = OperatingPoint {
            u_s_dq: Dq {
                d: 1.5 * sound.u_s_dq.d,
                q: 1.5 * sound.u_s_dq.q,
            },
            i_s_dq: Dq {
                d: sound.i_s_dq.d,
                q: 0.5 * sound.i_s_dq.q,
            },
            u_amplitude: 1.5 * sound.u_amplitude,
            omega_el: 2.0 * sound.omega_el,
            ..sound
        };
        assert_eq!(seen, expected);
        assert_eq!(sound.rehearse(&Rehearsal::default()), sound);
    }
}
