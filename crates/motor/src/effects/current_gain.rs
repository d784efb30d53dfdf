//! All current channels show `gain` times the truth.

use crate::effect::steady::steady_effect;
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint, Written};
use num_traits::Float;

static DESCRIPTOR: Descriptor = Descriptor {
    name: "current-gain",
    form: "",
    kind: Kind::Sensor,
    applies: Applies::Always,
    parameters: &[Parameter::size("current_gain", "-", Scale::Own, 0.01).written(Written::OnePlus)],
    symptom: "weak positive-sequence error everywhere",
    look_alikes: &["voltage-gain", "load-gain"],
    separating_test: "a calibrated ammeter",
};

steady_effect!(CurrentGain, DESCRIPTOR, correct);

fn correct<F: Float>(p: &[F], point: &mut SteadyPoint<F>) {
    point.i_s = point.i_s / (F::one() + p[0]);
}

#[cfg(feature = "std")]
mod dynamic {
    use super::CurrentGain;
    use crate::effect::{Effect, Hook, Outputs, Rated};

    impl Effect for CurrentGain {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Outputs]
        }

        fn outputs(&self, p: &[f64], _rated: &Rated<f64>, outputs: &mut Outputs) {
            let gain = 1.0 + p[0];
            let all = outputs.i_s_abc.iter_mut();
            all.for_each(|i| i.iter_mut().for_each(|x| *x *= gain));
        }
    }
}
