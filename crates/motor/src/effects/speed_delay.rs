//! The speed channel is late: `w(t - d)`.

use crate::effect::steady::{steady_effect, unchanged};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "speed-delay",
    form: "",
    kind: Kind::Sensor,
    applies: Applies::Always,
    parameters: &[Parameter::size("delay_s", "s", Scale::Own, 2e-3)],
    symptom: "the speed lags in ramps",
    look_alikes: &["inertia_kg_m2"],
    separating_test: "a fast ramp with the current as reference",
};

steady_effect!(SpeedDelay, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::SpeedDelay;
    use crate::effect::signals::delayed;
    use crate::effect::{Effect, Hook, Instrument, Outputs, Rated};

    impl Effect for SpeedDelay {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Outputs]
        }

        fn lag_of(&self) -> Option<Instrument> {
            Some(Instrument::Speed)
        }

        fn outputs(&self, p: &[f64], _rated: &Rated<f64>, outputs: &mut Outputs) {
            outputs.omega_mech = delayed(&outputs.omega_mech, p[0] / outputs.t_sample);
        }

        fn shaft_speed(&self, p: &[f64], t_sample: f64, shown: &[f64]) -> Option<Vec<f64>> {
            Some(delayed(shown, -p[0] / t_sample))
        }
    }
}
