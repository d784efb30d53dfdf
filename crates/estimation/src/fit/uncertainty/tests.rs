use super::*;
use crate::fit::output_error::Effort;
use crate::specimen;

/// Without priors and noise of inputs, white residuals: `1/(J' J)` plus what the instruments may be off.
#[test]
fn white_residuals_leave_the_inverse_of_the_curvature() {
    let study = specimen::table_study(|_| ());
    let mut fit = study.trial(&study.at_prior(), Effort::FULL).fit;
    fit.inflation = 1.0;
    fit.penalty.weight.fill(0.0);
    let found = covariance(&study, &fit);
    let expected = normal_equations::total(&fit.blocks)
        .gram
        .try_inverse()
        .expect("regular");
    assert!((&found - &expected).norm() < 1e-6 * expected.norm());
}

/// What the data say nothing about keeps the variance of the prior, whatever weight the prior has in the fit.
#[test]
fn without_data_the_prior_is_left() {
    let study = specimen::table_study(|_| ());
    let mut fit = study.trial(&study.at_prior(), Effort::FULL).fit;
    fit.blocks.iter_mut().for_each(|b| {
        b.gram.fill(0.0);
        b.score.fill(0.0);
    });
    for inflation in [1.0, 30.0, 400.0] {
        fit.inflation = inflation;
        fit.penalty.weight = DVector::from_element(fit.free.len(), inflation / 0.01);
        let found = covariance(&study, &fit);
        for k in 0..fit.free.len() {
            assert!(
                (found[(k, k)] / 0.01 - 1.0).abs() < 1e-9,
                "{}",
                found[(k, k)]
            );
        }
    }
}

/// A motor in steady state whose currents show 0.2 % more: the rotor resistance moves by what the covariance says of
/// a gain of 0.2 %.
#[test]
fn a_gain_of_the_currents_moves_the_fit_as_foretold() {
    let truth = specimen::study(1.0, |t| if t < 0.5 { 0.5 } else { 1.5 });
    let fit = truth.trial(&truth.at_prior(), Effort::FULL).fit;
    let case = &truth.fitted.case;
    let all = normal_equations::total(&fit.blocks);
    let curvature = &all.gram + DMatrix::from_diagonal(&fit.penalty.weight);
    let mut change = vec![0.0; case.measured().len() * N_CHANNELS];
    for (row, (y, w)) in case.measured().iter().zip(case.weight()).enumerate() {
        (0..3).for_each(|k| change[row * N_CHANNELS + k] = 0.002 * y[k] * w[k]);
    }
    let foretold = curvature.try_inverse().expect("regular") * score(&fit, &change);
    let mut louder = truth.clone();
    for row in specimen::measured_of(&mut louder.fitted.case) {
        row[..3].iter_mut().for_each(|i| *i *= 1.002);
    }
    let moved = louder.trial(&louder.at_prior(), Effort::FULL).fit;
    for (k, &at) in fit.free.iter().enumerate() {
        let step = moved.hypothesis.z[at] - fit.hypothesis.z[at];
        // Linear up to the squares of some tenths of a per cent.
        assert!(
            (step - foretold[k]).abs() < 0.1 * foretold.amax(),
            "{at}: {step} {}",
            foretold[k]
        );
    }
}
