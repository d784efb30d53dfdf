//! Skin effect in the rotor bars: `R_r (1 + k_R abs(s)^n)`, `L_lr (1 - k_L abs(s)^n)`.

use crate::effect::steady::{Real, lit, steady_effect};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint};
use crate::TParams;

static DESCRIPTOR: Descriptor = Descriptor {
    name: "deep-bar",
    form: "slip",
    kind: Kind::Physics,
    applies: Applies::Samples,
    parameters: &[
        Parameter::size("resistance_rise", "-", Scale::Own, 0.5),
        Parameter::size("leakage_drop", "-", Scale::Own, 0.2),
        Parameter::shape(
            "slip_exponent",
            "-",
            Scale::Own,
            [0.3, 3.0],
            1.0,
            &[0.5, 1.0, 2.0],
        ),
    ],
    symptom: "start and locked rotor differ from the model, running does not",
    look_alikes: &["leakage-saturation", "rotor-heating"],
    separating_test: "locked rotor at two frequencies",
};

steady_effect!(DeepBar, DESCRIPTOR, correct);

#[inline(always)]
fn apply<F: Real>(p: &[F], slip: F, motor: &mut TParams<F>) {
    // Skin depth saturates beyond supply frequency (plugging).
    let f = slip.abs().min(lit(2.0)).power(p[2]);
    motor.r_r = motor.r_r * (F::one() + p[0] * f).max(lit(0.05));
    motor.l_lr = motor.l_lr * (F::one() - p[1] * f).max(lit(0.05));
}

fn correct<F: Real>(p: &[F], point: &mut SteadyPoint<F>) {
    apply(p, point.slip(), &mut point.motor);
}

#[cfg(feature = "std")]
mod dynamic {
    use super::{DeepBar, apply};
    use crate::effect::{At, Effect, Hook, Instantaneous};
    use num_complex::Complex64;

    impl Effect for DeepBar {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Parameters]
        }

        fn parameters(&self, p: &[f64], at: &At<'_>, _i_s: Complex64, now: &mut Instantaneous) {
            apply(p, at.slip(), &mut now.motor);
        }
    }
}
