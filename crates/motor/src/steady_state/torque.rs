//! Torque as a function of slip speed, in closed form.

use crate::TParams;
use core::fmt;
use num_traits::Float;

/// A torque or a load that the motor does not hold on its stable branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoOperatingPoint {
    /// The torque asked for, N m.
    pub asked_nm: f64,
    /// The largest torque the motor gives in that direction, N m.
    pub breakdown_nm: f64,
}

impl fmt::Display for NoOperatingPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:.4} N m has no steady operating point: the breakdown torque is {:.4} N m; lower the load or raise \
             the voltage",
            self.asked_nm, self.breakdown_nm
        )
    }
}

impl core::error::Error for NoOperatingPoint {}

/// `tau = k w / (a + b w + c w^2)` of the slip speed `w`; `a`, `b`, `c` follow from
/// `|(R_s + j w_s L_s)(R_r + j w L_r) + w_s w L_m^2|^2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TorqueCurve<F> {
    k: F,
    a: F,
    b: F,
    c: F,
}

impl<F: Float> TorqueCurve<F> {
    pub(super) fn new(params: &TParams<F>, n_p: F, u_squared: F, omega_sync: F) -> Self {
        let square = |x: F| x * x;
        let two = F::one() + F::one();
        let (r_s, r_r, l_m) = (params.r_s, params.r_r, params.l_m);
        let x_s = omega_sync * params.l_s();
        let x_sigma_l_r = omega_sync * params.l_a() * params.l_r();
        TorqueCurve {
            k: (F::one() + F::one() / two) * n_p * u_squared * square(l_m) * r_r,
            a: square(r_r) * (square(r_s) + square(x_s)),
            b: two * omega_sync * r_s * r_r * square(l_m),
            c: square(x_sigma_l_r) + square(params.l_r() * r_s),
        }
    }

    pub(super) fn torque(&self, slip: F) -> F {
        self.k * slip / (self.a + slip * (self.b + slip * self.c))
    }

    /// Slip speed of the motoring breakdown torque.
    pub(super) fn breakdown_slip(&self) -> F {
        (self.a / self.c).sqrt()
    }

    /// The smaller root of `c tau w^2 + (b tau - k) w + a tau = 0`, in the form without cancellation.
    pub(super) fn stable_slip(&self, tau: F) -> Result<F, NoOperatingPoint> {
        let two = F::one() + F::one();
        let linear = self.k - self.b * tau;
        let discriminant = linear * linear - two * two * self.a * self.c * tau * tau;
        // The negated form also refuses a torque that is not a number.
        if !(discriminant >= F::zero() && linear > F::zero()) {
            return Err(self.refused(tau));
        }
        Ok(two * self.a * tau / (linear + discriminant.sqrt()))
    }

    pub(super) fn refused(&self, tau: F) -> NoOperatingPoint {
        let limit = self.torque(self.breakdown_slip().copysign(tau));
        NoOperatingPoint {
            asked_nm: tau.to_f64().unwrap_or(f64::NAN),
            breakdown_nm: limit.to_f64().unwrap_or(f64::NAN),
        }
    }
}
