//! Inductance of an output filter or cable between the voltage and the motor.

use crate::effect::steady::steady_effect;
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint};
use num_traits::Float;

static DESCRIPTOR: Descriptor = Descriptor {
    name: "series-inductance",
    form: "",
    kind: Kind::Physics,
    applies: Applies::Samples,
    parameters: &[Parameter::positive(
        "series_inductance_henry",
        "H",
        Scale::Inductance,
        0.02,
    )],
    symptom: "leakage seems larger than it is",
    look_alikes: &["stator_leakage_henry"],
    separating_test: "two operating frequencies, or a known filter: from the terminals it is leakage",
};

steady_effect!(SeriesInductance, DESCRIPTOR, correct);

fn correct<F: Float>(p: &[F], point: &mut SteadyPoint<F>) {
    point.motor.l_ls = point.motor.l_ls + p[0];
}

#[cfg(feature = "std")]
mod dynamic {
    use super::SeriesInductance;
    use crate::TParams;
    use crate::effect::{Effect, Hook, Nominal, Rated};

    impl Effect for SeriesInductance {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Motor]
        }

        fn is_taken_for(&self, nominal: Nominal) -> bool {
            matches!(nominal, Nominal::Leakage | Nominal::Friction)
        }

        fn motor(&self, p: &[f64], _rated: &Rated<f64>, motor: &mut TParams<f64>) {
            motor.l_ls += p[0];
        }
    }
}
