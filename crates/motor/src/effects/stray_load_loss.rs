//! Stray-load loss, of those in IEEE 112 and IEC 60034-2-1 the one that neither resistances nor a no-load test show: a braking
//! torque `T_s (I/I_N)^2`, smoothed at standstill; as a power `P_N (I/I_N)^2 w/w_s`, with `P_N = T_s w_s` at rated current.

use crate::effect::steady::{Real, lit, steady_effect};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Rated, Scale, SteadyPoint};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "stray-load-loss",
    form: "",
    kind: Kind::Physics,
    applies: Applies::Always,
    parameters: &[Parameter::positive(
        "stray_load_torque_nm",
        "N m",
        Scale::Torque,
        0.02,
    )],
    symptom: "the shaft gives less than the air gap, the more the higher the current",
    look_alikes: &[
        "load-gain",
        "rotor_resistance_ohm",
        "leakage-saturation",
        "coulomb-friction",
    ],
    separating_test: "a calibrated torque transducer at several loads: friction stays, this grows with the square of the current",
};

steady_effect!(StrayLoadLoss, DESCRIPTOR, correct);

fn torque<F: Real>(p: &[F], rated: &Rated<F>, squared_current: F, omega_mech: F) -> F {
    let turning = (omega_mech / (rated.speed() * lit(0.005))).tangent();
    p[0] * squared_current / (rated.current * rated.current) * turning
}

fn correct<F: Real>(p: &[F], point: &mut SteadyPoint<F>) {
    let squared = point.i_s.norm_sqr();
    point.tau_extra = point.tau_extra + torque(p, &point.rated, squared, point.omega_mech);
}

#[cfg(feature = "std")]
mod dynamic {
    use super::{StrayLoadLoss, torque};
    use crate::dynamic::Flow;
    use crate::effect::{At, Effect, Hook, Rates};

    impl Effect for StrayLoadLoss {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Finish]
        }

        fn finish(&self, p: &[f64], at: &At<'_>, flow: &Flow, rates: &mut Rates<'_>) {
            rates.omega_mech -= torque(p, at.rated, flow.winding.i_s.norm_sqr(), at.omega_mech) / flow.inertia;
        }
    }
}
