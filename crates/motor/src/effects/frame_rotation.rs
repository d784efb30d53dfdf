//! The voltages are turned against the currents: `u e^(j delta)`.

use crate::effect::steady::{Real, steady_effect};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "frame-rotation",
    form: "",
    kind: Kind::Sensor,
    applies: Applies::Samples,
    parameters: &[Parameter::size("rotation_rad", "rad", Scale::Own, 0.03)],
    symptom: "positive-sequence current error in quadrature",
    look_alikes: &["sample-delay", "sensor-filter"],
    separating_test: "harmonics in the supply: a rotation turns all orders alike",
};

steady_effect!(FrameRotation, DESCRIPTOR, correct);

fn correct<F: Real>(p: &[F], point: &mut SteadyPoint<F>) {
    point.u_s = point.u_s * p[0].turn();
}

#[cfg(feature = "std")]
mod dynamic {
    use super::FrameRotation;
    use crate::effect::{Effect, Hook, Inputs, Rated};
    use num_complex::Complex64;

    impl Effect for FrameRotation {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Inputs]
        }

        fn inputs(&self, p: &[f64], _rated: &Rated<f64>, inputs: &mut Inputs) {
            let turn = Complex64::from_polar(1.0, p[0]);
            inputs.u_s.iter_mut().for_each(|u| *u *= turn);
        }
    }
}
