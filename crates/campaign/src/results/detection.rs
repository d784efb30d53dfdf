//! What is detected: smallest sizes, delays, and what is named.

use schemars::JsonSchema;
use serde::Serialize;

use crate::planned::fault::FaultKind;
use crate::planned::pair::Sides;
use crate::results::groups::{Named, counted, grouped};
use crate::results::statistics::{Share, quantile};
use crate::runs::file::{About, Results};
use crate::runs::row::Row;

/// A size counts as detected from this share of runs on.
pub const DETECTED: f64 = 0.99;

/// How well one fault is detected in one direction.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Detection {
    /// The motor.
    pub motor: String,
    /// The block.
    pub block: String,
    /// The fault.
    pub fault: String,
    /// `+`, `-`, or `dead` for a sensor that shows nothing.
    pub direction: Direction,
    /// Runs that say nothing because FAULT was lit before the fault came.
    pub lit_before: Share,
    /// Runs that say nothing because the motor stalled or swung with the fault and was never judged.
    pub unsteady: Share,
    /// The sizes, from small to large.
    pub sizes: Vec<Size>,
    /// The smallest size from which on 99 of 100 runs are detected, percent.
    pub smallest_percent: Option<f64>,
    /// Whether that is the smallest size of the plan: still smaller ones may be detected too.
    pub or_smaller: bool,
    /// The size that is wanted, percent.
    pub target_percent: Option<f64>,
    /// Whether it is reached.
    pub target_met: Option<bool>,
    /// What limits it, in words.
    pub limit: String,
    /// The size at which isolation counts: the first that is at least twice the smallest.
    pub isolation_percent: Option<f64>,
    /// The rival of the paper's Table 1 and how often it was told apart at the size at which isolation counts.
    pub rival: Option<Rival>,
    /// What keeps the two from being told apart, in words.
    pub pair_limit: String,
    /// What was named, of the detected runs from the smallest size on (of all sizes where none is reached).
    pub named: Vec<Named>,
}

/// A pair counts as told apart from this share of the detected runs on.
pub const TOLD_APART: f64 = 0.95;

/// A pair that shares a row of the paper's Table 1.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Rival {
    /// The other side.
    pub cause: &'static str,
    /// Size at which it is counted, percent.
    pub change_percent: f64,
    /// Detected runs in which the true side is named and is likelier than the other.
    pub right: Share,
    /// Detected runs in which the true side is named and the other is not even tied with it.
    pub told_apart: Share,
}

/// One size of a fault.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Size {
    /// Change, percent.
    pub change_percent: f64,
    /// Runs with FAULT after the fault.
    pub detected: Share,
    /// Of these, runs in which FAULT came in motion first.
    pub found_in_motion: u64,
    /// Probability of that, at least, with 95 % confidence.
    pub probability_at_least: f64,
    /// Median delay, s.
    pub delay_median_s: Option<f64>,
    /// Delay that 95 % of the detected runs keep, s.
    pub delay_95_s: Option<f64>,
    /// Detected runs in which the true cause is likelier than any other.
    pub cause_right: Share,
    /// Detected runs in which the true cause is the likeliest or tied with it.
    pub truth_named: Share,
    /// Detected runs in which cause and phase are right.
    pub isolated: Share,
    /// Runs that say nothing because FAULT was lit before.
    pub lit_before: u64,
    /// Runs that say nothing because the motor stalled or swung.
    pub unsteady: u64,
}

impl Detection {
    /// The row of the smallest size that is detected.
    pub fn smallest(&self) -> Option<&Size> {
        self.size(self.smallest_percent?)
    }

    /// The row at which isolation counts.
    pub fn isolation(&self) -> Option<&Size> {
        self.size(self.isolation_percent?)
    }

    fn size(&self, percent: f64) -> Option<&Size> {
        self.sizes
            .iter()
            .find(|size| size.change_percent == percent)
    }
}

/// Every fault of a campaign, in each direction.
pub(crate) fn detection(results: &Results) -> Vec<Detection> {
    let key = |row: &Row| {
        let is_faulty = !row.fault.is_empty() && row.not_run.is_empty();
        let names = || (row.motor.clone(), row.block.clone(), row.fault.clone());
        is_faulty.then(|| (names(), direction(row)))
    };
    let groups = grouped(&results.rows, key).into_iter();
    let mut all: Vec<_> = groups
        .map(|group| one_fault(&results.about, &group))
        .collect();
    let order = |d: &Detection| (d.motor.clone(), d.block.clone());
    all.sort_by_key(order);
    all
}

/// Which way a fault moves what it breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[schemars(rename = "SizeDirection")]
pub enum Direction {
    /// Upwards.
    #[serde(rename = "+")]
    More,
    /// Downwards.
    #[serde(rename = "-")]
    Less,
    /// A sensor that shows nothing.
    #[serde(rename = "dead")]
    Dead,
}

fn direction(row: &Row) -> Direction {
    match row.change_percent {
        x if x > 0.0 => Direction::More,
        x if x > DEAD_PERCENT => Direction::Less,
        _ => Direction::Dead,
    }
}

/// A sensor that is dead is 100 % off, and this is what is wanted of it.
const DEAD_PERCENT: f64 = -100.0;

fn one_fault(about: &About, group: &[&Row]) -> Detection {
    let first = group[0];
    let sizes = sizes(group);
    let smallest = smallest(&sizes);
    let target = about
        .targets
        .iter()
        .find(|target| target.block == first.block && target.fault == first.fault);
    let direction = direction(first);
    let isolation = smallest.and_then(|smallest| at_least_twice(&sizes, smallest));
    let target_percent = target.and_then(|target| target.percent).map(|percent| {
        if direction == Direction::Dead {
            -DEAD_PERCENT
        } else {
            percent
        }
    });
    let met = |target: f64| smallest.is_some_and(|smallest| smallest.abs() <= target);
    Detection {
        motor: first.motor.clone(),
        block: first.block.clone(),
        fault: first.fault.clone(),
        direction,
        lit_before: Share::count(group.iter().map(|row| row.lit_before)),
        unsteady: Share::count(group.iter().map(|row| row.is_unsteady())),
        smallest_percent: smallest,
        or_smaller: direction != Direction::Dead
            && sizes.first().map(|size| size.change_percent) == smallest,
        target_percent,
        target_met: target_percent.map(met),
        limit: target.map_or(String::new(), |target| target.limit.clone()),
        pair_limit: target.map_or(String::new(), |target| target.pair_limit.clone()),
        isolation_percent: isolation,
        rival: isolation.and_then(|percent| rival(group, percent)),
        named: named(group, smallest.map_or(0.0, f64::abs)),
        sizes,
    }
}

fn sizes(group: &[&Row]) -> Vec<Size> {
    let mut percents: Vec<f64> = group.iter().map(|row| row.change_percent).collect();
    percents.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    percents.dedup();
    let rows = |percent: f64| {
        group
            .iter()
            .filter(move |row| row.change_percent == percent)
    };
    percents
        .into_iter()
        .map(|percent| size(percent, &rows(percent).copied().collect::<Vec<_>>()))
        .collect()
}

fn size(change_percent: f64, rows: &[&Row]) -> Size {
    let tries = rows.iter().filter(|row| row.is_a_try());
    let detected = Share::count(tries.map(|row| row.detected));
    let found: Vec<&&Row> = rows
        .iter()
        .filter(|row| row.is_a_try() && row.detected)
        .collect();
    let mut delays: Vec<f64> = found.iter().map(|row| row.delay_s).collect();
    Size {
        change_percent,
        detected,
        found_in_motion: found.iter().filter(|row| row.found_in_motion).count() as u64,
        probability_at_least: detected.at_least(),
        delay_median_s: quantile(&mut delays, 0.5),
        delay_95_s: quantile(&mut delays, 0.95),
        cause_right: Share::count(found.iter().map(|row| row.name_right)),
        truth_named: Share::count(found.iter().map(|row| row.truth_named)),
        isolated: Share::count(found.iter().map(|row| row.is_isolated())),
        lit_before: rows.iter().filter(|row| row.lit_before).count() as u64,
        unsteady: rows.iter().filter(|row| row.is_unsteady()).count() as u64,
    }
}

/// The smallest size from which on every size is detected. Where FAULT was lit before in most of the runs, the few that
/// are left are no evidence: their alarm would have come anyway. Sizes with which most motors stall are beyond the scale.
fn smallest(sizes: &[Size]) -> Option<f64> {
    let is_evidence = |size: &Size| size.detected.of > size.lit_before;
    let is_detected = |size: &&Size| is_evidence(size) && size.detected.value() >= DETECTED;
    let stalls = |size: &&Size| size.unsteady > size.detected.of + size.lit_before;
    let judged = sizes.iter().rev().skip_while(stalls);
    let from = judged.take_while(is_detected).last();
    from.map(|size| size.change_percent)
}

fn at_least_twice(sizes: &[Size], smallest: f64) -> Option<f64> {
    // Sizes such as 3.3 are not doubled exactly.
    let twice = 1.999 * smallest.abs();
    let mut sizes = sizes.iter().map(|size| size.change_percent);
    sizes.find(|percent| percent.abs() >= twice)
}

fn rival(group: &[&Row], percent: f64) -> Option<Rival> {
    let pair = FaultKind::find(&group.first()?.fault)?.pair?;
    let is_counted = |row: &&&Row| row.is_a_try() && row.detected && row.change_percent == percent;
    let sides: Vec<Sides> = group
        .iter()
        .filter(is_counted)
        .map(|row| pair.sides(&row.faults()))
        .collect();
    Some(Rival {
        cause: pair.rival,
        change_percent: percent,
        right: Share::count(sides.iter().map(|sides| sides.right)),
        told_apart: Share::count(sides.iter().map(|sides| sides.apart)),
    })
}

fn named(group: &[&Row], from: f64) -> Vec<Named> {
    let is_counted =
        |row: &&&Row| row.is_a_try() && row.detected && row.change_percent.abs() >= from;
    counted(group.iter().filter(is_counted).map(|row| answer(row)))
}

fn answer(row: &Row) -> String {
    let name = if row.named.is_empty() {
        "nothing"
    } else {
        &row.named
    };
    if row.phase.is_empty() || row.named_phase.is_empty() {
        return name.to_owned();
    }
    let phase = if row.phase_right { "right" } else { "wrong" };
    format!("{name} in the {phase} phase")
}
