use super::*;
use crate::data::study::Study;
use crate::model::prior::{FRICTION, MAGNETIZING};
use crate::specimen;

#[test]
fn a_table_of_the_believed_machine_moves_nothing() {
    let study = specimen::table_study(|_| ());
    let fit = fit(
        &study.fitted.case,
        &study.prior,
        &study.at_prior(),
        Effort::FULL,
    );
    assert!(
        fit.hypothesis.z.iter().all(|z| z.abs() < 1e-4),
        "{:?}",
        fit.hypothesis.z
    );
    assert!(signal::dot(&fit.residual, &fit.residual) < 1e-4);
}

/// By how much the motor of [`study_of_another_motor`] differs from what is believed, logarithms: both resistances, leakage, magnetizing.
const TRUTH: [f64; 4] = [0.06, -0.05, 0.04, 0.03];

/// A table of a motor whose parameters differ by some per cent.
fn study_of_another_motor() -> Study {
    specimen::table_study(|plant| {
        plant.motor.r_s *= f64::exp(TRUTH[0]);
        plant.motor.r_r *= f64::exp(TRUTH[1]);
        plant.motor.l_ls *= f64::exp(TRUTH[2]);
        plant.motor.l_lr *= f64::exp(TRUTH[2]);
        plant.motor.l_m *= f64::exp(TRUTH[3]);
    })
}

/// Parameters that differ by some per cent are found: the table is exact, the priors are wide.
#[test]
fn a_fit_finds_the_parameters_behind_a_table() {
    let study = study_of_another_motor();
    let (case, prior) = (&study.fitted.case, &study.prior);
    let fit = fit(case, prior, &study.at_prior(), Effort::FULL);
    for k in [0, 1, MAGNETIZING] {
        let z = fit.hypothesis.z[k];
        assert!((z - TRUTH[k]).abs() < 0.02, "{k}: {z}");
    }
    assert_eq!(fit.hypothesis.z[FRICTION], 0.0, "not fitted from a table");
    assert_eq!(fit.free, [0, 1, 2, 3]);
    // What is returned belongs together: residual, outputs and columns at the best coordinates.
    let out = outputs(case, prior, &fit.hypothesis, SpeedObserver::Off);
    assert_eq!(out, fit.outputs);
    assert_eq!(residual(case, &out), fit.residual);
    let variance = crate::fit::uncertainty::covariance(&study, &fit);
    assert!((0..4).all(|k| variance[(k, k)] > 0.0 && variance[(k, k)] < 0.11));
    assert_eq!(fit.held_out().len(), 12);
}

/// The optimum of squared error and priors: no gradient is left, `J' r + W p = 0`.
#[test]
fn the_best_coordinates_have_no_gradient() {
    let study = specimen::table_study(|plant| plant.motor.l_m *= 1.05);
    let fit = fit(
        &study.fitted.case,
        &study.prior,
        &study.at_prior(),
        Effort::FULL,
    );
    let all = normal_equations::total(&fit.blocks);
    let gradient = &all.score + fit.penalty.weight.component_mul(&fit.penalty.pull);
    for (k, g) in gradient.iter().enumerate() {
        let scale = (all.gram[(k, k)] + fit.penalty.weight[k]).sqrt();
        assert!(g.abs() < 0.02 * scale, "{k}: {g} {scale}");
    }
}

/// Priors: one over the squared deviation, `inflation` times for nominals; the pull leads back to the prior.
#[test]
fn a_penalty_is_the_prior_seen_from_where_one_is() {
    let study = specimen::table_study(|_| ());
    let mut h = study.at_prior();
    h.z[1] = 0.25;
    let p = penalty(&study.prior, &h, &[0, 1], 30.0);
    assert!((p.weight[0] - 30.0 / 0.01).abs() < 1e-9 && (p.weight[1] - 30.0 / 0.01).abs() < 1e-9);
    assert_eq!((p.pull[0], p.pull[1]), (0.0, -0.25));
    let expected = 9.0 + 4.0 + 3000.0 * 0.0625;
    assert!((cost(&[3.0, -2.0], &p) - expected).abs() < 1e-9);
    assert_eq!(cost(&[f64::NAN], &p), f64::INFINITY);
}

#[test]
fn a_step_is_limited_and_stays_inside_the_bounds() {
    let study = specimen::table_study(|_| ());
    let mut h = study.at_prior();
    h.z[0] = 1.0;
    let step = DVector::from_column_slice(&[1.2, -9.0]);
    let next = moved(&study.prior, &h, &[0, 1], &step);
    // A factor of e^1.6 at most, and 1.5 at a time.
    assert_eq!((next.z[0], next.z[1]), (1.6, -1.5));
    assert_eq!(next.z[2..], h.z[2..]);
}

/// Derivatives of elsewhere lead one step: where they point the wrong way none is taken, and the parameters are found all the same.
#[test]
fn a_fit_arrives_whatever_is_known_nearby() {
    let study = study_of_another_motor();
    let (case, prior, start) = (&study.fitted.case, &study.prior, study.at_prior());
    let here = fit(case, prior, &start, Effort::NONE).jacobian;
    for (factor, count) in [(1.0, 4), (0.7, 2), (-1.0, 4), (0.0, 3)] {
        let times = |column: &Vec<f64>| column.iter().map(|x| factor * x).collect();
        let nearby: Vec<Vec<f64>> = here.iter().take(count).map(times).collect();
        let found = fit_near(case, prior, &start, Effort::FULL, &nearby).hypothesis;
        for k in [0, 1, MAGNETIZING] {
            assert!((found.z[k] - TRUTH[k]).abs() < 0.02, "{factor}: {found:?}");
        }
    }
}
