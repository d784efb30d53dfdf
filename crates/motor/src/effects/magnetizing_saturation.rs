//! Magnetizing saturation: `i_m = psi/L_m (1 + k((psi/psi_rated)^n - 1))`.

use crate::effect::steady::{Real, length, steady_effect};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint};
use crate::TParams;
use num_traits::Float;

static DESCRIPTOR: Descriptor = Descriptor {
    name: "magnetizing-saturation",
    form: "",
    kind: Kind::Physics,
    applies: Applies::Always,
    parameters: &[
        Parameter::size("saturation", "-", Scale::Own, 0.2),
        Parameter::shape(
            "saturation_exponent",
            "-",
            Scale::Own,
            [2.0, 16.0],
            7.0,
            &[4.0, 7.0, 10.0],
        ),
        Parameter::form("flux_location", [0.0, 0.95], &[0.0, 0.9]),
    ],
    symptom: "positive-sequence current grows faster than the voltage; little at reduced voltage",
    look_alikes: &["voltage-gain", "core-loss"],
    separating_test: "a no-load run at 80 to 110 % of rated voltage",
};

steady_effect!(MagnetizingSaturation, DESCRIPTOR, correct);

/// Moves part `g` of the stator leakage behind the magnetizing branch; the linear motor stays the same at its
/// terminals, only the flux that saturates moves from the air gap (0) towards the stator (1).
fn relocated<F: Float>(motor: &TParams<F>, g: F) -> TParams<F> {
    let l_ls = (F::one() - g) * motor.l_ls;
    let l_m = motor.l_s() - l_ls;
    let k = l_m / motor.l_m;
    TParams {
        r_s: motor.r_s,
        r_r: k * k * motor.r_r,
        l_ls,
        l_lr: k * k * motor.l_r() - l_m,
        l_m,
    }
}

fn correct<F: Real>(p: &[F], point: &mut SteadyPoint<F>) {
    point.motor = relocated(&point.motor, p[2]);
    let x = length(point.air_gap_flux()) / point.rated.flux();
    let factor = F::one() + p[0] * (x.power(p[1]) - F::one());
    point.motor.l_m = point.motor.l_m / factor;
}

#[cfg(feature = "std")]
mod dynamic {
    use super::{MagnetizingSaturation, relocated};
    use crate::TParams;
    use crate::effect::{Effect, Hook, Nominal, Rated};

    impl Effect for MagnetizingSaturation {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Motor, Hook::Magnetizing]
        }

        /// With saturation the magnetizing inductance is that of rated flux, another number than the believed one.
        fn redefines(&self) -> Option<Nominal> {
            Some(Nominal::Magnetizing)
        }

        fn motor(&self, p: &[f64], _rated: &Rated<f64>, motor: &mut TParams<f64>) {
            *motor = relocated(motor, p[2]);
        }

        fn magnetizing(&self, p: &[f64], x: f64) -> (f64, f64) {
            let power = x.powf(p[1] - 1.0);
            (1.0 + p[0] * (x * power - 1.0), p[0] * p[1] * power)
        }
    }
}
