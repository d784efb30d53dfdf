use super::*;
use estimation::specimen;
use motor::effect::Timeline;
use std::sync::Arc;

const R_R: usize = 1;
/// Typical size of the sensor's gain: its coordinate counts half per cents.
const UNIT: f64 = 0.005;

/// Slip at rated torque: `T R_r / (3/2 n_p psi^2 w)`, with the numbers of the specimen's nameplate.
fn expected_slip() -> f64 {
    let omega = 120.0 * std::f64::consts::PI;
    let flux = 220.0 * (2.0f64 / 3.0).sqrt() / omega;
    1.7 * 7.0 / (3.0 * flux * flux * omega)
}

/// Standard deviation of a slip anywhere between none and that at rated torque.
fn physical() -> f64 {
    expected_slip() / 12f64.sqrt()
}

/// A trial with these normal equations, one block, and this error over noise.
fn trial_of(study: &Study, effects: &[(&str, f64)], gram: DMatrix<f64>, error: f64) -> Trial {
    let mut trial = specimen::trial_with(study, effects);
    let n = trial.fit.free.len();
    trial.fit.blocks = vec![normal_equations::Block {
        gram,
        score: DVector::zeros(n),
        sse: 0.0,
    }];
    specimen::with_errors(study, &trial, error, 1.0)
}

/// Diagonal normal equations of six nominals and the scale, the rotor resistance and the scale correlated.
fn correlated(diagonal: f64, scale: f64, cross: f64) -> DMatrix<f64> {
    let mut gram = DMatrix::from_diagonal_element(N_NOMINAL + 1, N_NOMINAL + 1, diagonal);
    gram[(N_NOMINAL, N_NOMINAL)] = scale;
    gram[(R_R, N_NOMINAL)] = cross;
    gram[(N_NOMINAL, R_R)] = cross;
    gram
}

fn close(got: f64, expected: f64) {
    assert!((got / expected - 1.0).abs() < 1e-9, "{got} {expected}");
}

#[test]
fn the_slip_at_rated_torque_follows_from_the_rotor_resistance() {
    close(rated_slip(&specimen::prior("")), expected_slip());
}

/// Thirty rows count as one at least; priors are a factor of e for nominals, ten per cent of rated torque for friction,
/// what physics leaves open for the scale and four typical sizes for an effect.
#[test]
fn precision_is_what_the_rows_tell_and_the_weak_priors() {
    let study = specimen::scaled_study(0.4, 1.0);
    let n = N_NOMINAL + 2;
    let gram = DMatrix::from_element(n, n, 60.0);
    let trial = trial_of(&study, &[("core-loss", 1.0)], gram, 1.0);
    let got = precision(&study, &trial.fit, 2.0);
    let weights = [1.0, 1.0, 1.0, 1.0, 1.0, 0.01, 0.25, 1.0 / 16.0];
    for a in 0..n {
        for b in 0..n {
            let expected = 2.0 + if a == b { weights[a] } else { 0.0 };
            assert!((got[(a, b)] - expected).abs() < 1e-12, "{a} {b}");
        }
    }
}

/// Scores of two blocks that differ by `2 s` spread by `2 s^2`; over the precision that is how many rows count as one.
/// The median of the six nominals decides, not the scale's own.
#[test]
fn rows_count_less_where_blocks_disagree() {
    let study = specimen::scaled_study(0.4, 1.0);
    let mut trial = trial_of(&study, &[], correlated(600.0, 600.0, 0.0), 1.0);
    let inflation = [35.0, 70.0, 40.0, 65.0, 45.0, 60.0, 0.0];
    let scores = inflation.map(|ratio| f64::sqrt(ratio * 600.0 / 2.0));
    let half = |sign: f64| normal_equations::Block {
        gram: correlated(300.0, 300.0, 0.0),
        score: DVector::from_iterator(7, scores.iter().map(|s| sign * s)),
        sse: 0.0,
    };
    trial.fit.blocks = vec![half(1.0), half(-1.0)];
    // Of 35, 40, 45, 60, 65 and 70 the fourth.
    close(
        precision(&study, &trial.fit, 1.0)[(0, 0)],
        600.0 / 60.0 + 1.0,
    );
}

/// Two coordinates by hand: with a precision of `[[a, c], [c, s]]` the scale keeps `s - c^2/a`, and the resistance moves
/// by `-c/a` with it.
#[test]
fn the_scale_widens_what_moves_with_it() {
    let study = specimen::scaled_study(0.4, 1.0);
    let trial = trial_of(
        &study,
        &[],
        correlated(30.0 * 399.0, 30.0 * 90.0, 30.0 * -150.0),
        1.0,
    );
    let uncertainty = Uncertainty::of(&study, &trial);
    let (a, c) = (400.0, -150.0);
    let s = 90.0 + (UNIT / physical()).powi(2);
    let scale = 1.0 / f64::sqrt(s - c * c / a);
    close(uncertainty.of_scale(), scale * UNIT);
    assert_eq!(uncertainty.source(), ErrorSource::Recording);
    let [known, added] = uncertainty.of_coordinate(R_R);
    close(known, 1.0 / 20.0);
    close(added, 150.0 / 400.0 * scale);
    let [known, added] = uncertainty.of_coordinate(0);
    close(known, 1.0 / 20.0);
    assert_eq!(added, 0.0);
    close(
        uncertainty.of_coordinate(FRICTION)[0],
        1.0 / 399.01f64.sqrt(),
    );
    assert_eq!(
        uncertainty.of_coordinate(N_NOMINAL),
        [0.0, 0.0],
        "it is the scale itself"
    );
}

#[test]
fn a_model_that_does_not_explain_knows_the_scale_as_physics_does() {
    let study = specimen::scaled_study(0.4, 1.0);
    let trial = trial_of(&study, &[], correlated(3e4, 3e9, 0.0), 2.0);
    let uncertainty = Uncertainty::of(&study, &trial);
    close(uncertainty.of_scale(), physical());
    assert_eq!(uncertainty.source(), ErrorSource::Physics);
}

/// Independent errors add in squares; the reading at rest counts as a share of the speed.
#[test]
fn an_uncertain_reading_at_rest_adds_to_the_scale() {
    let mut study = specimen::scaled_study(0.4, 1.0);
    let trial = trial_of(&study, &[], correlated(3e4, 3e9, 0.0), 2.0);
    let scale = study.speed_scale.as_mut().expect("free");
    scale.at_rest_error = 0.8;
    let rest = 0.8 * scale.factor / (60.0 * std::f64::consts::PI);
    let got = Uncertainty::of(&study, &trial).of_scale();
    close(got, (physical().powi(2) + rest * rest).sqrt());
}

/// Coordinates `others`, each known to `known` beside a known scale and moved by `added` with the free one.
fn uncertain(others: &[usize], known: f64, added: f64) -> Uncertainty {
    let n = others.len();
    Uncertainty {
        known: DMatrix::from_diagonal_element(n, n, known * known),
        moves: DVector::from_element(n, added / 2.0),
        scale: 2.0,
        told: true,
        others: others.to_vec(),
        unit: UNIT,
    }
}

/// From 2 % to 5 %: the hypotenuse of 2 and -4.58.
#[test]
fn a_parameter_is_open_when_the_scale_more_than_doubles_a_relevant_error() {
    let added = -(0.05f64 * 0.05 - 0.02 * 0.02).sqrt();
    let open = parameter(&uncertain(&[R_R], 0.02, added), R_R).expect("open");
    assert_eq!(
        (open.name.as_str(), open.kind.as_str()),
        ("rotor_resistance_ohm", "parameter")
    );
    close(open.std_error_percent.expect("an error"), 5.0);
    close(
        open.std_error_with_known_scale_percent.expect("an error"),
        2.0,
    );
    close(open.correlation_with_scale.expect("one"), added / 0.05);
    assert_eq!(
        open.why,
        "known to 5.0 % only; beside a known scale it would be 2.0 % (correlation -0.92)"
    );
    let is_open = |known: f64, error: f64| {
        let added = (error * error - known * known).sqrt();
        parameter(&uncertain(&[R_R], known, added), R_R).is_some()
    };
    assert!(
        is_open(0.02, 0.041) && !is_open(0.02, 0.039),
        "twice as uncertain"
    );
    // Three standard errors against 5 %.
    assert!(is_open(0.004, 0.017) && !is_open(0.004, 0.016));
    assert!(
        parameter(&uncertain(&[R_R], 0.02, added), 0).is_none(),
        "it was not fitted"
    );
}

#[test]
fn a_factor_of_e_is_no_knowledge() {
    let open = parameter(&uncertain(&[R_R], 0.3, 1.2), R_R).expect("open");
    assert_eq!(
        open.why,
        "not known at all; beside a known scale it would be to 30.0 % (correlation +0.97)"
    );
    let barely = parameter(&uncertain(&[R_R], 0.3, 0.9), R_R).expect("open");
    assert!(
        barely.why.starts_with("known to 94.9 % only"),
        "{}",
        barely.why
    );
}

/// Its coordinate is per cent of rated torque: two of them are relevant, and any error of it is a number.
#[test]
fn friction_is_open_in_per_cent_of_rated_torque() {
    let of = |known: f64, added: f64| parameter(&uncertain(&[FRICTION], known, added), FRICTION);
    let open = of(0.5, 1.2).expect("open");
    close(open.std_error_percent.expect("an error"), 1.3);
    assert_eq!(
        open.why,
        "known to 1.3 % of rated torque only; beside a known scale it would be 0.5 % of rated torque \
         (correlation +0.92)"
    );
    // Three times 0.65 are less than 2, three times 0.7 are more.
    assert!(of(0.25, 0.6).is_none() && of(0.25, 0.654).is_some());
}

/// Ten blocks with slips of 1 to 10 %: at most a tenth of them may exceed the largest. A block at rest does not run.
#[test]
fn the_largest_slip_is_that_of_steady_running() {
    let mut study = specimen::scaled_study(0.4, 1.0);
    let case = specimen::waveform_mut_of(&mut study);
    let omega = 120.0 * std::f64::consts::PI;
    let samples = case.speed.len();
    // The last block is a little longer.
    let block = 2 * case.block;
    assert_eq!((samples / block, case.blocks().len()), (10, 10));
    case.timeline = Arc::new(Timeline {
        t_sample: specimen::T_SAMPLE,
        omega_sync: vec![omega; samples],
        theta_mech: Vec::new(),
        cuts: Vec::new(),
    });
    let slip_at = |k: usize| 0.01 * ((7 * (k / block).min(9)) % 10 + 1) as f64;
    case.speed = (0..samples)
        .map(|k| (1.0 - slip_at(k)) * omega / 2.0)
        .collect();
    let trial = specimen::trial_with(&study, &[]);
    let found = slip(&study, &trial, 0.01).expect("open");
    assert_eq!(
        (found.name.as_str(), found.kind.as_str()),
        ("slip", "quantity")
    );
    close(
        found.std_error_percent.expect("an error"),
        100.0 * 0.91 * 0.01 / 0.09,
    );
    assert_eq!(found.std_error_with_known_scale_percent, Some(0.0));
    assert_eq!(
        found.why,
        "the largest slip is 9.00 +- 0.91 %, and with it the loss in the rotor's bars"
    );
    // Three standard errors against 5 %: of 0.09 that is 0.0015.
    assert!(slip(&study, &trial, 0.00166).is_some() && slip(&study, &trial, 0.00164).is_none());
    // The sensor shows 1 % too much: every slip is larger by nearly one per cent.
    let mut fast = trial.clone();
    fast.fit.hypothesis.z[N_NOMINAL] = 0.01 / UNIT;
    let more = 1.0 - 0.91 / 1.01;
    let percent = slip(&study, &fast, 0.01).and_then(|s| s.std_error_percent);
    close(percent.expect("open"), 100.0 * (1.0 - more) * 0.01 / more);
    let case = specimen::waveform_mut_of(&mut study);
    case.speed[3 * block..4 * block].fill(0.0);
    case.speed[..block].fill(0.75 * omega / 2.0);
    // Without those of 1, 2 and, from the standstill and the start, none: eight are left, the largest is 9 %.
    let rest = slip(&study, &trial, 0.01).expect("open");
    assert!(
        rest.why.starts_with("the largest slip is 9.00 "),
        "{}",
        rest.why
    );
    case_at_rest(&mut study);
    assert!(slip(&study, &trial, 0.01).is_none(), "it never runs");
}

fn case_at_rest(study: &mut Study) {
    specimen::waveform_mut_of(study).speed.fill(0.0);
}

/// An effect that a typical size raises the error by these shares of the noise, with the scale free and known.
fn seen(study: &Study, name: &str, free: f64, known: Option<f64>) -> Screened {
    let expected = study.fitted.floor.mean * study.fitted.case.judged();
    let squares = |share: f64| ((1.0 + share) * (1.0 + share) - 1.0) * expected;
    Screened {
        config: specimen::effect(name, 1.0),
        held_out: Vec::new(),
        possible: true,
        visible: squares(free),
        visible_with_known_scale: known.map(squares),
    }
}

#[test]
fn an_effect_is_hidden_by_the_scale_when_only_a_known_one_would_show_it() {
    let study = specimen::scaled_study(0.4, 1.0);
    let screened = [
        seen(&study, "windage", 0.01, Some(0.05)),
        seen(&study, "core-loss", 0.03, Some(0.05)),
        seen(&study, "deep-bar", 0.01, Some(0.015)),
        seen(&study, "current-gain", 0.01, None),
        // Two points of one grid: the best of each counts.
        seen(&study, "leakage-saturation", 0.01, Some(0.05)),
        seen(&study, "leakage-saturation", 0.03, Some(0.01)),
        seen(&study, "voltage-gain", 0.01, Some(0.001)),
        seen(&study, "voltage-gain", 0.001, Some(0.03)),
    ];
    let hidden = effects(&study, &screened);
    let names: Vec<&str> = hidden.iter().map(|h| h.name.as_str()).collect();
    assert_eq!(names, ["voltage-gain", "windage"]);
    assert_eq!(hidden[1].kind, "effect");
    assert_eq!(
        hidden[1].why,
        "a typical size shows 1.0 % of the noise beside a free scale, 5.0 % beside a known one"
    );
    assert!(hidden[0].why.contains("shows 1.0 %") && hidden[0].why.contains("3.0 %"));
}

#[test]
fn everything_open_is_listed_parameters_first() {
    let mut study = specimen::scaled_study(0.4, 1.0);
    let gram = correlated(30.0 * 399.0, 30.0 * 9000.0, 30.0 * -1500.0);
    let mut trial = trial_of(&study, &[], gram, 1.0);
    // The scale of the study takes the least slip for none.
    let point = specimen::point(1.0);
    let gain = point.omega_sync / point.omega_el;
    trial.fit.hypothesis.z[N_NOMINAL] = (gain - 1.0) / UNIT;
    let screened = [seen(&study, "windage", 0.01, Some(0.05))];
    let all = list(&study, &trial, &screened);
    let names: Vec<&str> = all.iter().map(|x| x.name.as_str()).collect();
    // The scale is known to a hundredth of a per cent, which is little of a slip of 3 %.
    assert_eq!(names, ["speed-scale", "windage"]);
    assert!(all[0].kind == "effect" && all[0].why.contains("part of the fitted scale"));
    let loose = trial_of(
        &study,
        &[],
        correlated(30.0 * 399.0, 30.0, 30.0 * -19.9),
        2.0,
    );
    let names: Vec<String> = list(&study, &loose, &[])
        .into_iter()
        .map(|x| x.name)
        .collect();
    assert!(
        names.contains(&"slip".to_owned()) && names.contains(&"speed-scale".to_owned()),
        "{names:?}"
    );
    study.speed_scale = None;
    assert!(list(&study, &trial, &screened).is_empty());
}
