//! Known formulas on the information of known curves.

use super::dictionary::Shapes;
use super::kind::Reach;
use super::propose::{Projector, Proposal, Weight, propose};
use super::quadratic::Quadratic;
use super::shape::Shape;
use crate::laws::modes::{self, Modes};
use motor::effect::EffectConfig;
use motor::effect::curve::{Action, Coordinate, Place};
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Values of a law's curve, measured with the deviation `noise` at `n` places, as the information that a fit has.
struct Measured {
    config: EffectConfig,
    quadratic: Quadratic,
    weight: Weight,
}

fn measured(action: Action, range: [f64; 2], truth: impl Fn(f64) -> f64, noise: f64) -> Measured {
    const N: usize = 4000;
    let config = Modes::absent(action, range);
    let law = Modes::of(&config).expect("a law");
    let mut rng = rand_pcg::Pcg64::seed_from_u64(7);
    let n = modes::count(action.coordinate);
    let x = |k: usize| law.along(&config.values, (k as f64 + 0.5) / N as f64);
    let j = DMatrix::from_fn(N, n, |row, mode| {
        law.shares(&config.values, x(row))[mode] / noise
    });
    let y = DVector::from_fn(N, |row, _| {
        let draw: f64 = StandardNormal.sample(&mut rng);
        truth(x(row)) / noise + draw
    });
    // The modes of the best curve, a hair of stiffness on top.
    let gram = j.transpose() * &j + DMatrix::identity(n, n) * 1e-6;
    let here = gram.try_inverse().expect("regular") * (j.transpose() * &y);
    let residual = &y - &j * &here;
    let quadratic = Quadratic::bare(
        j.transpose() * &j,
        j.transpose() * &residual,
        residual.norm_squared(),
        here,
    );
    Measured {
        config,
        quadratic,
        weight: Weight {
            values: N as f64,
            inflation: 1.0,
            variance: 1.0,
        },
    }
}

fn proposed(measured: &Measured, action: Action, range: [f64; 2]) -> Vec<Proposal> {
    let suits = |shape: &&Shape| shape.over.suits(action.coordinate, range);
    let asked: Vec<&'static Shape> = Shapes::default().all().filter(suits).collect();
    let projector = Projector::of(&measured.config).expect("a law");
    propose(&asked, &projector, &measured.quadratic, measured.weight)
}

fn asked(
    coordinate: Coordinate,
    range: [f64; 2],
    truth: impl Fn(f64) -> f64,
) -> (Vec<Proposal>, Reach) {
    let action = Action {
        place: Place::Torque,
        coordinate,
    };
    let measured = measured(action, range, truth, 0.05);
    (proposed(&measured, action, range), Reach::of(range))
}

/// Value of the proposal's shape parameter `k`.
fn parameter(p: &Proposal, k: usize, reach: &Reach) -> f64 {
    p.shape.parameters[k].1.value(p.coordinates[k], reach)
}

#[test]
fn a_power_is_found_among_its_neighbours() {
    let range = [2.0, 150.0];
    let (all, reach) = asked(Coordinate::Speed, range, |x| 3.0 * (x / 150.0).powf(1.6));
    assert_eq!(all[0].shape.name, "power");
    assert!((parameter(&all[0], 0, &reach) - 1.6).abs() < 0.02);
    assert!((all[0].amplitudes[0] - 3.0).abs() < 0.02);
}

#[test]
fn a_saturating_exponential_is_found_with_its_width() {
    let (all, reach) = asked(Coordinate::Time, [0.0, 8.0], |t| {
        0.5 * (1.0 - (-t / 2.0).exp())
    });
    assert_eq!(all[0].shape.name, "saturating exponential");
    assert!((parameter(&all[0], 0, &reach) - 2.0).abs() < 0.1);
    assert!((all[0].amplitudes[0] - 0.5).abs() < 0.02);
}

#[test]
fn a_bump_is_found_where_it_is() {
    let truth = |t: f64| 0.8 * (-0.5 * ((t - 3.2) / 0.9f64).powi(2)).exp();
    let (all, reach) = asked(Coordinate::Time, [0.0, 8.0], truth);
    assert_eq!(all[0].shape.name, "bump");
    let found = |name: &str| {
        let k = all[0].shape.parameters.iter().position(|p| p.0 == name);
        parameter(&all[0], k.expect("a parameter"), &reach)
    };
    assert!((found("s") - 3.2).abs() < 0.05 && (found("w") - 0.9).abs() < 0.05);
}

/// Friction that falls from rest: the exponent too, which a sign that binds more tightly than a power would freeze.
#[test]
fn a_stribeck_curve_is_found_with_its_exponent() {
    let truth = |x: f64| (x / 1.2).tanh() * (2.0 + 3.0 * (-(x / 40.0).powf(1.5)).exp());
    let (all, reach) = asked(Coordinate::Speed, [0.0, 150.0], truth);
    assert!(
        all[0].shape.name.starts_with("Stribeck"),
        "{}",
        all[0].shape.name
    );
    let stribeck = all.iter().find(|p| p.shape.name == "Stribeck");
    let stribeck = stribeck.expect("asked");
    let found = |name: &str| {
        let k = stribeck.shape.parameters.iter().position(|p| p.0 == name);
        parameter(stribeck, k.expect("a parameter"), &reach)
    };
    assert!((found("n") - 1.5).abs() < 0.15, "{}", found("n"));
    assert!((found("w") - 40.0).abs() < 4.0, "{}", found("w"));
}

#[test]
fn two_harmonics_are_found_and_one_is_not_taken_for_two() {
    let both = |x: f64| 0.4 * (2.0 * x).cos() + 0.3 * (4.0 * x + 1.0).cos();
    let (all, _) = asked(Coordinate::Angle, [0.0, std::f64::consts::TAU], both);
    assert_eq!(all[0].shape.name, "two harmonics");
    let mut orders = all[0].coordinates.clone();
    orders.sort_by(f64::total_cmp);
    assert_eq!(orders, [2.0, 4.0]);
    let (all, _) = asked(Coordinate::Angle, [0.0, std::f64::consts::TAU], |x| {
        0.4 * (3.0 * x).sin()
    });
    assert_eq!(
        (all[0].shape.name.as_str(), all[0].coordinates[0]),
        ("harmonic", 3.0)
    );
}

/// A formula is written in the variable of its coordinate; harmonics and the largest coordinate are numbers.
#[test]
fn a_text_holds_names_for_what_was_fitted_and_numbers_for_the_rest() {
    let named = |name: &str| {
        Shapes::default()
            .all()
            .find(|s| s.name == name)
            .expect("known")
    };
    let reach = Reach::of([0.0, 157.08]);
    assert_eq!(
        named("power").text("omega", &[0.0], &reach),
        "a*(abs(omega)/157)^n"
    );
    assert_eq!(
        named("harmonic").text("theta", &[3.0], &reach),
        "a*cos(3*theta) + b*sin(3*theta)"
    );
}
