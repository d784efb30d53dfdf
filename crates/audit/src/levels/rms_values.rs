//! Effective values where instantaneous ones are expected.

use crate::context::Context;
use crate::finding::{Code, Finding, names};
use crate::measure::blocks::{mean, tracked};
use recording::Channel;

/// Negative readings up to this share of the largest are noise about zero.
const NEGATIVE: f64 = 0.03;
/// Mean over largest value: an inrush that decays leaves a few percent.
const MEAN: f64 = 0.03;

/// Standard deviation over mean of a meter's reading of one operating point.
const CALM: f64 = 0.03;

pub(crate) fn check(context: &mut Context<'_>) -> Vec<Finding> {
    let mut findings = Vec::new();
    for three in [Channel::VOLTAGES, Channel::CURRENTS] {
        if !all_effective(context, three) {
            continue;
        }
        context.unsound.extend(three);
        let [first, ..] = three;
        let largest = largest(context.recording.channel(first).unwrap_or(&[]));
        findings.push(
            Finding::new(
                Code::RmsValues,
                names(&three),
                largest,
                first.quantity().si(),
            )
            .detail(format!(
                "{} never change sign and do not alternate: these are effective values. Record \
                     instantaneous values, at least 10 per period of the supply; a table of steady \
                     operating points is read as a load table.",
                names(&three)
            ))
            .refusing(),
        );
    }
    findings
}

fn all_effective(context: &Context<'_>, three: [Channel; 3]) -> bool {
    let measured = three
        .into_iter()
        .filter(|channel| !context.recording.is_derived(*channel));
    let columns: Vec<&[f64]> = measured
        .filter_map(|channel| context.recording.channel(channel))
        .collect();
    columns.len() >= 2 && columns.iter().all(|x| never_negative(x)) && !alternate(context, &columns)
}

/// Whether a fundamental goes through most of the recording: some stretches of a wavering meter look like one, and what
/// wavers by less than a few percent is a meter in any case.
fn alternate<'r>(context: &Context<'r>, columns: &[&'r [f64]]) -> bool {
    if columns.iter().all(|x| is_calm(x)) {
        return false;
    }
    let spans = tracked(context.recording, columns).spans();
    let covered: usize = spans.iter().map(|span| span.range.len()).sum();
    2 * covered > context.recording.len()
}

fn is_calm(x: &[f64]) -> bool {
    let mean = mean(x);
    let square = x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / x.len() as f64;
    square.sqrt() < CALM * mean
}

fn never_negative(x: &[f64]) -> bool {
    let largest = largest(x);
    let smallest = x.iter().copied().fold(f64::INFINITY, f64::min);
    largest > 0.0 && smallest > -NEGATIVE * largest && mean(x) > MEAN * largest
}

fn largest(x: &[f64]) -> f64 {
    x.iter().copied().fold(0.0, f64::max)
}
