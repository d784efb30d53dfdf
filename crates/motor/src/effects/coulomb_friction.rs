//! Coulomb friction: `T_c sgn(w)`, smoothed over 0.5 % of synchronous speed.

use crate::effect::steady::{Real, lit, steady_effect};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Rated, Scale, SteadyPoint};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "coulomb-friction",
    form: "",
    kind: Kind::Physics,
    applies: Applies::Always,
    parameters: &[Parameter::positive(
        "coulomb_torque_nm",
        "N m",
        Scale::Torque,
        0.05,
    )],
    symptom: "the coast-down ends sooner and straighter than the model",
    look_alikes: &["windage", "friction_nm_s", "core-loss"],
    separating_test: "a coast-down: without it Coulomb friction hides in B",
};

steady_effect!(CoulombFriction, DESCRIPTOR, correct);

#[inline(always)]
fn torque<F: Real>(p: &[F], rated: &Rated<F>, omega_mech: F) -> F {
    p[0] * (omega_mech / (rated.speed() * lit(0.005))).tangent()
}

fn correct<F: Real>(p: &[F], point: &mut SteadyPoint<F>) {
    point.tau_extra = point.tau_extra + torque(p, &point.rated, point.omega_mech);
}

#[cfg(feature = "std")]
mod dynamic {
    use super::{CoulombFriction, torque};
    use crate::dynamic::Flow;
    use crate::effect::{At, Effect, Hook, Rated, Rates};

    impl Effect for CoulombFriction {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Finish]
        }

        fn loss_watt(&self, p: &[f64], rated: &Rated<f64>) -> Option<f64> {
            Some(p[0] * rated.speed())
        }

        fn finish(&self, p: &[f64], at: &At<'_>, flow: &Flow, rates: &mut Rates<'_>) {
            rates.omega_mech -= torque(p, at.rated, at.omega_mech) / flow.inertia;
        }
    }
}
