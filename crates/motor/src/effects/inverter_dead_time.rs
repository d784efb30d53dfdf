//! Dead time and device drop of an inverter: `-V tanh(i_k/I_0)` per phase, decided once per hold period.

use crate::effect::steady::{length, lit, steady_effect};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint};
use num_complex::Complex;
use num_traits::Float;

static DESCRIPTOR: Descriptor = Descriptor {
    name: "inverter-dead-time",
    form: "",
    kind: Kind::Physics,
    applies: Applies::Inverter,
    parameters: &[
        Parameter::positive("dead_time_voltage_volt", "V", Scale::Voltage, 0.02),
        Parameter::shape(
            "smoothing_current_amp",
            "A",
            Scale::Current,
            [0.002, 0.5],
            0.03,
            &[0.03],
        ),
    ],
    symptom: "fifth and seventh harmonics, a voltage error in phase with the current that fakes R_s",
    look_alikes: &["stator_resistance_ohm"],
    separating_test: "two current levels at the same frequency: a resistance drop is proportional, dead time is not",
};

steady_effect!(InverterDeadTime, DESCRIPTOR, correct);

fn correct<F: Float>(p: &[F], point: &mut SteadyPoint<F>) {
    // Describing function of tanh for a sine: V/I_0 for small currents, 4V/(pi i) for large ones.
    let quarter_pi = lit::<F>(core::f64::consts::FRAC_PI_4);
    let limits = Complex::new(p[1], quarter_pi * length(point.i_s));
    let gain = p[0] / length(limits);
    point.u_s = point.u_s - point.i_s * gain;
}

#[cfg(feature = "std")]
mod dynamic {
    use super::InverterDeadTime;
    use crate::dynamic::{clarke, phases};
    use crate::effect::{At, Effect, Hook};
    use num_complex::Complex64;

    impl Effect for InverterDeadTime {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::HeldVoltage]
        }

        fn held_voltage(&self, p: &[f64], _at: &At<'_>, i_s: Complex64) -> Complex64 {
            clarke(phases(i_s).map(|i| -p[0] * (i / p[1]).tanh()))
        }
    }
}
