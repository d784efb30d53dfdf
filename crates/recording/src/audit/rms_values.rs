//! Effective values where instantaneous ones are expected.

use super::blocks::{mean, tracked};
use super::context::Context;
use super::finding::{Code, Finding, names};
use crate::channel::Channel;

/// Negative readings up to this share of the largest are noise about zero.
const NEGATIVE: f64 = 0.03;
/// Mean over largest value: an inrush that decays leaves a few percent.
const MEAN: f64 = 0.03;

pub(super) fn check(context: &mut Context<'_>) -> Vec<Finding> {
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
    columns.len() >= 2
        && columns.iter().all(|x| never_negative(x))
        && tracked(context.recording, &columns).spans().is_empty()
}

fn never_negative(x: &[f64]) -> bool {
    let largest = largest(x);
    let smallest = x.iter().copied().fold(f64::INFINITY, f64::min);
    largest > 0.0 && smallest > -NEGATIVE * largest && mean(x) > MEAN * largest
}

fn largest(x: &[f64]) -> f64 {
    x.iter().copied().fold(0.0, f64::max)
}
