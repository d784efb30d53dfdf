//! A formula at a place of the equations, as an effect whose amplitudes and shape parameters are fitted.

use super::kind::{Kind, Reach};
use super::shape::Shape;
use motor::effect::curve::{Action, Law, tabulated};
use motor::effect::{
    Applies, Descriptor, EffectConfig, MAX_PARAMETERS, Parameter, Rated, Role, Scale, SteadyEffect,
    SteadyPoint, Written,
};
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Values before the amplitudes: lowest and highest coordinate.
const RANGE: usize = 2;
/// Prior of amplitudes and shape parameters: none to speak of.
const UNKNOWN: f64 = 1e3;

/// A shape that acts. Its values: the range, the amplitudes, the coordinates of the shape parameters.
#[derive(Debug)]
pub(crate) struct Formula {
    /// Where it acts, over what.
    pub action: Action,
    /// The formula.
    pub shape: &'static Shape,
    descriptor: &'static Descriptor,
}

/// One of each action and shape, whatever is asked.
static KNOWN: Mutex<BTreeMap<(Action, usize), &'static Formula>> = Mutex::new(BTreeMap::new());

impl Formula {
    /// The formula with its values.
    pub fn config(
        action: Action,
        shape: &'static Shape,
        reach: &Reach,
        amplitudes: &[f64],
        coordinates: &[f64],
    ) -> EffectConfig {
        let values = [reach.range.as_slice(), amplitudes, coordinates].concat();
        let mut known = KNOWN
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        let new = || &*Box::leak(Box::new(Formula::new(action, shape)));
        let key = (action, std::ptr::from_ref(shape).addr());
        let effect = *known.entry(key).or_insert_with(new);
        EffectConfig { effect, values }
    }

    fn new(action: Action, shape: &'static Shape) -> Self {
        let quantity = action.place.quantity(action.coordinate);
        let end = Parameter {
            name: "range",
            unit: action.coordinate.unit(),
            role: Role::Form,
            written: Written::Plain,
            scale: Scale::Own,
            range: [-f64::MAX, f64::MAX],
            typical: 1.0,
            grid: &[],
            is_resonance: false,
        };
        let amplitude = |name: &'static String| Parameter {
            name,
            unit: quantity.unit,
            role: Role::Size,
            scale: quantity.scale,
            range: [-1e3 * quantity.typical, 1e3 * quantity.typical],
            typical: quantity.typical,
            ..end
        };
        let parameter = |(name, kind): &'static (String, Kind)| Parameter {
            name,
            unit: "-",
            role: match kind {
                Kind::Harmonic => Role::Form,
                _ => Role::Size,
            },
            range: kind.bounds(),
            ..end
        };
        let amplitudes = shape.amplitudes.iter().map(amplitude);
        let parameters = shape.parameters.iter().map(parameter);
        let all: Vec<Parameter> = [end; RANGE]
            .into_iter()
            .chain(amplitudes)
            .chain(parameters)
            .collect();
        Self {
            action,
            shape,
            descriptor: Box::leak(Box::new(Descriptor {
                name: motor::effect::curve::NAME,
                form: &shape.formula,
                kind: action.place.kind(),
                applies: Applies::Samples,
                parameters: Vec::leak(all),
                symptom: "",
                look_alikes: &[],
                separating_test: "",
            })),
        }
    }

    /// The formula behind an effect of a hypothesis; `None` for any other effect.
    pub fn of(config: &EffectConfig) -> Option<&'static Formula> {
        let descriptor = config.effect.descriptor();
        let known = KNOWN
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        let mut all = known.values();
        all.find(|formula| std::ptr::eq(formula.descriptor, descriptor))
            .copied()
    }

    /// Range, amplitudes and coordinates among the values.
    pub fn split<'p>(&self, p: &'p [f64]) -> (Reach, &'p [f64], &'p [f64]) {
        let (range, rest) = p.split_at(RANGE);
        let (amplitudes, coordinates) = rest.split_at(self.shape.amplitudes.len());
        (Reach::of([range[0], range[1]]), amplitudes, coordinates)
    }

    /// Value at `x`, in the unit of its place.
    pub fn value(&self, p: &[f64], x: f64) -> f64 {
        let (reach, amplitudes, coordinates) = self.split(p);
        self.shape.value(amplitudes, coordinates, &reach, x)
    }
}

impl SteadyEffect for Formula {
    fn descriptor(&self) -> &'static Descriptor {
        self.descriptor
    }

    /// A formula is asked about recordings only; the motor file gets it in another form.
    fn correct_f32(&self, _p: &[f32; MAX_PARAMETERS], _point: &mut SteadyPoint<f32>) {}

    fn correct_f64(&self, _p: &[f64], _point: &mut SteadyPoint<f64>) {}
}

impl Law for Formula {
    fn action(&self) -> Action {
        self.action
    }

    fn table(&self, p: &[f64], rated: &Rated<f64>) -> Vec<f64> {
        let (reach, amplitudes, coordinates) = self.split(p);
        let value = |x: f64| self.shape.value(amplitudes, coordinates, &reach, x);
        let per_unit = self.action.per_unit(rated);
        tabulated(self.action.coordinate.ends(reach.range), per_unit, value)
    }

    fn deviation(&self, _p: &[f64], _parameter: usize) -> Option<f64> {
        Some(UNKNOWN)
    }
}
