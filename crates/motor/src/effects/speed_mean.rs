//! The speed channel shows a mean over the last `2 d`, late by `d`: counts of an encoder in a window.

use crate::effect::steady::{steady_effect, unchanged};
use crate::effect::{Applies, Descriptor, Kind, Parameter, Scale};

static DESCRIPTOR: Descriptor = Descriptor {
    name: "speed-delay",
    form: "mean",
    kind: Kind::Sensor,
    applies: Applies::Always,
    // The ripple that a mean hides grows with the square of a short window: no slope at zero shows the effect.
    parameters: &[Parameter::shape(
        "delay_s",
        "s",
        Scale::Own,
        [1e-4, 0.1],
        5e-3,
        &[2e-3, 5e-3, 1e-2, 2.5e-2],
    )],
    symptom: "the speed lags in ramps, and shows little of the ripple of a start",
    look_alikes: &["inertia_kg_m2"],
    separating_test: "a direct-on-line start with the current as reference: its torque ripples at the supply's frequency",
};

steady_effect!(SpeedMean, DESCRIPTOR, unchanged);

#[cfg(feature = "std")]
mod dynamic {
    use super::SpeedMean;
    use crate::effect::signals::{averaged, delayed};
    use crate::effect::{Effect, Hook, Instrument, Outputs, Rated};

    impl Effect for SpeedMean {
        fn hooks(&self) -> &'static [Hook] {
            &[Hook::Outputs]
        }

        fn lag_of(&self) -> Option<Instrument> {
            Some(Instrument::Speed)
        }

        fn outputs(&self, p: &[f64], _rated: &Rated<f64>, outputs: &mut Outputs) {
            outputs.omega_mech = averaged(&outputs.omega_mech, 2.0 * p[0] / outputs.t_sample);
        }

        fn averages_speed(&self) -> bool {
            true
        }

        /// The mean over `t - 2d .. t` is `w + w'' d^2/6 + ..` of the middle: turned back up to the second derivative, which
        /// differences over half the window show.
        fn shaft_speed(&self, p: &[f64], t_sample: f64, shown: &[f64]) -> Option<Vec<f64>> {
            let late = p[0] / t_sample;
            let around = [-1.5, -1.0, -0.5].map(|share| delayed(shown, share * late));
            let [after, middle, before] = &around;
            let turned_back = |k: usize| {
                let curvature = 4.0 * (after[k] - 2.0 * middle[k] + before[k]);
                middle[k] - curvature / 6.0
            };
            Some((0..shown.len()).map(turned_back).collect())
        }
    }
}
