//! Core loss at the air gap: `i = i_s + g j w_sync psi_m`, `g` one over the loss resistance.

use crate::effect::steady::steady_effect;
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint, Written};
use num_complex::Complex;
use num_traits::Float;

static DESCRIPTOR: Descriptor = Descriptor {
    name: "core-loss",
    form: "air-gap",
    kind: Kind::Physics,
    applies: Applies::Always,
    parameters: &[
        Parameter::positive("core_loss_resistance_ohm", "ohm", Scale::Conductance, 0.02)
            .written(Written::Reciprocal),
    ],
    symptom: "a small current in phase with the voltage; losses at no load",
    look_alikes: &["windage", "coulomb-friction", "stator_resistance_ohm"],
    separating_test: "a no-load voltage sweep together with a coast-down; one voltage and frequency cannot tell it from friction",
};

steady_effect!(CoreLossAirGap, DESCRIPTOR, correct);

fn correct<F: Float>(p: &[F], point: &mut SteadyPoint<F>) {
    let j_omega = Complex::new(F::zero(), point.omega_sync);
    // The leakage carries the winding's current alone: e (1 - j w L_ls g) = e as if it carried all of it.
    let share = Complex::new(F::one(), F::zero()) - j_omega * (point.motor.l_ls * p[0]);
    let e = point.air_gap_flux() * j_omega / share;
    point.take_behind_stator_resistance(e * p[0]);
}

#[cfg(feature = "std")]
mod dynamic {
    use super::CoreLossAirGap;
    use crate::dynamic::{Terminal, Winding};
    use crate::effect::{At, Effect, Hook};
    use num_complex::Complex64;

    impl Effect for CoreLossAirGap {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Terminal]
        }

        fn terminal(&self, p: &[f64], at: &At<'_>, winding: &Winding, terminal: &mut Terminal) {
            let psi_m = at.psi_s - winding.i_s * at.motor.l_ls;
            terminal.i += psi_m * Complex64::new(0.0, p[0] * at.omega_sync);
        }
    }
}
