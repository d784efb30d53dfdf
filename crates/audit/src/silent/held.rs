//! Channels that are refreshed more slowly than the rows are written: values of a display, of a bus, of another converter.

use crate::context::Context;
use crate::finding::{Code, Finding, names};
use crate::measure::refresh::rows;
use recording::{Channel, Quantity};
use std::f64::consts::TAU;

/// Refreshes per period of the supply below which a phasor is no longer one.
const FEWEST_PER_PERIOD: f64 = 3.0;

pub(crate) fn check(context: &mut Context<'_>) -> Vec<Finding> {
    let recording = context.recording;
    let measured: Vec<(Channel, &[f64])> = recording
        .channels()
        .filter(|(channel, _)| !recording.is_derived(*channel))
        .collect();
    let held: Vec<(Channel, f64)> = measured
        .iter()
        .filter_map(|(channel, x)| Some((*channel, rows(x)?)))
        .collect();
    let electrical = |channel: &Channel| channel.is_electrical();
    let (signals, others): (Vec<_>, Vec<_>) = held.into_iter().partition(|(c, _)| electrical(c));
    let all = measured.iter().filter(|(c, _)| electrical(c)).count();
    let mut findings: Vec<Finding> = alternating(context, &signals, all).into_iter().collect();
    findings.extend(
        others
            .into_iter()
            .filter_map(|(channel, rows)| slow(context, channel, rows)),
    );
    findings
}

/// Voltages and currents: held by half their refresh on average, some later than others.
fn alternating(context: &mut Context<'_>, held: &[(Channel, f64)], all: usize) -> Option<Finding> {
    let longest = held.iter().map(|(_, rows)| *rows).fold(0.0, f64::max);
    let shortest = held
        .iter()
        .map(|(_, rows)| *rows)
        .fold(f64::INFINITY, f64::min);
    let channels: Vec<Channel> = held.iter().map(|(channel, _)| *channel).collect();
    if held.is_empty() {
        return None;
    }
    let together = held.len() == all && longest < 1.1 * shortest;
    let omega = context.omega().or(context.expectation.omega());
    let per_period = omega.map_or(0.0, |omega| {
        TAU / (omega * context.recording.t_sample() * longest)
    });
    let finding = Finding::new(Code::Held, names(&channels), longest, "rows");
    if together && per_period > FEWEST_PER_PERIOD {
        return Some(finding.detail(format!(
            "{} are refreshed only every {longest:.0} rows ({per_period:.1} times per period): the file has more rows than the \
             recorder has measured. Write only the rows that were measured, or record faster.",
            names(&channels)
        )));
    }
    context.unsound.extend(&channels);
    Some(
        finding
            .detail(format!(
                "{} keep their values for {longest:.0} rows while other channels go on: these are values of a display or of a \
                 slower converter, late against the others. Record instantaneous values of all channels at one rate.",
                names(&channels)
            ))
            .refusing(),
    )
}

/// A speed, torque or temperature may be slow; that it is matters to starts and steps.
fn slow(context: &Context<'_>, channel: Channel, rows: f64) -> Option<Finding> {
    if channel.quantity() == Quantity::Temperature {
        return None;
    }
    let seconds = rows * context.recording.t_sample();
    Some(Finding::new(Code::Held, channel, rows, "rows").detail(format!(
        "{channel} is refreshed only every {rows:.0} rows ({:.3} s): the value of a display or of a bus. Steady running is judged; \
         starts and load steps are shown late in it.",
        seconds
    )))
}
