//! The speed channel ripples once per turn.

use crate::effect::steady::{steady_effect, unchanged};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "speed-ripple",
    form: "",
    kind: Kind::Sensor,
    applies: Applies::Always,
    parameters: &[
        Parameter::size("ripple_cos_rad_s", "rad/s", Scale::Own, 1.0),
        Parameter::size("ripple_sin_rad_s", "rad/s", Scale::Own, 1.0),
    ],
    symptom: "speed ripple once per turn, nothing in the current",
    look_alikes: &["load-pulsation"],
    separating_test: "look at the current sidebands: a pulsating load has them",
};

steady_effect!(SpeedRipple, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::SpeedRipple;
    use crate::effect::{Effect, Hook, Outputs, Rated};

    impl Effect for SpeedRipple {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Outputs]
        }

        fn outputs(&self, p: &[f64], _rated: &Rated<f64>, outputs: &mut Outputs) {
            for (w, theta) in outputs.omega_mech.iter_mut().zip(&outputs.theta_mech) {
                *w += p[0] * theta.cos() + p[1] * theta.sin();
            }
        }
    }
}
