use super::*;
use crate::model::prior::{INERTIA, LEAKAGE};
use crate::specimen;
use std::sync::OnceLock;

const R_S: usize = 0;
const R_R: usize = 1;

/// Nominals that moved relevantly and significantly and are known.
fn off(study: &Study, trial: &Trial) -> Vec<usize> {
    (0..N_NOMINAL)
        .filter(|&k| super::moved(study, trial, k))
        .collect()
}

/// Five per cent, up and down; a factor of `e^0.05` is 5.1 %, one of `e^-0.05` only 4.9 %.
#[test]
fn a_nominal_is_off_beyond_five_per_cent() {
    let study = specimen::table_study(|_| ());
    let of = |z: f64| off(&study, &specimen::moved(&study, &[], &[(R_R, z)], 1e-6));
    assert_eq!(of(0.05), [R_R]);
    assert_eq!(of(-0.052), [R_R]);
    for z in [0.0, 0.048, -0.048, -0.05] {
        assert!(of(z).is_empty(), "{z}");
    }
}

/// Three standard errors; as many are not more than as many.
#[test]
fn a_nominal_is_off_beyond_three_standard_errors() {
    let study = specimen::table_study(|_| ());
    let of = |z: f64, error: f64| off(&study, &specimen::moved(&study, &[], &[(R_S, z)], error));
    assert_eq!(of(0.09, 0.029), [R_S]);
    assert_eq!(of(-0.09, 0.029), [R_S]);
    assert!(of(0.09, 0.0301).is_empty() && of(-0.09, 0.0301).is_empty());
    assert!(of(0.09375, 0.03125).is_empty(), "powers of two are exact");
}

/// Its coordinate is per cent of rated torque.
#[test]
fn friction_is_off_beyond_two_per_cent_of_rated_torque() {
    let study = specimen::table_study(|_| ());
    let of = |z: f64, error: f64| {
        off(
            &study,
            &specimen::moved(&study, &[], &[(FRICTION, z)], error),
        )
    };
    assert_eq!(of(2.1, 0.1), [FRICTION]);
    assert_eq!(of(-2.1, 0.1), [FRICTION]);
    assert!(of(2.0, 0.1).is_empty() && of(0.5, 0.1).is_empty());
    assert!(of(2.1, 0.71).is_empty());
}

/// With saturation the inductance is that of rated flux, about which there is no prior.
#[test]
fn beside_saturation_the_inductance_may_be_another() {
    let study = specimen::table_study(|_| ());
    let z = [(MAGNETIZING, 0.4), (LEAKAGE, 0.4)];
    let of = |effect: &str| off(&study, &specimen::moved(&study, &[(effect, 1.0)], &z, 0.01));
    assert_eq!(of("core-loss"), [LEAKAGE, MAGNETIZING]);
    assert_eq!(of("magnetizing-saturation"), [LEAKAGE]);
}

/// A tenth of the prior's variance: an error of 0.0316 beside a prior of 0.1.
#[test]
fn what_the_recording_leaves_open_is_not_off() {
    let study = specimen::table_study(|_| ());
    let of = |error: f64| off(&study, &specimen::moved(&study, &[], &[(R_R, 0.4)], error));
    assert_eq!(of(0.0315), [R_R]);
    assert!(of(0.0318).is_empty());
}

/// A table over all loads shows a rotor resistance of 1.25 times the believed one, and that nothing else is off.
#[test]
fn a_parameter_that_the_data_need_is_off_and_the_others_are_not() {
    let study = specimen::table_study(|plant| plant.motor.r_r *= 1.25);
    let trial = study.trial(&study.at_prior(), Effort::FULL);
    assert_eq!(nominals(&study, &trial), [R_R]);
    let healthy = specimen::table_study(|_| ());
    let trial = healthy.trial(&healthy.at_prior(), Effort::FULL);
    assert!(nominals(&healthy, &trial).is_empty());
}

/// Held at its prior a parameter has not moved, and is not fitted; the others are.
#[test]
fn a_held_parameter_stays_at_its_prior() {
    let study = specimen::table_study(|plant| plant.motor.r_r *= 1.25);
    let trial = study.trial(&study.at_prior(), Effort::FULL);
    let held = held(&study, &trial, R_R);
    assert_eq!(held.fit.hypothesis.z[R_R], 0.0);
    assert_eq!(held.fit.free, [R_S, LEAKAGE, MAGNETIZING]);
    assert!(strains(&held, &study.prior.deviations) > 0.0);
}

/// Prior deviations: 0.1 for windings and iron, 0.2 for the inertia, 10 % of rated torque for friction.
#[test]
fn strain_is_counted_in_prior_deviations() {
    let study = specimen::table_study(|_| ());
    let trial = specimen::moved(
        &study,
        &[],
        &[(R_S, 0.3), (4, 0.4), (FRICTION, -10.0)],
        0.01,
    );
    assert!((strains(&trial, &study.prior.deviations) - (9.0 + 4.0 + 1.0)).abs() < 1e-12);
}

/// Three prior deviations: 30 % for windings and iron, 60 % for the inertia; copper may be hotter, ln 1.51 more.
#[test]
fn no_motor_is_three_prior_deviations_away() {
    let study = specimen::table_study(|_| ());
    let far = |k: usize, z: f64| {
        let mut moved = specimen::moved(&study, &[], &[(k, z)], 0.01);
        // Which of them are off is a question of its own.
        moved.off = OnceLock::from(vec![k]);
        implausible(&study, &moved)
    };
    for (k, low, high) in [
        (R_S, -0.3, 0.71),
        (R_R, -0.3, 0.71),
        (LEAKAGE, -0.3, 0.3),
        (MAGNETIZING, -0.3, 0.3),
        (INERTIA, -0.6, 0.6),
    ] {
        assert_eq!(far(k, low - 0.01), [k]);
        assert_eq!(far(k, high + 0.01), [k]);
        assert!(far(k, low + 0.01).is_empty() && far(k, high - 0.01).is_empty());
    }
    assert!(far(FRICTION, 500.0).is_empty(), "friction may be anything");
}
