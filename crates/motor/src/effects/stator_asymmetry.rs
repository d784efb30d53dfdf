//! Series resistance or shorted turns in one phase: voltage drop `R_s (i + k conj(i))`.

use crate::effect::steady::{steady_effect, unchanged};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "stator-asymmetry",
    form: "",
    kind: Kind::Physics,
    applies: Applies::Always,
    parameters: &[
        Parameter::size("asymmetry_re", "-", Scale::Own, 0.1),
        Parameter::size("asymmetry_im", "-", Scale::Own, 0.1),
    ],
    symptom: "negative-sequence current proportional to the current; its angle names the phase",
    look_alikes: &["voltage-asymmetry", "phase-voltage-gain"],
    separating_test: "a second load",
};

steady_effect!(StatorAsymmetry, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::StatorAsymmetry;
    use crate::dynamic::{Terminal, Winding};
    use crate::effect::{At, Effect, Hook, Side};
    use num_complex::Complex64;

    impl Effect for StatorAsymmetry {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Terminal]
        }

        fn asymmetry_of(&self) -> Option<Side> {
            Some(Side::Stator)
        }

        fn terminal(&self, p: &[f64], _at: &At<'_>, winding: &Winding, terminal: &mut Terminal) {
            let k = Complex64::new(p[0], p[1]) * winding.r_s;
            terminal.u -= k * terminal.i.conj();
        }
    }
}
