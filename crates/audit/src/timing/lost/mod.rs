//! Samples that are missing although the times go on evenly.
//!
//! Whatever turns with the supply then jumps ahead by the angle of one or more samples, voltages and currents alike and at once.
//! Nothing in a motor does that: a current cannot jump. Voltages or currents alone are taken at their word only where
//! many jumps are all whole samples.

mod extrapolation;
mod sight;

use crate::context::Context;
use crate::finding::{Code, Finding, names};
use crate::measure::blocks::Block;
use recording::Channel;
use sight::{SMALLEST, Sight};
use std::ops::Range;

/// Fewest jumps that are told: of voltages and currents together, and of one of them alone.
const FEWEST: usize = 2;
const FEWEST_ALONE: usize = 8;
/// Share of all jumps of one kind alone that must be whole samples.
const WHOLE: f64 = 0.9;
/// Most samples of a loss that is taken for one without another kind: a grid's phase may step by any angle.
const MOST_ALONE: u32 = 3;
/// More jumps than these refuse the recording, where there is more than one in so many seconds.
const FEW: usize = 5;
const RARE_S: f64 = 2.0;
/// Share of a sampling time by which the times about a jump may be uneven.
const UNEVEN: f64 = 0.3;

pub(crate) fn check(context: &Context<'_>) -> Option<Finding> {
    let found = Found::of(context);
    let losses = found.losses()?;
    let (first, jumps) = (losses.first()?.at, losses.len());
    let refuses = jumps > FEW && jumps as f64 * RARE_S > context.recording.duration();
    let finding = Finding::new(
        Code::LostSamples,
        names(&found.channels),
        jumps as f64,
        "jumps",
    )
    .detail(detail(context, losses, first));
    Some(if refuses { finding.refusing() } else { finding })
}

fn detail(context: &Context<'_>, losses: &[Loss], first: usize) -> String {
    let samples: u32 = losses.iter().map(|loss| loss.samples).sum();
    format!(
        "Samples are missing though t goes on evenly: {} times the phase of all channels jumps ahead by one or more whole samples, \
         {samples} samples in all, first at {:.4} s. Phase, frequency and slip are not what they were. Record with the time of each \
         sample, and look for what drops rows: a full buffer, the network, an export that leaves rows out.",
        losses.len(),
        context.recording.t()[first]
    )
}

/// A jump by whole samples.
struct Loss {
    /// The sample behind it.
    at: usize,
    samples: u32,
}

/// The jumps of a recording.
#[derive(Default)]
struct Found {
    channels: Vec<Channel>,
    /// Where voltages and currents jump alike.
    together: Vec<Loss>,
    /// Where only one of them can be seen, and how many jumps there are that may or may not be losses.
    alone: Vec<Loss>,
    jumps_alone: usize,
}

impl Found {
    fn of(context: &Context<'_>) -> Found {
        let mut found = Found::default();
        let kinds = [Channel::VOLTAGES, Channel::CURRENTS];
        let kinds = kinds.into_iter().filter(|three| context.sound(*three));
        let kinds: Vec<[Channel; 3]> = kinds.collect();
        found.channels = kinds.iter().flatten().copied().collect();
        let alive: Vec<Vec<usize>> = kinds.iter().map(|three| begins(context, *three)).collect();
        for block in &context.blocks {
            let usable = kinds.iter().zip(&alive);
            let usable =
                usable.filter(|(_, alive)| alive.binary_search(&block.range.start).is_ok());
            let sights: Vec<Sight> = usable
                .filter_map(|(three, _)| sight(context, block, *three))
                .collect();
            found.add(context, block, &sights);
        }
        found
    }

    /// What is certain enough to be told.
    fn losses(&self) -> Option<&[Loss]> {
        if self.together.len() >= FEWEST {
            return Some(&self.together);
        }
        let are_whole = self.alone.len() as f64 >= WHOLE * self.jumps_alone as f64;
        (self.alone.len() >= FEWEST_ALONE && are_whole).then_some(&self.alone)
    }

    fn add(&mut self, context: &Context<'_>, block: &Block, sights: &[Sight]) {
        for at in peaks(block, sights) {
            if !is_even(context, at) {
                continue;
            }
            let mut lost = sights.iter().map(|sight| sight.lost(at));
            let first = lost.next().flatten();
            let are_same = lost.all(|other| other == first);
            let loss = first
                .filter(|_| are_same)
                .map(|samples| Loss { at, samples });
            match sights.len() {
                1 => {
                    self.jumps_alone += 1;
                    self.alone
                        .extend(loss.filter(|loss| loss.samples <= MOST_ALONE));
                }
                _ => self.together.extend(loss),
            }
        }
    }
}

/// Where the blocks begin in which three channels can be trusted.
fn begins(context: &Context<'_>, three: [Channel; 3]) -> Vec<usize> {
    let alive = context.alive(three);
    alive.iter().map(|(block, _)| block.range.start).collect()
}

fn sight(context: &Context<'_>, block: &Block, three: [Channel; 3]) -> Option<Sight> {
    let recording = context.recording;
    let channels = match three == Channel::VOLTAGES {
        true => recording.voltages()?,
        false => recording.currents()?,
    };
    let end = (block.range.end + Sight::REACH).min(recording.len());
    let range = block.range.start.saturating_sub(Sight::REACH)..end;
    let turn = block.omega * recording.t_sample();
    Sight::new(channels, range, block.three(three)?, turn)
}

/// Samples of a block in front of which all kinds jump, and together more than beside them.
fn peaks(block: &Block, sights: &[Sight]) -> Vec<usize> {
    const BESIDE: usize = 6;
    let inside = sights.iter().map(Sight::inside);
    let Some(all) = inside.reduce(|x, y| x.start.max(y.start)..x.end.min(y.end)) else {
        return Vec::new();
    };
    let all: Range<usize> = all.start.max(block.range.start.saturating_sub(BESIDE))
        ..all.end.min(block.range.end + BESIDE);
    let sizes: Vec<[f64; 2]> = all
        .clone()
        .map(|at| {
            let jumps = || sights.iter().map(|sight| sight.jump(at));
            [jumps().sum(), jumps().fold(f64::INFINITY, f64::min)]
        })
        .collect();
    let is_peak = |k: &usize| {
        let beside = k.saturating_sub(BESIDE)..(k + BESIDE + 1).min(sizes.len());
        let [size, least] = sizes[*k];
        least > SMALLEST && sizes[beside].iter().all(|[other, _]| *other <= size)
    };
    let peaks = (0..sizes.len()).filter(is_peak).map(|k| all.start + k);
    peaks.filter(|at| block.range.contains(at)).collect()
}

/// Whether the times about a sample go on evenly: a gap is another finding.
fn is_even(context: &Context<'_>, at: usize) -> bool {
    let (t, usual) = (context.recording.t(), context.recording.t_sample());
    let range = at.saturating_sub(Sight::REACH)..(at + Sight::REACH).min(t.len());
    let mut steps = t[range].windows(2).map(|pair| pair[1] - pair[0]);
    steps.all(|step| (step / usual - 1.0).abs() < UNEVEN)
}
