//! The currents are sampled later than the voltages: `i(t - d)`.

use crate::effect::steady::{Real, steady_effect};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale, SteadyPoint};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "sample-delay",
    form: "",
    kind: Kind::Sensor,
    applies: Applies::Samples,
    parameters: &[Parameter::size("delay_s", "s", Scale::Own, 1e-4)],
    symptom: "positive-sequence current error in quadrature",
    look_alikes: &["sensor-filter", "frame-rotation"],
    separating_test: "harmonics in the supply: delay turns each in proportion to its order",
};

steady_effect!(SampleDelay, DESCRIPTOR, correct);

fn correct<F: Real>(p: &[F], point: &mut SteadyPoint<F>) {
    let phase = point.omega_sync * p[0];
    point.i_s = point.i_s * phase.turn();
}

#[cfg(feature = "std")]
mod dynamic {
    use super::SampleDelay;
    use crate::effect::signals::delayed;
    use crate::effect::{Effect, Hook, Instrument, Outputs, Rated};

    impl Effect for SampleDelay {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Outputs]
        }

        fn lag_of(&self) -> Option<Instrument> {
            Some(Instrument::Currents)
        }

        fn outputs(&self, p: &[f64], _rated: &Rated<f64>, outputs: &mut Outputs) {
            let samples = p[0] / outputs.t_sample;
            outputs.each_current(|_, x| delayed(x, samples));
        }
    }
}
