//! Broken rotor bar: rotor voltage drop `R_r (i_r + k e^(j 2 theta_el) conj(i_r))`.

use crate::effect::steady::{steady_effect, unchanged};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "rotor-asymmetry",
    form: "",
    kind: Kind::Physics,
    applies: Applies::Always,
    parameters: &[
        Parameter::size("asymmetry_re", "-", Scale::Own, 0.05),
        Parameter::size("asymmetry_im", "-", Scale::Own, 0.05),
    ],
    symptom: "current sidebands at f (1 +- 2 s) that grow with load",
    look_alikes: &["load-pulsation"],
    separating_test: "a second load: the sidebands move with slip",
};

steady_effect!(RotorAsymmetry, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::RotorAsymmetry;
    use crate::dynamic::Flow;
    use crate::effect::{At, Effect, Hook, Rates, Side};
    use num_complex::Complex64;

    impl Effect for RotorAsymmetry {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Finish]
        }

        fn asymmetry_of(&self) -> Option<Side> {
            Some(Side::Rotor)
        }

        fn finish(&self, p: &[f64], at: &At<'_>, flow: &Flow, rates: &mut Rates<'_>) {
            let turn = Complex64::from_polar(flow.winding.r_r, 2.0 * flow.n_p * at.theta_mech);
            rates.psi_r -= Complex64::new(p[0], p[1]) * turn * flow.winding.i_r.conj();
        }
    }
}
