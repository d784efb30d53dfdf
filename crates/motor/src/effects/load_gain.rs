//! The torque channel shows `gain` times the truth.

use crate::effect::steady::{steady_effect, unchanged};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, Written};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "load-gain",
    form: "",
    kind: Kind::Sensor,
    applies: Applies::Always,
    parameters: &[Parameter::size("load_gain", "-", Scale::Own, 0.02).written(Written::OnePlus)],
    symptom: "speed and current errors proportional to the load",
    look_alikes: &["voltage-gain", "current-gain", "rotor_resistance_ohm"],
    separating_test: "a calibrated torque sensor",
};

steady_effect!(LoadGain, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::LoadGain;
    use crate::effect::{Effect, Hook, Inputs, Instrument, Rated};

    impl Effect for LoadGain {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Inputs]
        }

        fn gain_of(&self) -> Option<Instrument> {
            Some(Instrument::Torque)
        }

        fn inputs(&self, p: &[f64], _rated: &Rated<f64>, inputs: &mut Inputs) {
            let back = 1.0 / (1.0 + p[0]);
            inputs.tau_load.iter_mut().for_each(|tau| *tau *= back);
        }
    }
}
