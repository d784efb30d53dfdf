//! What is still wide, and which further test would tell it.

use super::fit::{Posterior, Problem};
use super::instruments::Instruments;
use super::parameters::{self, ALL, Form, NAMES};
use super::point::planned;
use super::table::Test;
use nalgebra::DMatrix;

/// An interval of this half width, as a factor, is still wide.
const WIDE: f64 = 1.15;
/// A test is worth its work where it narrows an interval's half width by this share.
const WORTH: f64 = 0.75;

/// A parameter that is still wide.
#[derive(Clone, Debug, PartialEq)]
pub struct Help {
    /// Key of the parameter.
    pub parameter: &'static str,
    /// Half width of its interval, as a factor.
    pub factor_now: f64,
    /// The whole test that narrows it most, and the factor that it would leave; `None` where no standard test does.
    pub test: Option<(Test, f64)>,
}

/// What each test would leave, by the motor so far believed.
pub(super) fn helps(
    problem: &Problem<'_>,
    posterior: &Posterior,
    instruments: &Instruments,
    form: &Form,
    derivatives: &DMatrix<f64>,
) -> Vec<Help> {
    let factors = |precision: &super::unknowns::Square| -> [f64; ALL] {
        let covariance = parameters::covariance(derivatives, &super::fit::inverse(precision));
        core::array::from_fn(|k| (1.96 * covariance[(k, k)].max(0.0).sqrt()).exp())
    };
    let now = factors(&posterior.precision);
    let then: Vec<(Test, [f64; ALL])> = Test::ALL
        .into_iter()
        .map(|test| {
            let points = planned(test, &posterior.machine, instruments);
            let more = problem.planned_information(posterior, &points);
            (test, factors(&(posterior.precision + more)))
        })
        .collect();
    (0..ALL)
        .filter(|&k| form.has(k) && now[k] > WIDE)
        .map(|k| {
            let best = then.iter().min_by(|a, b| a.1[k].total_cmp(&b.1[k]));
            let worth = best.filter(|best| best.1[k].ln() < WORTH * now[k].ln());
            Help {
                parameter: NAMES[k],
                factor_now: now[k],
                test: worth.map(|best| (best.0, best.1[k])),
            }
        })
        .collect()
}
