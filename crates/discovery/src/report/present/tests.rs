use super::*;
use estimation::model::prior::{INERTIA, MAGNETIZING};
use estimation::specimen;
use std::sync::OnceLock;

const R_S: usize = 0;

/// The priors with nominals moved, each of the fitted ones known to `error`.
fn moved(study: &Study, effects: &[(&str, f64)], z: &[(usize, f64)], error: f64) -> Trial {
    let mut known = specimen::moved(study, effects, z, error);
    // Which of them are off is a question of its own.
    let far = z.iter().filter(|(_, z)| z.abs() > 0.1).map(|(k, _)| *k);
    known.off = OnceLock::from(far.collect::<Vec<_>>());
    known
}

#[test]
fn what_was_not_fitted_has_no_standard_error() {
    let study = specimen::table_study(|_| ());
    let trial = specimen::known_to(&specimen::trial_with(&study, &[]), &[0.1, 0.2, 0.3, 0.4]);
    let error = |k: usize| coordinate_error(&trial, study.covariance(&trial), k);
    for k in 0..4 {
        assert!((error(k) - 0.1 * (k + 1) as f64).abs() < 1e-12);
    }
    assert_eq!((error(INERTIA), error(FRICTION)), (0.0, 0.0));
}

#[test]
fn a_fit_is_reported_in_the_units_of_the_motor_file() {
    let study = specimen::proven_table_study(|_| ());
    let z = [(R_S, 0.2), (MAGNETIZING, -0.04), (FRICTION, 3.0)];
    let trial = moved(&study, &[], &z, 0.01);
    let report = fit_report(&study, &specimen::with_errors(&study, &trial, 1.5, 2.5));
    assert!((report.fold_error_over_noise - 1.5).abs() < 1e-12);
    assert!((report.held_out_error_over_noise - 2.5).abs() < 1e-12);
    assert_eq!(report.parameters.len(), 6);
    let r_s = &report.parameters[R_S];
    assert_eq!(
        (r_s.name.as_str(), r_s.unit.as_str(), r_s.off),
        ("stator_resistance_ohm", "ohm", true)
    );
    let value = 8.0 * 0.2f64.exp();
    let close = |got: f64, expected: f64| (got - expected).abs() < 1e-9 * expected.abs();
    assert!(r_s.believed == 8.0 && close(r_s.value, value));
    assert!(close(r_s.std_error, 0.01 * value));
    assert!(close(r_s.change_percent, 100.0 * (value / 8.0 - 1.0)));
    let l_m = &report.parameters[MAGNETIZING];
    assert!(!l_m.off && close(l_m.change_percent, -100.0 * (1.0 - (-0.04f64).exp())));
    // One per cent of 1.7 N m at 60 pi rad/s.
    let unit = 0.017 / (60.0 * std::f64::consts::PI);
    let friction = &report.parameters[FRICTION];
    assert!(friction.off && friction.believed == 0.0008);
    assert!(close(friction.value, 0.0008 + 3.0 * unit));
    assert!(close(friction.std_error, 0.01 * unit) && friction.change_percent == 3.0);
}

/// Saturation 0.3 (a typical one is 0.2) with exponent 4, and a core loss of a typical 0.02 of the rated admittance,
/// which the file writes as a resistance.
#[test]
fn parameters_of_an_effect_are_reported_as_the_file_writes_them() {
    let study = specimen::table_study(|_| ());
    let mut trial = specimen::trial_with(
        &study,
        &[("magnetizing-saturation", 1.5), ("core-loss", 1.0)],
    );
    trial.fit.hypothesis.z[N_NOMINAL + 1] = 4f64.ln();
    let errors = [0.01, 0.01, 0.01, 0.01, 0.3, 0.05, 0.2];
    let trial = specimen::known_to(&trial, &errors);
    let close = |got: f64, expected: f64| (got - expected).abs() < 1e-9 * expected.abs();

    let saturation = effect_parameters(&study, &trial, 0);
    let names: Vec<&str> = saturation.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(
        names,
        ["saturation", "saturation_exponent", "flux_location"]
    );
    assert!(close(saturation[0].value, 0.3) && close(saturation[0].std_error, 0.3 * 0.2));
    assert!(close(saturation[1].value, 4.0) && close(saturation[1].std_error, 0.05 * 4.0));
    assert_eq!(saturation[2].std_error, 0.0, "a form is chosen, not fitted");

    let loss = effect_parameters(&study, &trial, 1);
    // 220 V and 1.3 A of the nameplate, amplitudes per phase.
    let (volt, ampere) = (220.0 * (2.0f64 / 3.0).sqrt(), 1.3 * 2f64.sqrt());
    let conductance = 0.02 * ampere / volt;
    assert_eq!((loss.len(), loss[0].unit.as_str()), (1, "ohm"));
    assert!(close(loss[0].value, 1.0 / conductance));
    // Relative errors of a number and of its reciprocal are the same.
    assert!(close(loss[0].std_error, 0.2 / conductance));
}

#[test]
fn kinds_of_answer_have_names() {
    let words = [Kind::Physics, Kind::Sensor, Kind::Supply].map(kind_word);
    assert_eq!(words, ["physics", "sensor", "supply"]);
}

/// A typical core loss is 2 % of rated apparent power; a torque of 5 % takes 5 % of rated torque times speed, a windage
/// of 10 % of rated torque at that speed 10 %. What is no loss has no power.
#[test]
fn losses_have_a_power_at_rated_voltage_and_speed() {
    let study = specimen::table_study(|_| ());
    let apparent = 3f64.sqrt() * 220.0 * 1.3;
    let mechanical = 1.7 * 60.0 * std::f64::consts::PI;
    for (name, expected) in [
        ("core-loss", 0.02 * apparent),
        ("coulomb-friction", 0.05 * mechanical),
        ("windage", 0.1 * mechanical),
    ] {
        let trial = specimen::trial_with(&study, &[("current-gain", 3.0), (name, 1.0)]);
        let watt = loss_watt(&study, &trial, 1).expect("a loss");
        assert!(
            (watt / expected - 1.0).abs() < 1e-9,
            "{name}: {watt} {expected}"
        );
        assert_eq!(loss_watt(&study, &trial, 0), None);
    }
}
