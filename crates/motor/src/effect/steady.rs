//! Effects in steady state: what the lamps need, without allocation and in single precision.

use crate::TParams;
use crate::effect::{Descriptor, Rated};
use num_complex::Complex;
use num_traits::Float;

/// One steady operating point, as a measuring window delivers it.
///
/// Phasors are space vectors of the positive sequence, amplitude-invariant, in any common frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteadyPoint<F> {
    /// Rated quantities of the machine.
    pub rated: Rated<F>,
    /// Supply frequency, rad/s, not zero.
    pub omega_sync: F,
    /// Mechanical speed, rad/s.
    pub omega_mech: F,
    /// Stator voltage, V peak.
    pub u_s: Complex<F>,
    /// Stator current, A peak.
    pub i_s: Complex<F>,
    /// Parameters at this operating point.
    pub motor: TParams<F>,
    /// Torque that the effects take from the shaft beside viscous friction, N m.
    pub tau_extra: F,
}

impl<F: Float> SteadyPoint<F> {
    /// Slip, 1 at standstill.
    pub fn slip(&self) -> F {
        (self.omega_sync - self.rated.n_p * self.omega_mech) / self.omega_sync
    }

    /// Takes a current (A) away that leaves behind the stator resistance: its drop there is no part of the
    /// winding's either.
    pub(crate) fn take_behind_stator_resistance(&mut self, i: Complex<F>) {
        self.i_s = self.i_s - i;
        self.u_s = self.u_s - i * self.motor.r_s;
    }

    /// Air-gap flux linkage seen from the terminals, V s peak.
    pub fn air_gap_flux(&self) -> Complex<F> {
        let e = self.u_s - self.i_s * self.motor.r_s;
        let minus_j = Complex::new(F::zero(), -F::one());
        e * minus_j / self.omega_sync - self.i_s * self.motor.l_ls
    }
}

/// Most parameters that an effect has: the room for each in flash.
pub const MAX_PARAMETERS: usize = 4;

/// An effect in steady state.
pub trait SteadyEffect: Sync {
    /// What is known about it.
    fn descriptor(&self) -> &'static Descriptor;

    /// Turns what was measured into what the model without this effect would have measured: moves `u_s`, `i_s`
    /// and `omega_mech` behind the effect, or changes the parameters that hold at this point.
    ///
    /// Parameters that the effect does not have are not looked at. The length is fixed so that the board's program
    /// holds no check of it.
    fn correct_f32(&self, p: &[f32; MAX_PARAMETERS], point: &mut SteadyPoint<f32>);

    /// As [`SteadyEffect::correct_f32`], in double precision, which the board does not have.
    #[cfg(feature = "std")]
    fn correct_f64(&self, p: &[f64], point: &mut SteadyPoint<f64>);
}

/// Implements [`SteadyEffect`] from one generic function.
macro_rules! steady_effect {
    ($effect:ident, $descriptor:ident, $correct:ident) => {
        #[doc = "The effect of this file."]
        #[derive(Clone, Copy, Debug)]
        pub struct $effect;

        impl $crate::effect::SteadyEffect for $effect {
            fn descriptor(&self) -> &'static $crate::effect::Descriptor {
                &$descriptor
            }

            fn correct_f32(
                &self,
                p: &[f32; $crate::effect::MAX_PARAMETERS],
                point: &mut $crate::effect::SteadyPoint<f32>,
            ) {
                $correct(p, point);
            }

            #[cfg(feature = "std")]
            fn correct_f64(&self, p: &[f64], point: &mut $crate::effect::SteadyPoint<f64>) {
                $correct(p, point);
            }
        }
    };
}
pub(crate) use steady_effect;

/// Functions of steady terms beyond `+ - * /` and the square root. In single precision none of them goes through double
/// precision, which is a thousand instructions on the board, and all give the same bits on a host.
pub(crate) trait Real: Float {
    /// `self^n`.
    fn power(self, n: Self) -> Self;

    /// Hyperbolic tangent.
    fn tangent(self) -> Self;

    /// `e^(j self)` of an angle in rad, at most pi.
    fn turn(self) -> Complex<Self>;
}

impl Real for f32 {
    fn power(self, n: f32) -> f32 {
        libm::powf(self, n)
    }

    fn tangent(self) -> f32 {
        libm::tanhf(self)
    }

    /// By the Taylor series of a quarter of the angle, squared twice: at most 1e-6 off.
    fn turn(self) -> Complex<f32> {
        let x = 0.25 * self;
        let x2 = x * x;
        let cos = 1.0 - x2 / 2.0 * (1.0 - x2 / 12.0 * (1.0 - x2 / 30.0 * (1.0 - x2 / 56.0)));
        let sin = x * (1.0 - x2 / 6.0 * (1.0 - x2 / 20.0 * (1.0 - x2 / 42.0 * (1.0 - x2 / 72.0))));
        let quarter = Complex::new(cos, sin);
        let half = quarter * quarter;
        half * half
    }
}

#[cfg(feature = "std")]
impl Real for f64 {
    fn power(self, n: f64) -> f64 {
        self.powf(n)
    }

    fn tangent(self) -> f64 {
        self.tanh()
    }

    fn turn(self) -> Complex<f64> {
        Complex::from_polar(1.0, self)
    }
}

/// Length of a phasor; `Complex::norm` goes through `hypot`, which on the board is double precision.
pub(crate) fn length<F: Float>(x: Complex<F>) -> F {
    x.norm_sqr().sqrt()
}

/// A constant of the formulas in the precision of the caller.
pub(crate) fn lit<F: Float>(x: f64) -> F {
    F::from(x).unwrap_or_else(F::nan)
}

/// The effect leaves the fundamental in steady state as it is.
pub(crate) fn unchanged<F: Float>(_p: &[F], _point: &mut SteadyPoint<F>) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_turn_in_single_precision_is_within_1e_6() {
        for k in -3_141..=3_141 {
            let x = k as f32 * 1e-3;
            let (narrow, wide) = (x.turn(), f64::from(x).turn());
            let error = (f64::from(narrow.re) - wide.re).hypot(f64::from(narrow.im) - wide.im);
            assert!(error < 1e-6, "{x}: {error:e}");
        }
    }
}
