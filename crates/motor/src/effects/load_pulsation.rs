//! Torque that pulsates once per turn: `a cos(theta) + b sin(theta)`.

use crate::effect::steady::{steady_effect, unchanged};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "load-pulsation",
    form: "",
    kind: Kind::Physics,
    applies: Applies::Always,
    parameters: &[
        Parameter::size("pulsation_cos_nm", "N m", Scale::Torque, 0.05),
        Parameter::size("pulsation_sin_nm", "N m", Scale::Torque, 0.05),
    ],
    symptom: "speed ripple once per turn AND current sidebands at the shaft frequency around the supply frequency",
    look_alikes: &["speed-ripple"],
    separating_test: "look at the current sidebands: a sensor ripple has none",
};

steady_effect!(LoadPulsation, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::LoadPulsation;
    use crate::dynamic::Flow;
    use crate::effect::{At, Effect, Hook, Rates};

    impl Effect for LoadPulsation {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Finish]
        }

        fn finish(&self, p: &[f64], at: &At<'_>, flow: &Flow, rates: &mut Rates<'_>) {
            let (sin, cos) = at.theta_mech.sin_cos();
            rates.omega_mech -= (p[0] * cos + p[1] * sin) / flow.inertia;
        }
    }
}
