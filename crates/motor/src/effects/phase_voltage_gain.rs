//! Each voltage channel shows its own gain times the truth.

use crate::effect::steady::{steady_effect, unchanged};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, Written};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "phase-voltage-gain",
    form: "",
    kind: Kind::Sensor,
    applies: Applies::Always,
    parameters: &[
        Parameter::size("voltage_gain_a", "-", Scale::Own, 0.02).written(Written::OnePlus),
        Parameter::size("voltage_gain_b", "-", Scale::Own, 0.02).written(Written::OnePlus),
        Parameter::size("voltage_gain_c", "-", Scale::Own, 0.02).written(Written::OnePlus),
    ],
    symptom: "zero sequence in the voltages and negative sequence in the current error",
    look_alikes: &["voltage-asymmetry", "stator-asymmetry"],
    separating_test: "the sum of the phase voltages names the channel",
};

steady_effect!(PhaseVoltageGain, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::PhaseVoltageGain;
    use crate::dynamic::{clarke, phases};
    use crate::effect::{Effect, Hook, Inputs, Instrument, Outputs, Rated};
    use num_complex::Complex64;

    /// Zero sequence that wrong channels show for a star without zero sequence.
    ///
    /// The channels show `x_k + z`; the truth `(x_k + z)/(1 + p_k)` sums to zero.
    fn zero_sequence(p: &[f64], shown: Complex64) -> f64 {
        let x = phases(shown);
        let back = [0, 1, 2].map(|k| 1.0 / (1.0 + p[k]));
        -(x[0] * back[0] + x[1] * back[1] + x[2] * back[2]) / back.iter().sum::<f64>()
    }

    impl Effect for PhaseVoltageGain {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Inputs, Hook::Outputs]
        }

        fn gain_of(&self) -> Option<Instrument> {
            Some(Instrument::Voltages)
        }

        fn inputs(&self, p: &[f64], _rated: &Rated<f64>, inputs: &mut Inputs) {
            let truth = |u: Complex64| {
                let (x, zero) = (phases(u), zero_sequence(p, u));
                clarke(core::array::from_fn(|k| (x[k] + zero) / (1.0 + p[k])))
            };
            inputs.u_s.iter_mut().for_each(|u| *u = truth(*u));
        }

        fn outputs(&self, p: &[f64], _rated: &Rated<f64>, outputs: &mut Outputs) {
            let shown = outputs.u_measured.iter().map(|&u| zero_sequence(p, u));
            outputs
                .u_zero
                .iter_mut()
                .zip(shown)
                .for_each(|(u, z)| *u += z);
        }
    }
}
