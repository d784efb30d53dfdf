//! Channels that do not follow what they measure.

use crate::context::Context;
use crate::finding::{Code, Finding};
use crate::measure::statistics::median;
use crate::silent::dead::dead;
use recording::Channel;
use std::f64::consts::TAU;

/// A frozen stretch of at least this many periods is not a peak.
const FROZEN_PERIODS: f64 = 0.75;
/// Share of its usual magnitude by which a channel that goes on must move.
const MOVING: f64 = 0.5;
/// Change of the current amplitude that a live speed channel must notice.
const LOAD_CHANGE: f64 = 0.2;

pub(crate) fn check(context: &mut Context<'_>) -> Vec<Finding> {
    let mut found = Vec::new();
    for three in [Channel::VOLTAGES, Channel::CURRENTS] {
        for k in 0..3 {
            found.extend(dead(context, three, k).or_else(|| frozen(context, three, k)));
        }
    }
    found.extend(speed(context).map(|finding| (finding, true)));
    let lost = found.iter().filter(|(_, mostly)| *mostly);
    let lost: Vec<Channel> = lost
        .filter_map(|(finding, _)| Channel::parse(&finding.channel))
        .collect();
    context.unsound.extend(lost);
    found.into_iter().map(|(finding, _)| finding).collect()
}

/// A channel that repeats one value while the others of its kind go on, and whether it does so for most
/// of the recording.
fn frozen(context: &Context<'_>, three: [Channel; 3], k: usize) -> Option<(Finding, bool)> {
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
        let usual = median(y.iter().map(|y| y.abs())).unwrap_or(0.0);
        // A coarse channel may have kept its value for a while before all stood still.
        let stretch = &y[from + length / 4..from + length];
        let mean = crate::measure::blocks::mean(stretch);
        stretch.iter().any(|y| (y - mean).abs() > MOVING * usual)
    };
    let others = three
        .iter()
        .filter(|other| **other != channel && moving(other))
        .count();
    (others == 2).then(|| {
        let (t, unit) = (context.recording.t(), channel.quantity().si());
        let (begin, end) = (t[from], t[from + length - 1]);
        let detail = format!(
            "{channel} stays at {} {unit} from {begin:.3} s to {end:.3} s while the others go on: the sensor \
             or its converter froze. Cut that stretch, or measure again.",
            x[from]
        );
        let finding = Finding::new(Code::Stuck, channel, end - begin, "s");
        (finding.within(begin, end).detail(detail), 2 * length > x.len())
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
