//! Coordinates against the numbers that they stand for.

use crate::data::case::Case;
use crate::data::study::Study;
use crate::fit::output_error::{Effort, fit};
use crate::model::prior::{FRICTION, N_NOMINAL, to_coordinate};
use crate::specimen;
use motor::effect::{EffectConfig, Role};
use motor::effects::find;
use recording::Channel;

fn study() -> Study {
    specimen::table_study(|_| ())
}

fn saturation(study: &Study) -> EffectConfig {
    let effect = find("magnetizing-saturation", "").expect("in the library");
    let rated = &study.prior.plant.rated;
    let mut config = EffectConfig::absent(effect, rated);
    for (p, value) in effect
        .descriptor()
        .parameters
        .iter()
        .zip(&mut config.values)
    {
        *value = match p.role {
            Role::Size => 1.5 * p.typical * p.scale.of(rated),
            _ => p.grid[0],
        };
    }
    config
}

#[test]
fn values_go_through_coordinates_and_back() {
    let study = study();
    let rated = &study.prior.plant.rated;
    let config = saturation(&study);
    let h = study.at_prior().with(config.clone(), rated);
    let back = h.configs(rated);
    assert_eq!(back.len(), 1);
    for (a, b) in back[0].values.iter().zip(&config.values) {
        assert!((a - b).abs() < 1e-12 * (1.0 + b.abs()), "{a} {b}");
    }
    assert_eq!((h.effect_of(N_NOMINAL), h.parameter_of(N_NOMINAL)), (0, 0));
    for k in N_NOMINAL..h.z.len() {
        assert!(h.free[k]);
        let p = h.parameter(k);
        let (deviation, centre) = h.prior_of(k, &study.prior);
        if p.role == Role::Size {
            // Four typical sizes around nothing.
            assert_eq!((deviation, centre), (4.0, 0.0));
            assert!((h.z[k] - 1.5).abs() < 1e-12);
        } else {
            // A factor of e around the typical shape.
            assert_eq!(deviation, 1.0);
            assert!((centre - (p.typical * p.scale.of(rated)).ln()).abs() < 1e-12);
        }
        let [low, high] = h.bounds(k, &study.prior);
        let expected = p
            .range
            .map(|x| to_coordinate(p, x * p.scale.of(rated), rated));
        assert_eq!([low, high], expected);
    }
}

#[test]
fn nominals_are_factors_and_friction_is_added() {
    let study = study();
    let mut h = study.at_prior();
    h.z = vec![0.1, -0.1, 0.2, -0.2, 0.3, 2.0];
    let (believed, plant) = (&study.prior.plant, h.plant(&study.prior));
    let ratio = |a: f64, b: f64| (a / b).ln();
    let moved = [
        ratio(plant.motor.r_s, believed.motor.r_s),
        ratio(plant.motor.r_r, believed.motor.r_r),
        ratio(plant.motor.l_ls, believed.motor.l_ls),
        ratio(plant.motor.l_m, believed.motor.l_m),
        ratio(plant.mechanics.inertia, believed.mechanics.inertia),
    ];
    for (got, expected) in moved.into_iter().zip(&h.z) {
        assert!((got - expected).abs() < 1e-12);
    }
    assert!(
        (ratio(plant.motor.l_lr, believed.motor.l_lr) - 0.2).abs() < 1e-12,
        "both leakages together"
    );
    // One unit is a hundredth of rated torque at synchronous speed.
    let unit = 0.01 * 1.7 / believed.rated.speed();
    assert!((plant.mechanics.friction - believed.mechanics.friction - 2.0 * unit).abs() < 1e-12);
    assert_eq!(
        plant.mechanics.load_friction,
        believed.mechanics.load_friction
    );
    for k in 0..N_NOMINAL {
        let value = study.prior.nominal_value(k, h.z[k]);
        let all = [
            plant.motor.r_s,
            plant.motor.r_r,
            plant.motor.l_ls,
            plant.motor.l_m,
            plant.mechanics.inertia,
            plant.mechanics.friction,
        ];
        assert!((value - all[k]).abs() < 1e-12 * (1.0 + value));
        let error = study.prior.nominal_error(k, h.z[k], 0.01);
        let slope = (study.prior.nominal_value(k, h.z[k] + 1e-6) - value) / 1e-6;
        assert!((error - 0.01 * slope).abs() < 1e-5 * error.abs(), "{k}");
    }
}

/// Total friction may not drive the shaft; other nominals may change by a factor of five.
#[test]
fn nominals_have_bounds() {
    let study = study();
    let h = study.at_prior();
    assert_eq!(h.bounds(0, &study.prior), [-1.6, 1.6]);
    let [low, _] = h.bounds(FRICTION, &study.prior);
    let least = study.prior.nominal_value(FRICTION, low);
    assert!((least + study.prior.plant.mechanics.load_friction).abs() < 1e-12);
}

#[test]
fn what_cannot_be_seen_is_not_fitted() {
    let table = study().at_prior();
    assert_eq!(table.free, [true, true, true, true, false, false]);
    let free = specimen::study(0.5, |_| 1.0).at_prior();
    assert_eq!(free.free, [true; N_NOMINAL]);
}

#[test]
fn a_model_is_the_same_to_the_last_bit_or_another() {
    let study = study();
    let rated = &study.prior.plant.rated;
    let h = study.at_prior();
    assert!(h.is_same(&h.clone()));
    let mut moved = h.clone();
    moved.z[0] = f64::MIN_POSITIVE;
    let mut held = h.clone();
    held.free[0] = !held.free[0];
    let with = h.with(saturation(&study), rated);
    for other in [&moved, &held, &with] {
        assert!(!h.is_same(other));
    }
    // A form is no coordinate: where the flux saturates.
    let mut form = saturation(&study);
    form.values[2] = 0.5;
    assert!(!with.is_same(&h.with(form, rated)));
    // Formulas have one name, and one formula has several places.
    let formula = |adds_to: &str, text: &str| {
        let prior = specimen::prior(&format!(
            "[[effects]]\nname = \"expression\"\nadds_to = \"{adds_to}\"\nformula = \"{text}\"\nk = 0.0\nk_typical = 0.1\n"
        ));
        let effect = *prior.formulas.first().expect("a candidate");
        h.with(EffectConfig::absent(effect, rated), rated)
    };
    let braked = formula("torque", "k * omega");
    assert!(braked.is_same(&formula("torque", "k * omega")));
    assert!(!braked.is_same(&formula("torque", "k * psi")));
    assert!(!braked.is_same(&formula("voltage_d", "k * omega")));
}

/// A pump takes ten times an ordinary friction and more: a fit gets there in a few iterations.
#[test]
fn what_enters_linearly_goes_far_at_once() {
    let prior = specimen::prior("");
    let torque = 0.5 * prior.plant.rated.torque;
    let recording = specimen::recording(1.0, |_| torque);
    let unseen = vec![0.0; recording.len()];
    let recording = recording
        .with_channel(Channel::TORQUE, unseen)
        .expect("as long as the clock");
    let case = Case::new(&recording, &prior.plant.rated).expect("judged");
    let study = Study::new(prior, case, Vec::new(), None);
    let effort = Effort {
        iterations: 3,
        ..Effort::FULL
    };
    let fit = fit(&study.fitted.case, &study.prior, &study.at_prior(), effort);
    let expected = torque / specimen::point(torque).omega_mech / study.prior.friction_unit;
    let found = fit.hypothesis.z[FRICTION];
    assert!(
        expected > 40.0 && (found / expected - 1.0).abs() < 0.02,
        "{found} {expected}"
    );
}
