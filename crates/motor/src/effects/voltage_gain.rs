//! All voltage channels show `gain` times the truth.

use crate::effect::steady::steady_effect;
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint, Written};
use num_traits::Float;

static DESCRIPTOR: Descriptor = Descriptor {
    name: "voltage-gain",
    form: "",
    kind: Kind::Sensor,
    applies: Applies::Always,
    parameters: &[Parameter::size("voltage_gain", "-", Scale::Own, 0.01).written(Written::OnePlus)],
    symptom: "weak positive-sequence error everywhere",
    look_alikes: &["current-gain", "load-gain", "magnetizing_inductance_henry"],
    separating_test: "a calibrated voltmeter",
};

steady_effect!(VoltageGain, DESCRIPTOR, correct);

fn correct<F: Float>(p: &[F], point: &mut SteadyPoint<F>) {
    point.u_s = point.u_s / (F::one() + p[0]);
}

#[cfg(feature = "std")]
mod dynamic {
    use super::VoltageGain;
    use crate::effect::{Effect, Hook, Inputs, Rated};

    impl Effect for VoltageGain {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Inputs]
        }

        fn inputs(&self, p: &[f64], _rated: &Rated<f64>, inputs: &mut Inputs) {
            let back = 1.0 / (1.0 + p[0]);
            inputs.u_s.iter_mut().for_each(|u| *u *= back);
        }
    }
}
