use super::*;
use crate::data::channels::N_CHANNELS;
use crate::model::prior::N_NOMINAL;
use crate::specimen;

/// The speed of a table counts in revolutions per minute: two more at each point are four in each block.
#[test]
fn errors_are_the_squares_of_each_block() {
    let mut study = specimen::table_study(|_| ());
    for row in specimen::measured_of(&mut study.fitted.case) {
        row[1] += 2.0 * std::f64::consts::TAU / 60.0;
    }
    let errors = study.fitted.errors(&study.prior, &study.at_prior());
    assert_eq!(errors.len(), 12);
    assert!(errors.iter().all(|e| (e - 4.0).abs() < 1e-2), "{errors:?}");
}

#[test]
fn a_table_cannot_move_inertia_and_friction() {
    let free = specimen::table_study(|_| ()).at_prior().free;
    assert_eq!(free, [true, true, true, true, false, false]);
}

/// Inertia and friction are fitted unless the speed is given.
#[test]
fn a_recording_moves_the_mechanics_if_its_speed_is_no_input() {
    let mut study = specimen::study(0.3, |_| 1.0);
    assert_eq!(study.at_prior().free, [true; N_NOMINAL]);
    assert_eq!(study.given_effects(), 0);
    let waveform = study.fitted.case.waveform_mut().expect("a recording");
    waveform.speed_is_input = true;
    assert_eq!(study.at_prior().free[4..], [false, false]);
}

#[test]
fn a_scale_that_nobody_knows_is_free_from_the_start() {
    let study = specimen::scaled_study(0.4, 1.0);
    let priors = study.at_prior();
    assert_eq!((priors.z.len(), study.given_effects()), (N_NOMINAL + 1, 1));
    assert_eq!(priors.effects[0].effect.descriptor().name, "speed-scale");
    assert!(priors.free[N_NOMINAL] && priors.z[N_NOMINAL] == 0.0);
}

/// Folds are those of the fit, proof goes through the proving tables one after the other.
#[test]
fn a_trial_holds_folds_and_proof() {
    let mut study = specimen::proven_table_study(|_| ());
    let mut second = study.proofs[0].clone();
    for row in specimen::measured_of(&mut second.case) {
        row[1] += std::f64::consts::TAU / 60.0;
    }
    study.proofs.push(second);
    let trial = specimen::trial(&study);
    assert_eq!(trial.folds, trial.fit.held_out());
    assert_eq!((trial.folds.len(), trial.proof.len()), (12, 24));
    assert!(trial.proof[..12].iter().all(|e| *e < 1e-2));
    assert!(
        trial.proof[12..].iter().all(|e| (e - 1.0).abs() < 0.1),
        "{:?}",
        trial.proof
    );
}

/// 48 values, but efficiency says nothing at idle.
#[test]
fn errors_over_noise_are_root_mean_squares_over_the_floor() {
    let mut study = specimen::table_study(|_| ());
    study.fitted.floor.mean = 1.5;
    assert!((study.fold_error(&[4.0 * 1.5 * 40.0, 4.0 * 1.5 * 7.0]) - 2.0).abs() < 1e-12);
    let mut trial = specimen::trial(&study);
    trial.folds = vec![9.0 * 1.5 * 47.0];
    assert!(
        (study.proof_error(&trial) - 3.0).abs() < 1e-12,
        "nothing else proves"
    );
}

/// Two proving tables with floors of 1 and 3: so many values each as they hold.
#[test]
fn the_proof_is_measured_against_the_floors_of_all_that_proves() {
    let mut study = specimen::proven_table_study(|_| ());
    let mut second = study.proofs[0].clone();
    second.floor.mean = 3.0;
    study.proofs.push(second);
    let mut trial = specimen::trial(&study);
    trial.folds = vec![1e6; 12];
    let values = 4.0 * 12.0;
    trial.proof = vec![4.0 * values, 4.0 * 3.0 * values];
    assert!((study.proof_error(&trial) - 2.0).abs() < 1e-12);
}

/// Mean squares of the difference, a hundredth of the floor.
#[test]
fn a_proof_is_silent_below_a_hundredth_of_its_floor() {
    let mut study = specimen::proven_table_study(|_| ());
    let mut trials = [0.0, 0.1].map(|size| specimen::trial_with(&study, &[("core-loss", size)]));
    // Another proof is added below.
    trials
        .iter_mut()
        .for_each(|trial| trial.warmth.push(AS_WARM));
    let subject = &study.proofs[0];
    let predicted = trials.clone().map(|t| {
        outputs(
            &subject.case,
            &study.prior,
            &t.fit.hypothesis,
            SpeedObserver::Off,
        )
    });
    let [without, with] = &predicted;
    let differences = without.iter().zip(with).take(12 * N_CHANNELS);
    let squares: f64 = differences.map(|(a, b)| (a - b) * (a - b)).sum();
    let mut silent = |share: f64| {
        study.proofs[0].floor.mean = squares / 48.0 / share;
        study.proof_is_silent(&trials[0], &trials[1])
    };
    assert!(silent(0.0099) && !silent(0.0101));
    let mut loud = study.proofs[0].clone();
    study.proofs[0].floor.mean *= 2.0;
    assert!(study.proof_is_silent(&trials[0], &trials[1]));
    loud.floor.mean *= 0.5;
    study.proofs.push(loud);
    assert!(
        !study.proof_is_silent(&trials[0], &trials[1]),
        "one of two speaks"
    );
    assert!(study.proof_is_silent(&trials[0], &trials[0]));
    study.proofs.clear();
    assert!(
        !study.proof_is_silent(&trials[0], &trials[0]),
        "there is no proof"
    );
}

/// The root of one and 0.21 is 1.1.
#[test]
fn a_signature_is_visible_by_how_much_it_would_raise_the_error() {
    let mut study = specimen::table_study(|_| ());
    study.fitted.floor.mean = 2.0;
    assert!((study.visibility(0.21 * 2.0 * 47.0) - 0.1).abs() < 1e-12);
    assert_eq!((study.visibility(0.0), study.visibility(-5.0)), (0.0, 0.0));
}

#[test]
fn the_allowance_is_that_of_the_least_certain_floor() {
    let mut study = specimen::proven_table_study(|_| ());
    assert_eq!(study.allowance(), 0.0);
    (study.fitted.floor.mean, study.fitted.floor.sd) = (2.0, 0.02);
    study.proofs[0].floor.sd = 0.005;
    assert_eq!(study.allowance(), 0.01);
    study.proofs[0].floor.sd = 0.03;
    assert_eq!(study.allowance(), 0.03);
}
