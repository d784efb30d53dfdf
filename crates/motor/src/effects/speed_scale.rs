//! The speed channel shows `scale` times the truth.

use crate::effect::steady::steady_effect;
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint, Written};
use num_traits::Float;

static DESCRIPTOR: Descriptor = Descriptor {
    name: "speed-scale",
    form: "",
    kind: Kind::Sensor,
    applies: Applies::Always,
    parameters: &[Parameter::size("speed_scale", "-", Scale::Own, 0.005).written(Written::OnePlus)],
    symptom: "speed error proportional to the speed, none in the current",
    look_alikes: &["rotor_resistance_ohm"],
    separating_test: "a stroboscope at no load",
};

steady_effect!(SpeedScale, DESCRIPTOR, correct);

fn correct<F: Float>(p: &[F], point: &mut SteadyPoint<F>) {
    point.omega_mech = point.omega_mech / (F::one() + p[0]);
}

#[cfg(feature = "std")]
mod dynamic {
    use super::SpeedScale;
    use crate::effect::{Effect, Hook, Instrument, Outputs, Rated};

    impl Effect for SpeedScale {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Outputs]
        }

        fn gain_of(&self) -> Option<Instrument> {
            Some(Instrument::Speed)
        }

        fn outputs(&self, p: &[f64], _rated: &Rated<f64>, outputs: &mut Outputs) {
            outputs.omega_mech.iter_mut().for_each(|w| *w *= 1.0 + p[0]);
        }
    }
}
