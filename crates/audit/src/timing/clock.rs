//! The sampling clock: jitter, and a rate too low for the supply.

use crate::context::Context;
use crate::finding::{Code, Finding};
use crate::timing::not_locked::other_time_unit;

/// A step beyond this multiple of the usual one is a gap, not jitter.
pub(crate) const GAP: f64 = 1.5;
/// Effective jitter, in percent of the sampling time, that shifts a phasor at ten samples per period by
/// less than 0.1 degree once averaged over three periods.
const JITTER_PERCENT: f64 = 2.0;
/// Samples per period that a phasor window and a zero crossing need.
const FEWEST_PER_PERIOD: f64 = 10.0;
/// Below this the fundamental itself is lost among its aliases.
const HOPELESS_PER_PERIOD: f64 = 3.0;

pub(crate) fn check(context: &Context<'_>) -> Vec<Finding> {
    jitter(context).into_iter().chain(rate(context)).collect()
}

fn jitter(context: &Context<'_>) -> Option<Finding> {
    let usual = context.recording.t_sample();
    let steps = context
        .recording
        .t()
        .windows(2)
        .map(|pair| pair[1] - pair[0]);
    let deviations = steps
        .filter(|step| *step < GAP * usual)
        .map(|step| (step / usual - 1.0).powi(2));
    let (sum, count) = deviations.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
    let percent = 100.0 * f64::sqrt(sum / count);
    (percent > JITTER_PERCENT).then(|| {
        Finding::new(Code::Clock, "t", percent, "%").detail(format!(
            "The time between samples scatters by {percent:.1} % about {usual:.3e} s. If the instrument \
             samples evenly, write t with more decimals or declare --sample-rate."
        ))
    })
}

fn rate(context: &Context<'_>) -> Option<Finding> {
    let omega = context.omega().or_else(|| rated(context))?;
    let per_period = std::f64::consts::TAU / (omega * context.recording.t_sample());
    (per_period < FEWEST_PER_PERIOD).then(|| {
        let finding = Finding::new(Code::Clock, "t", per_period, "samples per period").detail(format!(
            "The supply is sampled {per_period:.1} times per period; record at least {FEWEST_PER_PERIOD} \
             samples per period, better 100."
        ));
        if per_period < HOPELESS_PER_PERIOD { finding.refusing() } else { finding }
    })
}

/// The rated frequency stands in for one that was not found, unless the clock's unit is to blame.
fn rated(context: &Context<'_>) -> Option<f64> {
    let omega = context.expectation.omega()?;
    other_time_unit(context).is_none().then_some(omega)
}
