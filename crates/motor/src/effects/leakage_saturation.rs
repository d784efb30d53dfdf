//! Leakage saturation: both leakages times `1 - k x^2/(1 + x^2)`, `x = abs(i_s)/i_ref`.

use crate::effect::steady::{lit, steady_effect};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint};
use num_traits::Float;

static DESCRIPTOR: Descriptor = Descriptor {
    name: "leakage-saturation",
    form: "",
    kind: Kind::Physics,
    applies: Applies::Samples,
    parameters: &[
        Parameter::size("leakage_drop", "-", Scale::Own, 0.2),
        Parameter::shape(
            "reference_current_amp",
            "A",
            Scale::Current,
            [0.3, 12.0],
            3.0,
            &[1.0, 3.0, 6.0],
        ),
    ],
    symptom: "higher inrush than the model, during the start only",
    look_alikes: &["deep-bar", "series-inductance"],
    separating_test: "locked rotor at two voltages",
};

steady_effect!(LeakageSaturation, DESCRIPTOR, correct);

/// Factor on both leakages at the squared current `i2`, A2.
#[inline(always)]
fn factor<F: Float>(p: &[F], i2: F) -> F {
    (F::one() - p[0] * i2 / (p[1] * p[1] + i2)).max(lit(0.05))
}

fn correct<F: Float>(p: &[F], point: &mut SteadyPoint<F>) {
    let f = factor(p, point.i_s.norm_sqr());
    point.motor.l_ls = point.motor.l_ls * f;
    point.motor.l_lr = point.motor.l_lr * f;
}

#[cfg(feature = "std")]
mod dynamic {
    use super::{LeakageSaturation, factor};
    use crate::dynamic::Linear;
    use crate::effect::{At, Effect, Hook, Instantaneous};
    use num_complex::Complex64;

    impl Effect for LeakageSaturation {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Parameters]
        }

        fn parameters(&self, p: &[f64], at: &At<'_>, i_s: Complex64, now: &mut Instantaneous) {
            let (l_ls, l_lr) = (now.motor.l_ls, now.motor.l_lr);
            let mut i_s = i_s;
            // The current depends on the leakage that depends on it: three rounds reach 1e-3 of the drop.
            for _ in 0..3 {
                let f = factor(p, i_s.norm_sqr());
                (now.motor.l_ls, now.motor.l_lr) = (l_ls * f, l_lr * f);
                i_s = Linear::new(&now.motor).winding(at.psi_s, at.psi_r).i_s;
            }
        }
    }
}
