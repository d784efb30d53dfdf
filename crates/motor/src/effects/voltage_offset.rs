//! Each voltage channel is shifted by a constant.

use crate::effect::steady::{steady_effect, unchanged};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "voltage-offset",
    form: "",
    kind: Kind::Sensor,
    applies: Applies::Always,
    parameters: &[
        Parameter::size("voltage_offset_a_volt", "V", Scale::Voltage, 0.005),
        Parameter::size("voltage_offset_b_volt", "V", Scale::Voltage, 0.005),
        Parameter::size("voltage_offset_c_volt", "V", Scale::Voltage, 0.005),
    ],
    symptom: "a constant in the current error",
    look_alikes: &["current-offset"],
    separating_test: "a segment before the start",
};

steady_effect!(VoltageOffset, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::VoltageOffset;
    use crate::dynamic::clarke;
    use crate::effect::{Effect, Hook, Inputs, Instrument, Outputs, Rated};

    impl Effect for VoltageOffset {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Inputs, Hook::Outputs]
        }

        fn inputs(&self, p: &[f64], _rated: &Rated<f64>, inputs: &mut Inputs) {
            let offset = clarke([p[0], p[1], p[2]]);
            inputs.u_s.iter_mut().for_each(|u| *u -= offset);
        }

        fn offset_of(&self) -> Option<Instrument> {
            Some(Instrument::Voltages)
        }

        fn outputs(&self, p: &[f64], _rated: &Rated<f64>, outputs: &mut Outputs) {
            let zero = (p[0] + p[1] + p[2]) / 3.0;
            outputs.u_zero.iter_mut().for_each(|u| *u += zero);
        }
    }
}
