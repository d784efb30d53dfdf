//! The steady operating point in d-q coordinates, in the paper's frame or in the rotor-flux frame.

use motor::TParams;
use motor::steady_state::rotor_flux;
use num_complex::Complex32;

use crate::effects::Corrected;
use crate::frames::{Dq, magnitude};

/// Where the d axis lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Frame {
    /// On the rotor flux, where (13)-(29) hold exactly.
    #[default]
    RotorFlux,
    /// 90 degrees behind the supply voltage, as the paper's zero-crossing instrument has it.
    Voltage,
}

/// Gains put on the d-q signals after the frame is known: 1 in service.
///
/// This is the paper's bench (section 7): sensor faults are switched on the d-q signals. It lets a
/// person rehearse each sensor row of Table 1 on the running motor and see its lamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rehearsal {
    /// On the voltage vector.
    pub voltage_gain: f32,
    /// On `I_q`.
    pub current_q_gain: f32,
    /// On the rotor speed.
    pub speed_gain: f32,
}

impl Default for Rehearsal {
    fn default() -> Self {
        Rehearsal {
            voltage_gain: 1.0,
            current_q_gain: 1.0,
            speed_gain: 1.0,
        }
    }
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
