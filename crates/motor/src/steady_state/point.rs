//! One steady operating point, in the supply's frame and in the residuals' frames.

use crate::TParams;
use num_complex::Complex;
use num_traits::Float;

/// Phasors, speeds and torque of one steady operating point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OperatingPoint<F> {
    /// Supply angular frequency, electrical rad/s.
    pub omega_sync: F,
    /// Rotor speed, electrical rad/s.
    pub omega_el: F,
    /// Slip speed `omega_sync - omega_el`, electrical rad/s.
    pub omega_slip: F,
    /// Shaft speed, mechanical rad/s.
    pub omega_mech: F,
    /// Stator voltage, V.
    pub u_s: Complex<F>,
    /// Stator current, A.
    pub i_s: Complex<F>,
    /// Rotor current referred to the stator, A.
    pub i_r: Complex<F>,
    /// Stator flux linkage, V s.
    pub psi_s: Complex<F>,
    /// Rotor flux linkage, V s.
    pub psi_r: Complex<F>,
    /// Electromagnetic torque, N m.
    pub tau_em: F,
}

/// Voltage and current in a d-q frame; q leads d by 90 degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DqPoint<F> {
    /// `V_d`, V.
    pub u_d: F,
    /// `V_q`, V.
    pub u_q: F,
    /// `I_d`, A.
    pub i_d: F,
    /// `I_q`, A.
    pub i_q: F,
}

impl<F: Float> OperatingPoint<F> {
    pub(super) fn new(
        params: &TParams<F>,
        n_p: F,
        u_s: Complex<F>,
        omega_sync: F,
        omega_slip: F,
    ) -> Self {
        let (l_s, l_r, l_m) = (params.l_s(), params.l_r(), params.l_m);
        let rotor = Complex::new(params.r_r, omega_slip * l_r);
        // The determinant written with sigma L_s, so that no leakage is lost to cancellation.
        let determinant = Complex::new(
            params.r_s * params.r_r - omega_sync * omega_slip * params.l_a() * l_r,
            omega_sync * l_s * params.r_r + omega_slip * l_r * params.r_s,
        );
        let i_s = u_s * rotor / determinant;
        let i_r = i_s * Complex::new(F::zero(), -omega_slip * l_m) / rotor;
        let psi_r = i_s * (l_m * params.r_r) / rotor;
        let psi_s = psi_r * (l_m / l_r) + i_s * params.l_a();
        OperatingPoint {
            omega_sync,
            omega_el: omega_sync - omega_slip,
            omega_slip,
            omega_mech: (omega_sync - omega_slip) / n_p,
            u_s,
            i_s,
            i_r,
            psi_s,
            psi_r,
            tau_em: one_and_a_half::<F>() * n_p * (psi_s.conj() * i_s).im,
        }
    }

    /// Voltage and current with the d axis on the rotor flux: where (13)-(29) hold exactly.
    pub fn in_rotor_flux_frame(&self) -> DqPoint<F> {
        self.in_frame_of(self.psi_r)
    }

    /// Voltage and current with the voltage on the q axis: the published instrument's frame.
    pub fn in_voltage_frame(&self) -> DqPoint<F> {
        let d_axis = self.u_s * Complex::new(F::zero(), -F::one());
        self.in_frame_of(d_axis)
    }

    fn in_frame_of(&self, d_axis: Complex<F>) -> DqPoint<F> {
        let back = d_axis.conj() / d_axis.norm();
        let (u, i) = (self.u_s * back, self.i_s * back);
        DqPoint {
            u_d: u.re,
            u_q: u.im,
            i_d: i.re,
            i_q: i.im,
        }
    }

    /// Slip `omega_slip / omega_sync`.
    pub fn slip(&self) -> F {
        self.omega_slip / self.omega_sync
    }

    /// Electrical power drawn from the supply, W.
    pub fn power_in(&self) -> F {
        one_and_a_half::<F>() * (self.u_s * self.i_s.conj()).re
    }

    /// Mechanical power of the air gap, friction included, W.
    pub fn power_mech(&self) -> F {
        self.tau_em * self.omega_mech
    }

    /// Power factor, -1..1; positive when motoring.
    pub fn power_factor(&self) -> F {
        self.power_in() / (one_and_a_half::<F>() * self.u_s.norm() * self.i_s.norm())
    }
}

/// Rotor flux linkage (V s) from terminal phasors, without integration (theory, section 5).
///
/// `u_s` (V) and `i_s` (A) are phasors in any frame that turns with the supply; `omega_sync` is the
/// electrical angular frequency in rad/s, not zero. Exact in steady state only.
pub fn rotor_flux<F: Float>(
    params: &TParams<F>,
    u_s: Complex<F>,
    i_s: Complex<F>,
    omega_sync: F,
) -> Complex<F> {
    let psi_s = (u_s - i_s * params.r_s) / Complex::new(F::zero(), omega_sync);
    (psi_s - i_s * params.l_a()) * (params.l_r() / params.l_m)
}

fn one_and_a_half<F: Float>() -> F {
    let two = F::one() + F::one();
    F::one() + F::one() / two
}
