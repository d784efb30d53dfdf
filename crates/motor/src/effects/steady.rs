//! Effects in steady state: what the lamps need, without allocation and in single precision.

use super::{Descriptor, Rated};
use crate::TParams;
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

/// An effect in steady state.
pub trait SteadyEffect: Sync {
    /// What is known about it.
    fn descriptor(&self) -> &'static Descriptor;

    /// Turns what was measured into what the model without this effect would have measured: moves `u_s`, `i_s`
    /// and `omega_mech` behind the effect, or changes the parameters that hold at this point.
    fn correct_f32(&self, p: &[f32], point: &mut SteadyPoint<f32>);

    /// As [`SteadyEffect::correct_f32`], in double precision.
    fn correct_f64(&self, p: &[f64], point: &mut SteadyPoint<f64>);
}

/// Implements [`SteadyEffect`] from one generic function.
macro_rules! steady_effect {
    ($effect:ident, $descriptor:ident, $correct:ident) => {
        impl $crate::effects::SteadyEffect for $effect {
            fn descriptor(&self) -> &'static $crate::effects::Descriptor {
                &$descriptor
            }

            fn correct_f32(&self, p: &[f32], point: &mut $crate::effects::SteadyPoint<f32>) {
                $correct(p, point);
            }

            fn correct_f64(&self, p: &[f64], point: &mut $crate::effects::SteadyPoint<f64>) {
                $correct(p, point);
            }
        }
    };
}
pub(crate) use steady_effect;

/// A constant of the formulas in the precision of the caller.
pub(crate) fn lit<F: Float>(x: f64) -> F {
    F::from(x).unwrap_or_else(F::nan)
}

/// The effect leaves the fundamental in steady state as it is.
pub(crate) fn unchanged<F: Float>(_p: &[F], _point: &mut SteadyPoint<F>) {}
