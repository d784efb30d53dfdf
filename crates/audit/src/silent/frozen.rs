//! A recorder that goes on writing rows, but not measuring: every channel holds its value.

use crate::context::Context;
use crate::finding::{Code, Finding, names};
use crate::measure::statistics::median;
use recording::Channel;
use std::cell::OnceCell;
use std::f64::consts::TAU;
use std::ops::Range;

/// Shortest stretch that counts, in periods of the supply and in samples.
const FEWEST_PERIODS: f64 = 0.75;
const FEWEST_SAMPLES: usize = 8;
/// Share of its usual magnitude that a held channel must show: a supply that is off holds zeros.
const ALIVE: f64 = 0.1;

/// One finding for the longest stretch; refuses where nothing else is left.
pub(crate) fn check(context: &Context<'_>) -> Option<Finding> {
    let held: Vec<(Channel, &[f64])> = measured(context);
    let stretches = stretches(context, &held);
    let longest = stretches.iter().max_by_key(|stretch| stretch.len())?;
    let t = context.recording.t();
    let (from, to) = (t[longest.start], t[longest.end - 1]);
    let samples: usize = stretches.iter().map(Range::len).sum();
    let channels: Vec<Channel> = held.iter().map(|(channel, _)| *channel).collect();
    let others = match stretches.len() {
        1 => String::new(),
        n => format!(" (and in {} other stretches)", n - 1),
    };
    let detail = format!(
        "All voltages and currents hold their values from {from:.3} s to {to:.3} s{others}: the recorder stood still and went on \
         writing. Nothing is judged there. Look at the recorder, its memory and its clock, and record again."
    );
    let finding = Finding::new(Code::Frozen, names(&channels), to - from, "s")
        .within(from, to)
        .detail(detail);
    Some(if 2 * samples > context.recording.len() {
        finding.refusing()
    } else {
        finding
    })
}

/// Voltages and currents as they were recorded; fewer than two cannot tell a recorder from a sensor.
fn measured<'r>(context: &Context<'r>) -> Vec<(Channel, &'r [f64])> {
    let recording = context.recording;
    let all = recording.channels();
    let measured: Vec<(Channel, &[f64])> = all
        .filter(|(channel, _)| channel.is_electrical() && !recording.is_derived(*channel))
        .collect();
    if measured.len() < 2 {
        Vec::new()
    } else {
        measured
    }
}

fn stretches(context: &Context<'_>, held: &[(Channel, &[f64])]) -> Vec<Range<usize>> {
    let Some(omega) = context.omega() else {
        return Vec::new();
    };
    if held.is_empty() {
        return Vec::new();
    }
    let periods = FEWEST_PERIODS * TAU / (omega * context.recording.t_sample());
    let fewest = (periods as usize).max(FEWEST_SAMPLES);
    let usual = || {
        let median = |x: &[f64]| median(x.iter().map(|x| x.abs())).unwrap_or(0.0);
        held.iter().map(|(_, x)| median(x)).collect::<Vec<f64>>()
    };
    // Asked for where something is held, which is rare.
    let known = OnceCell::new();
    let alive = |k: usize| {
        let mut each = held.iter().zip(known.get_or_init(usual));
        each.any(|((_, x), usual)| x[k].abs() > ALIVE * usual && *usual > 0.0)
    };
    let (mut found, mut from) = (Vec::new(), 0);
    for k in 1..=context.recording.len() {
        let holds = k < context.recording.len() && held.iter().all(|(_, x)| x[k] == x[k - 1]);
        if !holds {
            if k - from >= fewest && alive(from) {
                found.push(from..k);
            }
            from = k;
        }
    }
    found
}
