//! Each current channel shows its own gain times the truth.

use crate::effect::steady::{steady_effect, unchanged};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, Written};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "phase-current-gain",
    form: "",
    kind: Kind::Sensor,
    applies: Applies::Always,
    parameters: &[
        Parameter::size("current_gain_a", "-", Scale::Own, 0.02).written(Written::OnePlus),
        Parameter::size("current_gain_b", "-", Scale::Own, 0.02).written(Written::OnePlus),
        Parameter::size("current_gain_c", "-", Scale::Own, 0.02).written(Written::OnePlus),
    ],
    symptom: "zero and negative sequence in the current error, in phase with the current",
    look_alikes: &["current-offset", "stator-asymmetry"],
    separating_test: "the sum of the phase currents names the channel",
};

steady_effect!(PhaseCurrentGain, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::PhaseCurrentGain;
    use crate::effect::{Effect, Hook, Instrument, Outputs, Rated};

    impl Effect for PhaseCurrentGain {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Outputs]
        }

        fn gain_of(&self) -> Option<Instrument> {
            Some(Instrument::Currents)
        }

        fn outputs(&self, p: &[f64], _rated: &Rated<f64>, outputs: &mut Outputs) {
            for i in &mut outputs.i_s_abc {
                i.iter_mut().zip(p).for_each(|(x, g)| *x *= 1.0 + g);
            }
        }
    }
}
