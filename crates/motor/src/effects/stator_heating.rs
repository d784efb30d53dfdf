//! Heating of the stator: `R (1 + D(1 - e^(-t/tau)))`, `t` from the start of the recording.

use crate::effect::steady::steady_effect;
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint};
use num_traits::Float;

static DESCRIPTOR: Descriptor = Descriptor {
    name: "stator-heating",
    form: "",
    kind: Kind::Physics,
    applies: Applies::Samples,
    parameters: &[
        Parameter::size("resistance_rise", "-", Scale::Own, 0.2),
        Parameter::shape(
            "time_constant_s",
            "s",
            Scale::Own,
            [0.2, 1000.0],
            5.0,
            &[1.0, 5.0, 50.0],
        ),
    ],
    symptom: "slow drift of the current",
    look_alikes: &["stator_resistance_ohm", "voltage-gain"],
    separating_test: "a longer run at constant load",
};

steady_effect!(StatorHeating, DESCRIPTOR, correct);

fn correct<F: Float>(p: &[F], point: &mut SteadyPoint<F>) {
    // A lamp is judged long after the start: the rise is complete.
    point.motor.r_s = point.motor.r_s * (F::one() + p[0]);
}

#[cfg(feature = "std")]
mod dynamic {
    use super::StatorHeating;
    use crate::effect::{At, Effect, Hook, Instantaneous};
    use num_complex::Complex64;

    impl Effect for StatorHeating {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Parameters]
        }

        fn parameters(&self, p: &[f64], at: &At<'_>, _i_s: Complex64, now: &mut Instantaneous) {
            now.motor.r_s *= 1.0 - p[0] * (-at.t / p[1]).exp_m1();
        }
    }
}
