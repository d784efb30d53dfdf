//! The effect behind `name = "curve"`.

use super::steady::{BOARD_KNOTS, SteadyCurve};
use super::{Action, Law, NAME, tabulated};
use crate::effect::{
    Applies, Descriptor, EffectConfig, EffectError, MAX_PARAMETERS, Parameter, Rated, Role, Scale,
    SteadyEffect, SteadyPoint, Written,
};
use spline::Spline;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Fewest knots of a curve.
pub const FEWEST_KNOTS: usize = 3;
/// Most knots of a curve.
pub const MOST_KNOTS: usize = BOARD_KNOTS;
/// Most knots of a curve over an angle, of which steady state sees the mean alone.
pub const MOST_KNOTS_OF_A_TURN: usize = 40;

/// A law with a number of knots; its values are the knots, then the curve's values there.
#[derive(Debug)]
struct Curve {
    action: Action,
    knots: usize,
    descriptor: &'static Descriptor,
}

/// One of each kind: there are at most some two thousand, whatever is read.
static KNOWN: Mutex<BTreeMap<(Action, usize), &'static Curve>> = Mutex::new(BTreeMap::new());

fn known(action: Action, knots: usize) -> &'static Curve {
    let mut known = KNOWN
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    known.entry((action, knots)).or_insert_with(|| {
        Box::leak(Box::new(Curve {
            action,
            knots,
            descriptor: Box::leak(Box::new(descriptor(action, knots))),
        }))
    })
}

fn descriptor(action: Action, knots: usize) -> Descriptor {
    let quantity = action.place.quantity(action.coordinate);
    let knot = Parameter {
        name: action.coordinate.key(),
        unit: action.coordinate.unit(),
        role: Role::Form,
        written: Written::Plain,
        scale: Scale::Own,
        range: [-f64::MAX, f64::MAX],
        typical: 1.0,
        grid: &[],
        is_resonance: false,
    };
    let value = Parameter {
        name: quantity.key,
        unit: quantity.unit,
        role: Role::Size,
        scale: quantity.scale,
        range: [-1e3, 1e3],
        typical: quantity.typical,
        ..knot
    };
    let parameters = [vec![knot; knots], vec![value; knots]].concat();
    Descriptor {
        name: NAME,
        form: String::leak(format!(
            "{} over {}",
            action.place.name(),
            action.coordinate.name()
        )),
        kind: action.place.kind(),
        applies: Applies::Samples,
        parameters: Vec::leak(parameters),
        symptom: "a law that the library does not hold",
        look_alikes: &[],
        separating_test: "",
    }
}

/// A law through knots.
///
/// # Errors
/// A place over which no law acts, fewer than [`FEWEST_KNOTS`] or more than [`MOST_KNOTS`] knots (angles:
/// [`MOST_KNOTS_OF_A_TURN`]), knots that do not ascend or (angles) leave one turn, numbers that are not finite, as many values as knots.
pub fn curve(action: Action, knots: &[f64], values: &[f64]) -> Result<EffectConfig, EffectError> {
    allowed(action)?;
    let key = action.coordinate.key();
    let most = match action.coordinate.is_angle() {
        true => MOST_KNOTS_OF_A_TURN,
        false => MOST_KNOTS,
    };
    if !(FEWEST_KNOTS..=most).contains(&knots.len()) {
        let reason = format!("{} knots: give {FEWEST_KNOTS} to {most}", knots.len());
        return Err(wrong(key, reason));
    }
    let values_key = action.place.quantity(action.coordinate).key;
    if values.len() != knots.len() {
        let (n, m) = (values.len(), knots.len());
        return Err(wrong(
            values_key,
            format!("{n} values for {m} knots: give one for each"),
        ));
    }
    if knots.iter().any(|x| !x.is_finite()) || knots.windows(2).any(|pair| pair[1] <= pair[0]) {
        return Err(wrong(key, "the knots must ascend".to_owned()));
    }
    if values.iter().any(|x| !x.is_finite()) {
        return Err(wrong(values_key, "every value must be a number".to_owned()));
    }
    let turn = knots[knots.len() - 1] - knots[0];
    if action.coordinate.is_angle() && turn >= std::f64::consts::TAU {
        return Err(wrong(
            key,
            "the knots of an angle lie within one turn, 0 to 6.283 rad: leave the last out"
                .to_owned(),
        ));
    }
    Ok(EffectConfig {
        effect: known(action, knots.len()),
        values: [knots, values].concat(),
    })
}

fn wrong(key: &'static str, reason: String) -> EffectError {
    EffectError::Curve { key, reason }
}

/// Whether a law acts at this place over this coordinate.
///
/// # Errors
/// The coordinates over which one acts there.
pub(super) fn allowed(action: Action) -> Result<(), EffectError> {
    let coordinates = action.place.coordinates();
    if coordinates.contains(&action.coordinate) {
        return Ok(());
    }
    let known: Vec<_> = coordinates.iter().map(|c| c.name()).collect();
    let place = action.place.name();
    let reason = format!("at `{place}` a law acts over one of: {}", known.join(", "));
    Err(wrong("coordinate", reason))
}

/// The action, the knots and the values of a curve; `None` for another effect.
pub fn knots_and_values(config: &EffectConfig) -> Option<(Action, &[f64], &[f64])> {
    let (action, knots) = config.effect.law()?;
    let (x, y) = config.values.split_at_checked(knots)?;
    (y.len() == knots).then_some((action, x, y))
}

impl Curve {
    fn spline(&self, p: &[f64]) -> Spline {
        let (x, y) = p.split_at(self.knots);
        match self.action.coordinate.is_angle() {
            true => Spline::periodic(x, y),
            false => Spline::open(x, y),
        }
    }
}

impl SteadyEffect for Curve {
    fn descriptor(&self) -> &'static Descriptor {
        self.descriptor
    }

    /// The board holds a curve as a [`SteadyCurve`]: four parameters have no room for it.
    fn correct_f32(&self, _p: &[f32; MAX_PARAMETERS], _point: &mut SteadyPoint<f32>) {}

    fn correct_f64(&self, p: &[f64], point: &mut SteadyPoint<f64>) {
        let (x, y) = p.split_at(self.knots);
        if let Some(curve) = SteadyCurve::<f64>::new(self.action, x, y) {
            curve.correct(point);
        }
    }
}

impl Law for Curve {
    fn action(&self) -> Action {
        self.action
    }

    fn table(&self, p: &[f64], rated: &Rated<f64>) -> Vec<f64> {
        let spline = self.spline(p);
        let range = [p[0], p[self.knots - 1]];
        let action = self.action;
        tabulated(action.coordinate.ends(range), action.per_unit(rated), |x| {
            spline.at(x)
        })
    }

    fn knots(&self) -> Option<usize> {
        Some(self.knots)
    }
}
