//! Channels without a fundamental where the other two of their kind have one.

use crate::context::Context;
use crate::finding::{Code, Finding};
use crate::measure::blocks::Block;
use crate::measure::statistics::median;
use num_complex::Complex64;
use recording::{Channel, Quantity};

/// Fundamental of a dead channel over that of its neighbours.
const DEAD: f64 = 0.02;
/// Blocks for which a channel must be dead before it is said.
const FEWEST: usize = 3;
/// Sum of two currents over one of them, below which the third phase carries no current either.
const OPEN: f64 = 0.1;

/// A dead channel, and whether it is dead for most of the recording.
pub(crate) fn dead(
    context: &Context<'_>,
    three: [Channel; 3],
    k: usize,
) -> Option<(Finding, bool)> {
    let channel = three[k];
    if context.recording.is_derived(channel) {
        return None;
    }
    let alive = context.alive(three);
    let dead: Vec<(&Block, [Complex64; 3])> = alive
        .iter()
        .map(|(block, three)| (*block, three.phasors()))
        .filter(|(_, phasors)| shown(phasors, k) < DEAD)
        .collect();
    if dead.len() < FEWEST {
        return None;
    }
    let percent = 100.0 * median(dead.iter().map(|(_, phasors)| shown(phasors, k)))?;
    let sum = median(dead.iter().map(|(_, phasors)| sum_of_others(phasors, k)))?;
    let open = channel.quantity() == Quantity::Current && sum < OPEN;
    let t = context.recording.t();
    let (from, to) = (dead.first()?.0.range.start, dead.last()?.0.range.end - 1);
    let finding = Finding::new(Code::Stuck, channel, percent, "%")
        .within(t[from], t[to])
        .detail(detail(channel, percent, open, [t[from], t[to]]));
    Some((finding, 2 * dead.len() > alive.len()))
}

fn shown(phasors: &[Complex64; 3], k: usize) -> f64 {
    let [a, b] = [(k + 1) % 3, (k + 2) % 3];
    2.0 * phasors[k].norm() / (phasors[a].norm() + phasors[b].norm())
}

fn sum_of_others(phasors: &[Complex64; 3], k: usize) -> f64 {
    let [a, b] = [(k + 1) % 3, (k + 2) % 3];
    (phasors[a] + phasors[b]).norm() / phasors[a].norm()
}

fn detail(channel: Channel, percent: f64, open: bool, [from, to]: [f64; 2]) -> String {
    if open {
        return format!(
            "{channel} carries no current between {from:.3} s and {to:.3} s and the other two cancel: the \
             phase is open, or two columns hold the same wire. Check fuse, contactor and cable."
        );
    }
    format!(
        "{channel} shows {percent:.1} % of what the other two show between {from:.3} s and {to:.3} s: the \
         sensor is dead, not connected, or the column is another one. Check its cable and the column mapping."
    )
}
