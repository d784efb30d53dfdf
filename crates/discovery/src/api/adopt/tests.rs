//! What is adopted, and what the new motor file says.

use super::*;
use estimation::specimen::{self, apparent_power, with};
use recording::{Recording, Source};

/// A typical core loss of the table's machine is adopted; the rest of the motor file stays as it is.
#[test]
fn an_adopted_effect_is_in_the_new_motor_file() {
    let mut motor = specimen::motor("");
    motor.mechanics.load_friction = 3e-4;
    let sources = [specimen::table_source(|plant| {
        plant.mechanics.load_friction = 3e-4;
        with("core-loss", 2.0)(plant);
    })];
    let mut told = Vec::new();
    let (report, file) = adopt("core-loss", &sources, &motor, &mut |what, share| {
        told.push((what.to_owned(), share));
    })
    .expect("adopted");
    assert!(report.proven);
    assert_eq!(report.effect, "core-loss");
    assert!(report.before.error_over_noise > 2.0 && report.after.error_over_noise < 0.1);
    let held_out = [report.before, report.after].map(|e| e.held_out_error_over_noise);
    assert!(held_out[0] > 2.0 && held_out[1] < 0.1);
    let [parameter] = &report.parameters[..] else {
        panic!("one parameter: {:?}", report.parameters);
    };
    assert_eq!(
        (parameter.name.as_str(), report.nominals.len()),
        ("core_loss_resistance_ohm", 6)
    );
    let expected = 220.0f64.powi(2) / (0.04 * apparent_power());
    assert!(
        (parameter.value / expected - 1.0).abs() < 0.02,
        "{parameter:?}"
    );
    let [entry] = &file.effects[..] else {
        panic!("one effect: {:?}", file.effects);
    };
    assert_eq!(
        (entry.name.as_str(), entry.number(&parameter.name)),
        ("core-loss", Some(parameter.value))
    );
    assert_eq!(
        file.mechanics.load_friction, 3e-4,
        "the load's friction is no finding"
    );
    assert_eq!(file.parameters.r_s, report.nominals[0].value);
    assert_eq!(told.last(), Some(&("done".to_owned(), 1.0)));
    assert!(told.iter().map(|t| t.1).collect::<Vec<_>>()[2..].is_sorted());
    assert!(report.frame.is_none() && report.motor_file.is_empty());
}

/// A stator resistance that is 10 % higher: taken over without any effect, which proves nothing.
#[test]
fn parameters_alone_can_be_adopted() {
    let sources = [specimen::table_source(|plant| plant.motor.r_s *= 1.1)];
    let motor = specimen::motor("");
    let (report, file) = adopt("parameters", &sources, &motor, &mut |_, _| {}).expect("adopted");
    assert!(report.proven && report.parameters.is_empty() && file.effects.is_empty());
    let [before, after] = [&report.before, &report.after].map(|e| e.held_out_error_over_noise);
    assert!(before > 1.5 * after, "{before} {after}");
    assert!(
        (file.parameters.r_s / 8.8 - 1.0).abs() < 0.02,
        "{}",
        file.parameters.r_s
    );
    assert_eq!(report.nominals[0].value, file.parameters.r_s);
}

/// The motor file is right: refitting it gains nothing.
#[test]
fn parameters_that_are_right_gain_nothing() {
    let sources = [specimen::table_source(|_| ())];
    let motor = specimen::motor("");
    let (report, _) = adopt("parameters", &sources, &motor, &mut |_, _| {}).expect("fitted");
    assert!(!report.proven);
    assert!(report.nominals.iter().all(|p| !p.off));
}

#[test]
fn an_effect_that_is_not_there_is_not_proven() {
    let sources = [specimen::table_source(|_| ())];
    let motor = specimen::motor("");
    let (report, _) = adopt("windage", &sources, &motor, &mut |_, _| {}).expect("adopted");
    assert!(!report.proven);
    let error = adopt("series-inductance", &sources, &motor, &mut |_, _| {}).err();
    let error = error.expect("a table does not show it").to_string();
    assert_eq!(
        error,
        "`series-inductance` does not apply to this recording"
    );
}

#[test]
fn a_name_is_known_new_or_a_formula_in_the_file() {
    let entry = |name: &str, line: &str| format!("[[effects]]\nname = \"{name}\"\n{line}\n");
    let formula = entry(
        "expression",
        "formula = \"k * omega\"\nadds_to = \"torque\"\nk = 0.0\nk_typical = 1e-3",
    );
    let windage = entry("windage", "windage_nm_s2 = 1e-6");
    let (plain, holding) = (specimen::motor(""), specimen::motor(&(formula + &windage)));
    let complaint = |effect: &str, motor: &MotorFile| match check_name(effect, motor) {
        Ok(()) => String::new(),
        Err(Error::UnknownEffect(message)) => message,
        Err(other) => panic!("another error: {other:?}"),
    };
    for known in [
        "windage",
        "core-loss",
        "parameters",
        "law",
        "rotor-flux-frame",
    ] {
        assert_eq!(complaint(known, &plain), "");
    }
    assert_eq!(complaint("core-loss", &holding), "");
    assert_eq!(complaint("expression", &holding), "");
    assert!(
        complaint("expression", &plain).contains("write the formula into the motor file first")
    );
    assert!(complaint("windage", &holding).contains("already holds `windage`"));
    let unknown = complaint("phlogiston", &plain);
    assert!(
        unknown.starts_with("no effect is called `phlogiston`; use one of: "),
        "{unknown}"
    );
    assert!(
        unknown.ends_with("expression, rotor-flux-frame, law, parameters"),
        "{unknown}"
    );
}

#[test]
fn a_formula_is_open_while_all_its_parameters_are_zero() {
    let open = |numbers: &[(&'static str, f64)]| {
        is_open(&EffectEntry::with_numbers(
            "expression",
            numbers.iter().copied(),
        ))
    };
    assert!(open(&[("k", 0.0), ("k_typical", 1e-3)]) && open(&[("k", 0.0), ("c", 0.0)]));
    assert!(!open(&[("k", 1e-9), ("k_typical", 1e-3)]) && !open(&[("k", 0.0), ("c", 1.0)]));
}

/// A torque `k w^2` is a windage: the formula finds its size; what is in force or still open stays as it is.
#[test]
fn an_open_formula_is_replaced_by_the_fitted_one() {
    let formula = |text: &str, k: &str| {
        format!(
            "[[effects]]\nname = \"expression\"\nformula = \"{text}\"\nadds_to = \"torque\"\n{k}\n"
        )
    };
    let rest = formula("k * omega^2", "k = 0.0\nk_typical = 4e-6")
        + &formula("c * omega", "c = 1e-9")
        + &formula("k * t", "k = 0.0\nk_typical = 1.0");
    let motor = specimen::motor(&rest);
    let sources = [specimen::table_source(with("windage", 1.0))];
    let (_, file) = adopt("expression", &sources, &motor, &mut |_, _| {}).expect("adopted");
    let formula = |e: &EffectEntry| e.text("formula").map(str::to_owned);
    let formulas: Vec<_> = file.effects.iter().filter_map(formula).collect();
    assert_eq!(formulas, ["c * omega", "k * t", "k * omega^2"]);
    let numbers = [("c", 0), ("k", 1), ("k", 2)].map(|(key, at)| file.effects[at].number(key));
    assert_eq!(numbers[..2], [Some(1e-9), Some(0.0)]);
    let windage = 0.1 * 1.7 / (60.0 * std::f64::consts::PI).powi(2);
    let k = numbers[2].expect("fitted");
    assert!((k / windage - 1.0).abs() < 0.03, "{k} {windage}");
    // Another effect leaves the formula open.
    let (_, file) = adopt("windage", &sources, &motor, &mut |_, _| {}).expect("adopted");
    let names: Vec<&str> = file.effects.iter().map(|e| e.name.as_str()).collect();
    assert_eq!(names, ["expression", "expression", "expression", "windage"]);
    assert!(is_open(&file.effects[0]));
}

/// Twelve windows of five periods at one load, the voltage on the q axis.
fn steady() -> Recording {
    specimen::recording(1.0, |_| 1.2)
}

#[test]
fn the_frame_is_adopted_into_the_monitors_settings_only() {
    let sources = [Source::Recording(steady())];
    let published = specimen::motor("[monitor]\nframe = \"voltage\"\n");
    let (report, file) =
        adopt("rotor-flux-frame", &sources, &published, &mut |_, _| {}).expect("adopted");
    let frame = report.frame.expect("judged");
    assert_eq!(
        (report.effect.as_str(), report.proven),
        ("rotor-flux-frame", frame.proven)
    );
    assert_eq!(report.before.error_over_noise, frame.fitted_before);
    assert_eq!(
        report.before.held_out_error_over_noise,
        frame.held_out_before
    );
    assert_eq!(report.after.error_over_noise, frame.fitted_after);
    assert_eq!(report.after.held_out_error_over_noise, frame.held_out_after);
    assert!(frame.fitted_before > 2.0 * frame.fitted_after, "{frame:?}");
    let mut expected = published.clone();
    (expected.monitor.frame, expected.monitor.field_current) =
        (Frame::RotorFlux, FieldCurrent::Live);
    assert_eq!(file, expected);
    let error = adopt("rotor-flux-frame", &sources, &file, &mut |_, _| {}).err();
    let error = error.expect("it is right already").to_string();
    assert!(
        error.contains("already asks for the rotor-flux frame"),
        "{error}"
    );
}

/// The scale belongs to the recording: it is reported, and the motor file does not get it.
#[test]
fn the_scale_of_a_sensor_is_reported_and_not_adopted() {
    let study = specimen::scaled_study(0.4, 0.4);
    let trial = specimen::trial_with(&study, &[("core-loss", 1.0)]);
    let scale = speed_scale_report(&study, &trial).expect("free");
    // The least slip counts as none until the fit tells.
    let point = specimen::point(1.0);
    let expected = point.omega_sync / point.omega_el / 0.4;
    assert!(
        (scale.factor / expected - 1.0).abs() < 1e-3,
        "{scale:?} {expected}"
    );
    let file = updated(&study, &trial, &specimen::motor(""));
    let names: Vec<&str> = file.effects.iter().map(|e| e.name.as_str()).collect();
    assert_eq!(names, ["core-loss"]);
    let known = specimen::table_study(|_| ());
    assert!(speed_scale_report(&known, &specimen::trial_with(&known, &[])).is_none());
}

/// Only a law has formulas; that is said before any recording is looked at.
#[test]
fn a_formula_of_an_effect_is_refused() {
    let laws = Laws {
        formula: Some(1),
        ..Laws::default()
    };
    let error = adopt_with("windage", &[], &specimen::motor(""), laws, &mut |_, _| {}).err();
    let message = error.map(|e| e.to_string()).unwrap_or_default();
    assert!(message.contains("leave --formula out"), "{message}");
}
