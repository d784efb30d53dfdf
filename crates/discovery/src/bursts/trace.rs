//! A law over time, one value per step: how a burst acts in the model.

use motor::effect::curve::{Action, Coordinate, Law, Place, traced};
use motor::effect::{
    Applies, Descriptor, EffectConfig, MAX_PARAMETERS, Rated, SteadyEffect, SteadyPoint,
};
use std::sync::LazyLock;

/// A trace at a place. Its values are its table; nothing of it is a coordinate of a fit.
#[derive(Debug)]
struct Trace {
    action: Action,
    descriptor: &'static Descriptor,
}

static TRACES: LazyLock<Vec<Trace>> = LazyLock::new(|| {
    let places = Place::ALL.into_iter();
    places
        .filter(|place| over_time(*place))
        .map(Trace::new)
        .collect()
});

/// Whether a law over time acts at a place.
fn over_time(place: Place) -> bool {
    place.coordinates().contains(&Coordinate::Time)
}

/// Places at which something may come and go.
pub(crate) fn places() -> impl Iterator<Item = Place> {
    TRACES.iter().map(|trace| trace.action.place)
}

/// The action of a trace.
pub(crate) fn action(place: Place) -> Action {
    Action {
        place,
        coordinate: Coordinate::Time,
    }
}

/// The effect of a trace with these values, `step` seconds apart from the beginning of the recording on.
pub(crate) fn trace(place: Place, step: f64, values: &[f64]) -> EffectConfig {
    let effect = TRACES.iter().find(|trace| trace.action.place == place);
    EffectConfig {
        effect: effect.unwrap_or(&TRACES[0]),
        values: traced(step, values),
    }
}

impl Trace {
    fn new(place: Place) -> Self {
        Self {
            action: action(place),
            descriptor: Box::leak(Box::new(Descriptor {
                name: "trace",
                form: place.name(),
                kind: place.kind(),
                applies: Applies::Samples,
                parameters: &[],
                symptom: "",
                look_alikes: &[],
                separating_test: "",
            })),
        }
    }
}

impl SteadyEffect for Trace {
    fn descriptor(&self) -> &'static Descriptor {
        self.descriptor
    }

    /// What comes and goes is no steady state.
    fn correct_f32(&self, _p: &[f32; MAX_PARAMETERS], _point: &mut SteadyPoint<f32>) {}

    fn correct_f64(&self, _p: &[f64], _point: &mut SteadyPoint<f64>) {}
}

impl Law for Trace {
    fn action(&self) -> Action {
        self.action
    }

    fn table(&self, p: &[f64], _rated: &Rated<f64>) -> Vec<f64> {
        p.to_vec()
    }
}
