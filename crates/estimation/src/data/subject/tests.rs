use super::*;
use crate::specimen;

/// Two loads: with one alone both resistances are one number.
fn two_loads(t: f64) -> f64 {
    if t < 1.0 { 0.4 } else { 1.5 }
}

/// What a recording of the believed motor says of a hypothesis that believes other resistances; the squared error of that hypothesis
/// as it is, and that of the truth, which a closed form without the transient of the step leaves.
fn asked_of(z: Warmth) -> (Proof, f64, f64) {
    let study = specimen::study(2.0, two_loads);
    let h = warmed(&study.at_prior(), z);
    let plain = |h: &Hypothesis| study.fitted.errors(&study.prior, h).iter().sum();
    (
        study.fitted.proof_of(&study.prior, &h),
        plain(&h),
        plain(&study.at_prior()),
    )
}

fn sum(proof: &Proof) -> f64 {
    proof.errors.iter().sum()
}

#[test]
fn a_recording_as_warm_as_the_fitted_one_keeps_its_resistances() {
    let study = specimen::study(2.0, two_loads);
    let (subject, h) = (&study.fitted, study.at_prior());
    let proof = subject.proof_of(&study.prior, &h);
    assert_eq!(proof.warmth, AS_WARM);
    assert_eq!(proof.errors, subject.errors(&study.prior, &h));
}

/// The steady state in closed form is the oracle: the recording has the believed resistances.
#[test]
fn the_resistances_of_a_recording_are_found_whatever_the_hypothesis_believes() {
    for believed in [[-0.1, -0.15], [0.12, 0.05], [0.0, -0.2], [-0.3, -0.3]] {
        let (proof, plain, least) = asked_of(believed);
        for (found, believed) in proof.warmth.iter().zip(believed) {
            // A chord leaves a tenth of what was left, the prior holds the rest back.
            assert!((found + believed).abs() < 0.02, "{:?}", proof.warmth);
        }
        let (left, first) = (sum(&proof) - least, plain - least);
        // Resistances right to a tenth leave a hundredth of the squared error, and less than a hundredth of all is not asked for.
        assert!(left < 0.05 * first && first > 0.0, "{left} of {first}");
    }
}

#[test]
fn no_winding_is_a_hundred_kelvin_warmer() {
    let (proof, plain, _) = asked_of([0.0, -0.8]);
    assert!(proof.warmth.iter().all(|x| x.abs() <= FURTHEST));
    assert!(proof.warmth[1] == FURTHEST && sum(&proof) < plain);
}

#[test]
fn a_load_table_has_the_resistances_of_the_hypothesis() {
    let study = specimen::table_study(|_| ());
    let h = warmed(&study.at_prior(), [0.1, 0.1]);
    let proof = study.fitted.proof_of(&study.prior, &h);
    assert_eq!(proof.warmth, AS_WARM);
    assert_eq!(proof.errors, study.fitted.errors(&study.prior, &h));
}

/// What resistances cannot explain is left: the error of a leakage that is a third too large.
#[test]
fn other_parameters_stay_wrong() {
    let study = specimen::study(2.0, two_loads);
    let mut h = study.at_prior();
    h.z[crate::model::prior::LEAKAGE] = 0.3;
    let proof = study.fitted.proof_of(&study.prior, &h);
    let floor = study.fitted.floor.mean * study.fitted.case.judged();
    assert!(sum(&proof) > 10.0 * floor, "{} of {floor}", sum(&proof));
}

/// Only the resistances are fitted, from where they are; further than a temperature moves them they are another motor's.
#[test]
fn windings_are_warmer_by_what_they_differ() {
    let study = specimen::study(1.0, |_| 1.0);
    let h = warmed(&study.at_prior(), [0.02, -0.01]);
    let free = with_free_windings(&h, [0.1, 0.2]);
    let number = free.free.iter().filter(|free| **free).count();
    assert!(number == 2 && RESISTANCES.iter().all(|&k| free.free[k]));
    let warmth = warmth_of(&free, &h).expect("possible");
    assert!((warmth[0] - 0.1).abs() < 1e-12 && (warmth[1] - 0.2).abs() < 1e-12);
    assert!(warmth_of(&warmed(&h, [0.0, 1.001 * FURTHEST]), &h).is_none());
}

/// A model that leaves the finite numbers counts as infinitely wrong, and no warmth mends that.
#[test]
fn a_model_without_numbers_stays_without_them() {
    let study = specimen::study(1.0, |_| 1.0);
    let mut h = study.at_prior();
    h.z[crate::model::prior::INERTIA] = f64::NAN;
    let proof = study.fitted.proof_of(&study.prior, &h);
    assert_eq!(proof.warmth, AS_WARM);
    assert!(!sum(&proof).is_finite());
}
