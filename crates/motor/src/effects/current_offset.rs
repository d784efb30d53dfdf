//! Each current channel is shifted by a constant.

use crate::effect::steady::{steady_effect, unchanged};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "current-offset",
    form: "",
    kind: Kind::Sensor,
    applies: Applies::Always,
    parameters: &[
        Parameter::size("current_offset_a_amp", "A", Scale::Current, 0.02),
        Parameter::size("current_offset_b_amp", "A", Scale::Current, 0.02),
        Parameter::size("current_offset_c_amp", "A", Scale::Current, 0.02),
    ],
    symptom: "a constant in the current error",
    look_alikes: &["voltage-offset"],
    separating_test: "a segment before the start",
};

steady_effect!(CurrentOffset, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::CurrentOffset;
    use crate::effect::{Effect, Hook, Instrument, Outputs, Rated};

    impl Effect for CurrentOffset {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Outputs]
        }

        fn offset_of(&self) -> Option<Instrument> {
            Some(Instrument::Currents)
        }

        fn outputs(&self, p: &[f64], _rated: &Rated<f64>, outputs: &mut Outputs) {
            for i in &mut outputs.i_s_abc {
                i.iter_mut().zip(p).for_each(|(x, offset)| *x += offset);
            }
        }
    }
}
