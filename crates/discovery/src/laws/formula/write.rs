//! A formula as text, and as a motor file holds it.

use super::effect::Formula;
use super::kind::{Kind, Reach};
use motor::effect::curve::{Coordinate, MOST_KNOTS, Place, curve};
use motor::effect::{EffectConfig, expression};
use std::f64::consts::TAU;

/// Points at which the bend of a formula is looked at.
const DENSE: usize = 2000;
/// Share of the knots that bends attract; the others lie at equal distances.
const ATTRACTED: f64 = 0.7;

/// Variable of a coordinate in formulas.
fn variable(coordinate: Coordinate) -> &'static str {
    match coordinate {
        Coordinate::Speed => "omega",
        Coordinate::Angle => "theta",
        Coordinate::AngleElectrical => "theta_u",
        Coordinate::Slip => "slip_hz",
        Coordinate::Current | Coordinate::PhaseCurrent => "i",
        Coordinate::Flux => "psi",
        Coordinate::Frequency => "f",
        Coordinate::Voltage => "u",
        Coordinate::Time => "t",
        Coordinate::LoadTorque => "tau_load",
    }
}

/// The formula in the variable of its coordinate.
pub(crate) fn text(formula: &Formula, p: &[f64]) -> String {
    let (reach, _, coordinates) = formula.split(p);
    let x = variable(formula.action.coordinate);
    formula.shape.text(x, coordinates, &reach)
}

/// Amplitudes and shape parameters with the change of their values with the coordinates of a fit; harmonics stand in the
/// text.
pub(crate) fn numbers(formula: &Formula, p: &[f64]) -> Vec<Number> {
    let (reach, amplitudes, coordinates) = formula.split(p);
    let action = formula.action;
    let quantity = action.place.quantity(action.coordinate);
    let amplitude = |(name, value): (&String, &f64)| Number {
        name: name.clone(),
        value: *value,
        slope: None,
        unit: quantity.unit,
    };
    let parameter = |((name, kind), z): (&(String, Kind), &f64)| Number {
        name: name.clone(),
        value: kind.value(*z, &reach),
        slope: Some(kind.slope(*z, &reach)),
        unit: kind.unit(action.coordinate.unit()),
    };
    let fitted = formula.shape.parameters.iter().zip(coordinates);
    let fitted = fitted.filter(|((_, kind), _)| *kind != Kind::Harmonic);
    let sizes = formula.shape.amplitudes.iter().zip(amplitudes);
    sizes.map(amplitude).chain(fitted.map(parameter)).collect()
}

/// A number of a formula.
#[derive(Clone, Debug)]
pub(crate) struct Number {
    pub name: String,
    pub value: f64,
    /// Change of the value with the coordinate of a shape parameter; `None` for an amplitude.
    pub slope: Option<f64>,
    pub unit: &'static str,
}

/// A fitted formula as a motor file holds it: an `expression` where that has the variable, else knots; `None` for any
/// other effect.
pub(crate) fn as_written(config: &EffectConfig) -> Option<EffectConfig> {
    let formula = Formula::of(config)?;
    let action = formula.action;
    let known = matches!(
        action.coordinate,
        Coordinate::Speed | Coordinate::Angle | Coordinate::Time
    );
    if action.place == Place::Torque && known {
        let numbers = numbers(formula, &config.values);
        // A number of nothing needs a size at which it would matter.
        let typical = numbers.iter().filter(|n| n.value == 0.0);
        let typical = typical.map(|n| (format!("{}_typical", n.name), 1.0));
        let numbers: Vec<_> = numbers
            .iter()
            .map(|n| (n.name.clone(), n.value))
            .chain(typical)
            .collect();
        let text = text(formula, &config.values);
        return expression::expression(Some(&text), Some("torque"), &numbers).ok();
    }
    let knots = knots(formula, &config.values);
    let value = |&x: &f64| formula.value(&config.values, x);
    let values: Vec<f64> = knots.iter().map(value).collect();
    curve(action, &knots, &values).ok()
}

/// Knots that crowd where the formula bends.
fn knots(formula: &Formula, p: &[f64]) -> Vec<f64> {
    if formula.action.coordinate.is_angle() {
        return (0..MOST_KNOTS)
            .map(|k| TAU * k as f64 / MOST_KNOTS as f64)
            .collect();
    }
    let (
        Reach {
            range: [low, high], ..
        },
        _,
        _,
    ) = formula.split(p);
    let at = |k: usize| low + (high - low) * k as f64 / DENSE as f64;
    let y: Vec<f64> = (0..=DENSE).map(|k| formula.value(p, at(k))).collect();
    // A cubic piece errs with the fourth power of its length: a fourth root evens the errors out.
    let bend = |k: usize| (y[k + 1] - 2.0 * y[k] + y[k - 1]).abs().powf(0.25);
    let mut density = vec![0.0; DENSE];
    for (k, share) in density.iter_mut().enumerate() {
        *share = bend(k.clamp(1, DENSE - 1));
    }
    let total: f64 = density.iter().sum();
    let even = 1.0 / DENSE as f64;
    let mut knots = vec![low];
    let mut sum = 0.0;
    for (k, bent) in density.iter().enumerate() {
        let attracted = if total > 0.0 { bent / total } else { even };
        let before = sum;
        sum += ATTRACTED * attracted + (1.0 - ATTRACTED) * even;
        let next = knots.len() as f64 / (MOST_KNOTS - 1) as f64;
        if sum >= next && knots.len() < MOST_KNOTS - 1 {
            let share = (next - before) / (sum - before);
            knots.push(at(k) + share * (at(k + 1) - at(k)));
        }
    }
    knots.push(high);
    knots
}
