//! Two masses on an elastic shaft: torsional frequency, damping ratio and the motor's share of the inertia.

use crate::effect::steady::{steady_effect, unchanged};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "shaft-compliance",
    form: "",
    kind: Kind::Physics,
    applies: Applies::Always,
    parameters: &[
        Parameter::shape(
            "motor_inertia_share",
            "-",
            Scale::Own,
            [0.05, 0.97],
            0.5,
            &[0.5],
        ),
        Parameter::shape(
            "torsional_frequency_hz",
            "Hz",
            Scale::Own,
            [5.0, 250.0],
            45.0,
            &[10.0, 14.0, 20.0, 28.0, 40.0, 57.0, 80.0, 113.0],
        )
        .resonance(),
        Parameter::shape(
            "damping_ratio",
            "-",
            Scale::Own,
            [0.0005, 0.5],
            0.02,
            &[0.02],
        ),
    ],
    symptom: "the speed rings after every step",
    look_alikes: &["inertia_kg_m2"],
    separating_test: "none needed: the ringing frequency is its own",
};

steady_effect!(ShaftCompliance, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::ShaftCompliance;
    use crate::dynamic::Flow;
    use crate::effect::{At, Effect, Hook, Rates};

    impl Effect for ShaftCompliance {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Finish]
        }

        fn extra_states(&self) -> usize {
            2
        }

        /// Extra states: speed of the load relative to the motor (rad/s) and twist (rad).
        fn finish(&self, p: &[f64], at: &At<'_>, flow: &Flow, rates: &mut Rates<'_>) {
            let (slip_speed, twist) = (at.extra[0], at.extra[1]);
            let (j_motor, j_load) = (p[0] * flow.inertia, (1.0 - p[0]) * flow.inertia);
            let reduced = j_motor * j_load / flow.inertia;
            let omega = core::f64::consts::TAU * p[1];
            let shaft = reduced * omega * (omega * twist - 2.0 * p[2] * slip_speed);
            let on_motor = flow.inertia * rates.omega_mech + flow.tau_load;
            rates.omega_mech = (on_motor - shaft) / j_motor;
            let load_rate = (shaft - flow.tau_load) / j_load;
            rates
                .extra
                .copy_from_slice(&[load_rate - rates.omega_mech, -slip_speed]);
        }
    }
}
