//! State of the dynamic model, and the little vector algebra that Runge-Kutta needs.

use num_complex::Complex64;

/// States that an effect adds to the motor's own.
pub trait Extra: Copy {
    /// All extra states at rest.
    const ZERO: Self;

    /// `self + h * rate`.
    fn advanced(self, h: f64, rate: &Self) -> Self;

    /// The states.
    fn numbers(&self) -> &[f64];

    /// The states, to be set.
    fn numbers_mut(&mut self) -> &mut [f64];
}

impl Extra for () {
    const ZERO: Self = ();

    fn numbers(&self) -> &[f64] {
        &[]
    }

    fn numbers_mut(&mut self) -> &mut [f64] {
        &mut []
    }

    #[inline(always)]
    fn advanced(self, _h: f64, _rate: &Self) -> Self {}
}

impl<const N: usize> Extra for [f64; N] {
    const ZERO: Self = [0.0; N];

    fn numbers(&self) -> &[f64] {
        self
    }

    fn numbers_mut(&mut self) -> &mut [f64] {
        self
    }

    #[inline(always)]
    fn advanced(mut self, h: f64, rate: &Self) -> Self {
        for (x, dx) in self.iter_mut().zip(rate) {
            *x += h * dx;
        }
        self
    }
}

/// State of the motor, or (as the model's right-hand side) its rate of change per second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DynamicState<X = ()> {
    /// Stator flux linkage, V s, stationary frame.
    pub psi_s: Complex64,
    /// Rotor flux linkage, V s, stationary frame.
    pub psi_r: Complex64,
    /// Mechanical speed, rad/s.
    pub omega_mech: f64,
    /// Mechanical shaft angle, rad, not wrapped.
    pub theta_mech: f64,
    /// States added by effects.
    pub extra: X,
}

impl<X: Extra> DynamicState<X> {
    /// De-energised and at standstill.
    pub fn rest() -> Self {
        Self {
            psi_s: Complex64::new(0.0, 0.0),
            psi_r: Complex64::new(0.0, 0.0),
            omega_mech: 0.0,
            theta_mech: 0.0,
            extra: X::ZERO,
        }
    }

    /// `self + h * rate`.
    #[inline(always)]
    #[must_use]
    pub fn advanced(&self, h: f64, rate: &Self) -> Self {
        Self {
            psi_s: self.psi_s + rate.psi_s * h,
            psi_r: self.psi_r + rate.psi_r * h,
            omega_mech: self.omega_mech + h * rate.omega_mech,
            theta_mech: self.theta_mech + h * rate.theta_mech,
            extra: self.extra.advanced(h, &rate.extra),
        }
    }
}
