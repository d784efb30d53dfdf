//! The motor sees a negative sequence that was not measured: `u + k conj(u)`.

use crate::effect::steady::{steady_effect, unchanged};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "voltage-asymmetry",
    form: "",
    kind: Kind::Supply,
    applies: Applies::Always,
    parameters: &[
        Parameter::size("asymmetry_re", "-", Scale::Own, 0.02),
        Parameter::size("asymmetry_im", "-", Scale::Own, 0.02),
    ],
    symptom: "negative-sequence current that does not depend on the load",
    look_alikes: &["stator-asymmetry", "phase-voltage-gain"],
    separating_test: "a second load",
};

steady_effect!(VoltageAsymmetry, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::VoltageAsymmetry;
    use crate::effect::{Effect, Hook, Inputs, Instrument, Rated};
    use num_complex::Complex64;

    impl Effect for VoltageAsymmetry {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Inputs]
        }

        fn hides_gain_of(&self) -> Option<Instrument> {
            Some(Instrument::Voltages)
        }

        fn inputs(&self, p: &[f64], _rated: &Rated<f64>, inputs: &mut Inputs) {
            let k = Complex64::new(p[0], p[1]);
            inputs.u_s.iter_mut().for_each(|u| *u += k * u.conj());
        }
    }
}
