//! The T model in steady state on a balanced sinusoidal supply.
//!
//! Phasors are amplitude-invariant space vectors in the frame that turns with the supply, so that a
//! phasor's magnitude is a phase amplitude. Rotor quantities are referred to the stator. With the slip
//! speed `w_sl = w_s - w_r` (electrical rad/s):
//!
//! ```text
//! u_s   = R_s i_s + j w_s psi_s                    psi_s = L_s i_s + L_m i_r
//! 0     = R_r i_r + j w_sl psi_r                   psi_r = L_m i_s + L_r i_r
//! tau   = (3/2) n_p Im(conj(psi_s) i_s)
//! ```

mod point;
mod torque;

#[cfg(test)]
pub(crate) mod tests;

pub use point::{DqPoint, OperatingPoint, rotor_flux};
pub use torque::NoOperatingPoint;

use crate::TParams;
use num_complex::Complex;
use num_traits::Float;
use torque::TorqueCurve;

/// A motor on a stiff supply, ready to be asked for operating points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteadyState<F> {
    params: TParams<F>,
    n_p: F,
    u_s: Complex<F>,
    omega_sync: F,
    curve: TorqueCurve<F>,
}

impl<F: Float> SteadyState<F> {
    /// A motor with `n_p` pole pairs on phase voltage `u_s` (V, amplitude) at `omega_sync` (electrical
    /// rad/s, > 0).
    pub fn new(params: &TParams<F>, n_p: F, u_s: Complex<F>, omega_sync: F) -> Self {
        SteadyState {
            params: *params,
            n_p,
            u_s,
            omega_sync,
            curve: TorqueCurve::new(params, n_p, u_s.norm_sqr(), omega_sync),
        }
    }

    /// The operating point at slip speed `omega_slip = w_s - w_r`, electrical rad/s.
    pub fn at_slip_speed(&self, omega_slip: F) -> OperatingPoint<F> {
        OperatingPoint::new(
            &self.params,
            self.n_p,
            self.u_s,
            self.omega_sync,
            omega_slip,
        )
    }

    /// The operating point at a shaft speed, mechanical rad/s.
    pub fn at_speed(&self, omega_mech: F) -> OperatingPoint<F> {
        self.at_slip_speed(self.omega_sync - self.n_p * omega_mech)
    }

    /// The operating point on the stable branch at an electromagnetic torque `tau_em`, N m; negative
    /// torque generates. Closed form: the torque curve is a quadratic in the slip speed.
    ///
    /// # Errors
    /// A torque beyond the breakdown torque (motoring or generating), which is then named.
    pub fn at_torque(&self, tau_em: F) -> Result<OperatingPoint<F>, NoOperatingPoint> {
        let slip = self.curve.stable_slip(tau_em)?;
        Ok(self.at_slip_speed(slip))
    }

    /// The operating point at which torque and viscous friction `b_t = B + B_l` (N m s, >= 0) balance.
    ///
    /// One exists for every friction. Friction above what the breakdown torque carries is met beyond
    /// breakdown, where a motor that starts against such a load stays.
    pub fn at_friction(&self, b_t: F) -> OperatingPoint<F> {
        let load = |omega_mech: F| b_t * omega_mech;
        let last = self.curve.breakdown_slip().min(self.omega_sync);
        let slip = match self.balance(F::zero(), last, load) {
            Some(slip) => slip,
            None => self
                .balance(last, self.omega_sync, load)
                .unwrap_or(self.omega_sync),
        };
        self.at_slip_speed(slip)
    }

    /// The operating point on the stable branch at which the torque equals `load(omega_mech)`, N m, all frictions
    /// included; the load must not fall as speed rises. A load that drives the shaft at synchronous speed is met above
    /// it, where the motor generates.
    ///
    /// # Errors
    /// A load beyond the breakdown torque of its direction, which is then named.
    pub fn at_load(&self, load: impl Fn(F) -> F) -> Result<OperatingPoint<F>, NoOperatingPoint> {
        let breakdown = self.curve.breakdown_slip();
        let drives = load(self.mech_speed(F::zero())) < F::zero();
        let last = if drives {
            -breakdown
        } else {
            breakdown.min(self.omega_sync)
        };
        match self.balance(last.min(F::zero()), last.max(F::zero()), &load) {
            Some(slip) => Ok(self.at_slip_speed(slip)),
            None => Err(self.curve.refused(load(self.mech_speed(last)))),
        }
    }

    /// Largest motoring torque (N m) and the slip speed (electrical rad/s) at which it is reached.
    pub fn breakdown(&self) -> (F, F) {
        let slip = self.curve.breakdown_slip();
        (self.curve.torque(slip), slip)
    }

    fn mech_speed(&self, slip: F) -> F {
        (self.omega_sync - slip) / self.n_p
    }

    /// Slip speed in `[low, high]` at which motor and load balance, by bisection to the last digit;
    /// `None` when the sign of the excess torque does not change there.
    fn balance(&self, low: F, high: F, load: impl Fn(F) -> F) -> Option<F> {
        let excess = |slip: F| self.curve.torque(slip) - load(self.mech_speed(slip));
        if excess(low) > F::zero() || excess(high) < F::zero() {
            return None;
        }
        let (mut low, mut high) = (low, high);
        let two = F::one() + F::one();
        loop {
            let middle = low + (high - low) / two;
            if middle <= low || middle >= high {
                return Some(middle);
            }
            if excess(middle) < F::zero() {
                low = middle;
            } else {
                high = middle;
            }
        }
    }
}
