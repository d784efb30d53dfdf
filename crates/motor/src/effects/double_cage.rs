//! A second rotor cage, equal to the single cage at low slip: `R_1 = R_r/(1-a)`, `R_2 = R_r/a`, `L_2 = lambda L_lr`.

use crate::effect::steady::{lit, steady_effect};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint};
use crate::TParams;
use num_complex::Complex;
use num_traits::Float;

static DESCRIPTOR: Descriptor = Descriptor {
    name: "deep-bar",
    form: "double-cage",
    kind: Kind::Physics,
    applies: Applies::Samples,
    parameters: &[
        Parameter {
            range: [0.0, 0.8],
            ..Parameter::positive("second_cage_share", "-", Scale::Own, 0.2)
        },
        Parameter::shape(
            "second_cage_leakage_ratio",
            "-",
            Scale::Own,
            [0.05, 4.0],
            0.5,
            &[0.2, 0.5, 1.0],
        ),
    ],
    symptom: "start and locked rotor differ from the model, running does not",
    look_alikes: &["leakage-saturation", "rotor-heating"],
    separating_test: "locked rotor at two frequencies",
};

steady_effect!(DoubleCage, DESCRIPTOR, correct);

/// Both cages: resistances and leakages `(r_1, l_1, r_2, l_2)`.
#[inline(always)]
fn cages<F: Float>(p: &[F], motor: &TParams<F>) -> (F, F, F, F) {
    // Below this share the second cage's time constant is too short for the integration step.
    let a = p[0].max(lit(0.03));
    let rest = F::one() - a;
    let l_2 = p[1] * motor.l_lr;
    let l_1 = ((motor.l_lr - a * a * l_2) / (rest * rest)).max(motor.l_lr * lit(0.05));
    (motor.r_r / rest, l_1, motor.r_r / a, l_2)
}

fn correct<F: Float>(p: &[F], point: &mut SteadyPoint<F>) {
    let slip = point.slip();
    if p[0] <= F::zero() || slip.abs() < lit(1e-6) {
        return;
    }
    let (r_1, l_1, r_2, l_2) = cages(p, &point.motor);
    let omega = point.omega_sync;
    let first = Complex::new(r_1 / slip, omega * l_1);
    let second = Complex::new(r_2 / slip, omega * l_2);
    let both = first * second / (first + second);
    point.motor.r_r = both.re * slip;
    point.motor.l_lr = both.im / omega;
}

#[cfg(feature = "std")]
mod dynamic {
    use super::{DoubleCage, cages};
    use crate::dynamic::Flow;
    use crate::effect::{At, Cage, Effect, Hook, Instantaneous, Rates};
    use num_complex::Complex64;

    impl Effect for DoubleCage {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Parameters, Hook::Finish]
        }

        fn extra_states(&self) -> usize {
            2
        }

        fn parameters(&self, p: &[f64], at: &At<'_>, _i_s: Complex64, now: &mut Instantaneous) {
            if p[0] <= 0.0 {
                return;
            }
            let (r_1, l_1, r_2, l_2) = cages(p, &now.motor);
            (now.motor.r_r, now.motor.l_lr) = (r_1, l_1);
            now.cage = Some(Cage {
                r: r_2,
                l: l_2,
                psi: Complex64::new(at.extra[0], at.extra[1]),
            });
        }

        fn finish(&self, p: &[f64], at: &At<'_>, flow: &Flow, rates: &mut Rates<'_>) {
            let (_, _, r_2, l_2) = cages(p, at.motor);
            let psi = Complex64::new(at.extra[0], at.extra[1]);
            let psi_m = at.psi_s - flow.winding.i_s * at.motor.l_ls;
            let spin = psi * Complex64::new(0.0, flow.n_p * at.omega_mech);
            let rate = spin - (psi - psi_m) * (r_2 / l_2);
            rates.extra.copy_from_slice(&[rate.re, rate.im]);
        }
    }
}
