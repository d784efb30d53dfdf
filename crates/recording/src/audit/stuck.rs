//! Channels that do not follow what they measure.

use super::context::Context;
use super::finding::{Code, Finding};
use super::statistics::median;
use crate::channel::{Channel, Quantity};
use std::f64::consts::TAU;

/// A frozen stretch of at least this many periods is not a peak.
const FROZEN_PERIODS: f64 = 0.75;
/// Fundamental of a dead channel over that of its neighbours.
const DEAD: f64 = 0.02;
/// Sum of two currents over one of them, below which the third phase carries no current either.
const OPEN: f64 = 0.1;
/// Change of the current amplitude that a live speed channel must notice.
const LOAD_CHANGE: f64 = 0.2;

pub(super) fn check(context: &mut Context<'_>) -> Vec<Finding> {
    let mut findings = Vec::new();
    for three in [Channel::VOLTAGES, Channel::CURRENTS] {
        for k in 0..3 {
            findings.extend(dead(context, three, k).or_else(|| frozen(context, three, k)));
        }
    }
    findings.extend(speed(context));
    for channel in findings
        .iter()
        .filter_map(|finding| Channel::parse(&finding.channel))
    {
        context.unsound.insert(channel);
    }
    findings
}

/// A channel without a fundamental where the other two have one.
fn dead(context: &Context<'_>, three: [Channel; 3], k: usize) -> Option<Finding> {
    let channel = three[k];
    if context.recording.is_derived(channel) {
        return None;
    }
    let alive = context.alive(three);
    let [a, b] = [(k + 1) % 3, (k + 2) % 3];
    let share =
        |at: &[num_complex::Complex64; 3]| 2.0 * at[k].norm() / (at[a].norm() + at[b].norm());
    let phasors: Vec<_> = alive.iter().map(|(_, three)| three.phasors()).collect();
    let shown = median(phasors.iter().map(share))?;
    if shown > DEAD {
        return None;
    }
    let sum = median(
        phasors
            .iter()
            .map(|at| (at[a] + at[b]).norm() / at[a].norm()),
    )?;
    let open = channel.quantity() == Quantity::Current && sum < OPEN;
    let detail = if open {
        format!(
            "{channel} carries no current and the other two cancel: the phase is open, or two columns \
             hold the same wire. Check fuse, contactor and cable."
        )
    } else {
        format!(
            "{channel} shows {:.1} % of what the other two show: the sensor is dead, not connected, or \
             the column is another one. Check its cable and the column mapping.",
            100.0 * shown
        )
    };
    Some(Finding::new(Code::Stuck, channel, 100.0 * shown, "%").detail(detail))
}

/// A channel that repeats one value while the others of its kind go on.
fn frozen(context: &Context<'_>, three: [Channel; 3], k: usize) -> Option<Finding> {
    let channel = three[k];
    let x = context.recording.channel(channel)?;
    let longest = TAU / context.omega()? / context.recording.t_sample() * FROZEN_PERIODS;
    let (from, length) = longest_run(x);
    if (length as f64) < longest.max(8.0) || context.recording.is_derived(channel) {
        return None;
    }
    let moving = |other: &Channel| {
        let Some(y) = context.recording.channel(*other) else {
            return false;
        };
        let all = y.iter().fold(0.0, |all: f64, y| all.max(y.abs()));
        let stretch = &y[from..from + length];
        let mean = super::blocks::mean(stretch);
        stretch.iter().any(|y| (y - mean).abs() > 0.05 * all)
    };
    let others = three
        .iter()
        .filter(|other| **other != channel && moving(other))
        .count();
    (others == 2).then(|| {
        let (t, unit) = (context.recording.t(), channel.quantity().si());
        let seconds = t[from + length - 1] - t[from];
        Finding::new(Code::Stuck, channel, seconds, "s").within(t[from], t[from] + seconds).detail(format!(
            "{channel} stays at {} {unit} for {seconds:.3} s from {:.3} s on while the others go on: the \
             sensor or its converter froze. Cut that stretch, or measure again.",
            x[from], t[from]
        ))
    })
}

/// Begin and length of the longest run of equal values.
fn longest_run(x: &[f64]) -> (usize, usize) {
    let (mut best, mut from) = ((0, 0), 0);
    for k in 1..=x.len() {
        if k == x.len() || x[k] != x[from] {
            if k - from > best.1 {
                best = (from, k - from);
            }
            from = k;
        }
    }
    best
}

/// A speed that does not change by a bit while the current does. A shaft at rest may.
fn speed(context: &Context<'_>) -> Option<Finding> {
    let speed = context.recording.speed()?;
    let (first, constant) = (speed[0], longest_run(speed).1 == speed.len());
    if !constant || first == 0.0 {
        return None;
    }
    let alive = context.alive(Channel::CURRENTS);
    let amplitudes = || alive.iter().map(|(_, three)| three.amplitude());
    let (least, most) = (
        amplitudes().fold(f64::INFINITY, f64::min),
        amplitudes().fold(0.0, f64::max),
    );
    (most > (1.0 + LOAD_CHANGE) * least).then(|| {
        Finding::new(Code::Stuck, Channel::SPEED, first, "rad/s").detail(format!(
            "speed stays at exactly {first} rad/s while the current changes from {least:.2} to {most:.2} A: \
             the encoder or its counter is dead. Check its cable and supply."
        ))
    })
}
