//! Windage: `k w abs(w)`.

use crate::effect::steady::steady_effect;
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint};
use num_traits::Float;

static DESCRIPTOR: Descriptor = Descriptor {
    name: "windage",
    form: "",
    kind: Kind::Physics,
    applies: Applies::Always,
    parameters: &[Parameter::positive(
        "windage_nm_s2",
        "N m s2",
        Scale::TorquePerSpeedSquared,
        0.1,
    )],
    symptom: "the coast-down is steeper at high speed than the model",
    look_alikes: &["coulomb-friction", "friction_nm_s", "core-loss"],
    separating_test: "a coast-down: without it windage hides in B",
};

steady_effect!(Windage, DESCRIPTOR, correct);

fn correct<F: Float>(p: &[F], point: &mut SteadyPoint<F>) {
    point.tau_extra = point.tau_extra + p[0] * point.omega_mech * point.omega_mech.abs();
}

#[cfg(feature = "std")]
mod dynamic {
    use super::Windage;
    use crate::dynamic::Flow;
    use crate::effect::{At, Effect, Hook, Rated, Rates};

    impl Effect for Windage {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Finish]
        }

        fn loss_watt(&self, p: &[f64], rated: &Rated<f64>) -> Option<f64> {
            Some(p[0] * rated.speed().powi(3))
        }

        fn finish(&self, p: &[f64], at: &At<'_>, flow: &Flow, rates: &mut Rates<'_>) {
            rates.omega_mech -= p[0] * at.omega_mech * at.omega_mech.abs() / flow.inertia;
        }
    }
}
