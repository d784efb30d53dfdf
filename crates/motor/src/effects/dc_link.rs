//! DC link that is not what the inverter believes: `u (1 + a + b P)`, `P` the electrical power.

use crate::effect::steady::{lit, steady_effect};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint};
use num_traits::Float;

static DESCRIPTOR: Descriptor = Descriptor {
    name: "dc-link",
    form: "droop",
    kind: Kind::Physics,
    applies: Applies::Inverter,
    parameters: &[
        Parameter::size("voltage_error", "-", Scale::Own, 0.02),
        Parameter::size("droop_per_watt", "1/W", Scale::PerPower, 0.02),
    ],
    symptom: "amplitude error that changes with load",
    look_alikes: &["voltage-gain"],
    separating_test: "measure the DC link",
};

steady_effect!(DcLink, DESCRIPTOR, correct);

fn correct<F: Float>(p: &[F], point: &mut SteadyPoint<F>) {
    let power = (point.u_s * point.i_s.conj()).re * lit(1.5);
    point.u_s = point.u_s * (F::one() + p[0] + p[1] * power);
}

#[cfg(feature = "std")]
mod dynamic {
    use super::DcLink;
    use crate::dynamic::{Terminal, Winding};
    use crate::effect::{At, Effect, Hook};

    impl Effect for DcLink {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Terminal]
        }

        fn terminal(&self, p: &[f64], _at: &At<'_>, winding: &Winding, terminal: &mut Terminal) {
            let power = 1.5 * (terminal.u * winding.i_s.conj()).re;
            terminal.u *= 1.0 + p[0] + p[1] * power;
        }
    }
}
