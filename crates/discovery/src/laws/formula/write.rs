//! A formula as text, and as a motor file holds it.

use super::effect::Formula;
use super::kind::{Kind, Reach};
use motor::effect::curve::{Coordinate, MOST_KNOTS, Place, curve};
use motor::effect::{EffectConfig, expression};
use std::f64::consts::TAU;

/// Points at which the bend of a formula is looked at.
const DENSE: usize = 2000;
/// Points to both sides from which a bend draws knots.
const AROUND: usize = 20;
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
    let bends: Vec<f64> = (1..DENSE).map(bend).collect();
    // A corner draws knots from some way around, not all into one place.
    let around = |k: usize| &bends[k.saturating_sub(AROUND)..(k + AROUND).min(bends.len())];
    let density: Vec<f64> = (0..DENSE).map(|k| around(k).iter().sum()).collect();
    let total: f64 = density.iter().sum();
    let even = 1.0 / DENSE as f64;
    let mut knots = vec![low];
    let mut sum = 0.0;
    for (k, bent) in density.iter().enumerate() {
        let attracted = if total > 0.0 { bent / total } else { even };
        let cell = ATTRACTED * attracted + (1.0 - ATTRACTED) * even;
        let next = |n: usize| n as f64 / (MOST_KNOTS - 1) as f64;
        while knots.len() < MOST_KNOTS - 1 && sum + cell >= next(knots.len()) {
            let share = (next(knots.len()) - sum) / cell;
            knots.push(at(k) + share * (at(k + 1) - at(k)));
        }
        sum += cell;
    }
    knots.push(high);
    knots
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::formula::dictionary::Shapes;
    use motor::effect::curve::{Action, knots_and_values};
    use motor::effect::to_entry;

    fn written(
        place: Place,
        coordinate: Coordinate,
        range: [f64; 2],
        (shape, amplitudes, coordinates): (&str, &[f64], &[f64]),
    ) -> EffectConfig {
        let shape = Shapes::default().all().find(|s| s.name == shape);
        let action = Action { place, coordinate };
        let reach = Reach::of(range);
        Formula::config(
            action,
            shape.expect("known"),
            &reach,
            amplitudes,
            coordinates,
        )
    }

    #[test]
    fn a_torque_over_speed_becomes_an_expression_with_named_numbers() {
        let place = Place::Torque;
        let shape = ("power", &[2.5][..], &[3f64.ln()][..]);
        let config = written(place, Coordinate::Speed, [-0.5, 157.08], shape);
        let entry = to_entry(&as_written(&config).expect("a formula"));
        assert_eq!(entry.name, "expression");
        assert_eq!(entry.text("formula"), Some("a*(abs(omega)/157)^n"));
        assert_eq!(entry.text("adds_to"), Some("torque"));
        assert_eq!(entry.number("a"), Some(2.5));
        assert!((entry.number("n").expect("a number") - 3.0).abs() < 1e-12);
    }

    /// Where an expression has no such variable, knots meet the formula, at its corner too.
    #[test]
    fn elsewhere_a_formula_becomes_knots_that_meet_it() {
        let shape = ("hinge", &[0.8][..], &[0.45][..]);
        let (place, range) = (Place::Rotor, [0.2, 6.0]);
        let config = written(place, Coordinate::Slip, range, shape);
        let curve = as_written(&config).expect("a formula");
        let (_, x, y) = knots_and_values(&curve).expect("a curve");
        assert!(x.len() == MOST_KNOTS && x[0] == 0.2 && x[MOST_KNOTS - 1] == 6.0);
        let formula = Formula::of(&config).expect("a formula");
        for (x, y) in x.iter().zip(y) {
            assert_eq!(formula.value(&config.values, *x), *y);
        }
        // Between them no straight line is off by more than a hundredth of the largest value.
        for (x, y) in x.windows(2).zip(y.windows(2)) {
            let middle = formula.value(&config.values, 0.5 * (x[0] + x[1]));
            assert!((middle - 0.5 * (y[0] + y[1])).abs() < 0.008 * 0.8, "{x:?}");
        }
    }

    #[test]
    fn a_law_over_an_angle_keeps_its_harmonics_in_the_text() {
        let shape = ("harmonic", &[0.1, 0.2][..], &[3.0][..]);
        let turn = [0.0, TAU];
        let config = written(Place::SensorSpeed, Coordinate::Angle, turn, shape);
        let curve = as_written(&config).expect("a formula");
        assert!(knots_and_values(&curve).is_some_and(|(_, x, _)| x[MOST_KNOTS - 1] < TAU));
        let formula = Formula::of(&config).expect("a formula");
        let names: Vec<_> = numbers(formula, &config.values)
            .into_iter()
            .map(|n| n.name)
            .collect();
        assert_eq!(names, ["a", "b"]);
        assert_eq!(
            text(formula, &config.values),
            "a*cos(3*theta) + b*sin(3*theta)"
        );
    }
}
