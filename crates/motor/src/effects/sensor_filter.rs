//! The current channels are low-passed: `1/(1 + tau s)`.

use crate::effect::steady::steady_effect;
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint};
use num_complex::Complex;
use num_traits::Float;

static DESCRIPTOR: Descriptor = Descriptor {
    name: "sensor-filter",
    form: "",
    kind: Kind::Sensor,
    applies: Applies::Samples,
    parameters: &[Parameter::size(
        "filter_time_constant_s",
        "s",
        Scale::Own,
        1e-4,
    )],
    symptom: "positive-sequence current error in quadrature, transients rounded",
    look_alikes: &["sample-delay", "frame-rotation"],
    separating_test: "harmonics in the supply: a filter also weakens them",
};

steady_effect!(SensorFilter, DESCRIPTOR, correct);

fn correct<F: Float>(p: &[F], point: &mut SteadyPoint<F>) {
    point.i_s = point.i_s * Complex::new(F::one(), point.omega_sync * p[0]);
}

#[cfg(feature = "std")]
mod dynamic {
    use super::SensorFilter;
    use crate::effect::signals::low_passed;
    use crate::effect::{Effect, Hook, Outputs, Rated};

    impl Effect for SensorFilter {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Outputs]
        }

        fn outputs(&self, p: &[f64], _rated: &Rated<f64>, outputs: &mut Outputs) {
            let t_sample = outputs.t_sample;
            outputs.each_current(|_, x| low_passed(x, p[0], t_sample));
        }
    }
}
