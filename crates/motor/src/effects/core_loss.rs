//! Core loss behind the stator resistance: `i = (i_s + g u)/(1 + g R_s)`, `g` one over the loss resistance.

use crate::effect::steady::steady_effect;
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint, Written};
use num_traits::Float;

static DESCRIPTOR: Descriptor = Descriptor {
    name: "core-loss",
    form: "",
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

steady_effect!(CoreLoss, DESCRIPTOR, correct);

fn correct<F: Float>(p: &[F], point: &mut SteadyPoint<F>) {
    let (g, r_s) = (p[0], point.motor.r_s);
    let i_loss = (point.u_s - point.i_s * r_s) * g;
    point.take_behind_stator_resistance(i_loss);
}

#[cfg(feature = "std")]
mod dynamic {
    use super::CoreLoss;
    use crate::dynamic::{Terminal, Winding};
    use crate::effect::{At, Effect, Hook, Rated};

    impl Effect for CoreLoss {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Terminal]
        }

        /// `1.5 g |u|^2` behind the stator resistance, which is negligible here.
        fn loss_watt(&self, p: &[f64], rated: &Rated<f64>) -> Option<f64> {
            Some(1.5 * p[0] * rated.voltage * rated.voltage)
        }

        fn terminal(&self, p: &[f64], _at: &At<'_>, winding: &Winding, terminal: &mut Terminal) {
            let g = p[0];
            terminal.i = (terminal.i + terminal.u * g) / (1.0 + g * winding.r_s);
        }
    }
}
