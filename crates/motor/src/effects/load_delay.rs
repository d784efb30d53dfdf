//! The torque channel is late: `T(t - d)`, a transducer behind its filter.

use crate::effect::steady::{steady_effect, unchanged};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "load-delay",
    form: "",
    kind: Kind::Sensor,
    applies: Applies::Samples,
    parameters: &[Parameter::size("delay_s", "s", Scale::Own, 2e-3)],
    symptom: "current and speed errors in load steps, none in steady running",
    look_alikes: &["inertia_kg_m2", "shaft-compliance"],
    separating_test: "a load step with the current as reference",
};

steady_effect!(LoadDelay, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::LoadDelay;
    use crate::effect::signals::delayed;
    use crate::effect::{Effect, Hook, Inputs, Instrument, Rated};

    impl Effect for LoadDelay {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Inputs]
        }

        fn lag_of(&self) -> Option<Instrument> {
            Some(Instrument::Torque)
        }

        fn shown_inputs(&self, p: &[f64], _rated: &Rated<f64>, inputs: &mut Inputs) -> bool {
            inputs.tau_load = delayed(&inputs.tau_load, p[0] / inputs.t_sample);
            true
        }

        fn inputs(&self, p: &[f64], _rated: &Rated<f64>, inputs: &mut Inputs) {
            inputs.tau_load = delayed(&inputs.tau_load, -p[0] / inputs.t_sample);
        }
    }
}
