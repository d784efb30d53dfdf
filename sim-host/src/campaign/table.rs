//! What rows amount to: healthy windows and their alarms, smallest sizes, delays, confusion.

use std::collections::BTreeMap;

use serde::Serialize;

use super::file::{About, Results};
use super::row::Row;
use super::statistics::{Share, quantile};

/// A size counts as detected from this share of runs on.
pub const DETECTED: f64 = 0.99;

/// A campaign, counted.
#[derive(Clone, Debug, Serialize)]
pub struct Table {
    /// Which campaign.
    #[serde(flatten)]
    pub about: About,
    /// Runs that are counted here.
    pub counted: u64,
    /// Runs whose motor cannot run under their conditions.
    pub not_run: u64,
    /// Healthy windows judged.
    pub healthy_windows: u64,
    /// Windows with FAULT lit among the healthy ones.
    pub fault_windows: u64,
    /// Targets that are met.
    pub targets_met: Share,
    /// Healthy windows, by motor and block.
    pub healthy: Vec<Healthy>,
    /// Runs with FAULT on a healthy motor.
    pub alarms: Vec<Alarm>,
    /// How often each condition was to blame for them.
    pub causes: Vec<Named>,
    /// What is detected.
    pub detection: Vec<Detection>,
}

/// The healthy windows of one motor in one block.
#[derive(Clone, Debug, Serialize)]
pub struct Healthy {
    /// The motor.
    pub motor: String,
    /// The block.
    pub block: String,
    /// Windows judged.
    pub judged_windows: u64,
    /// Windows with FAULT lit.
    pub fault_windows: u64,
    /// Runs with such windows.
    pub fault_runs: Share,
    /// Probability of such a run, at most, with 95 % confidence.
    pub fault_run_probability_at_most: f64,
}

/// FAULT on a healthy motor.
#[derive(Clone, Debug, Serialize)]
pub struct Alarm {
    /// The run.
    pub index: u64,
    /// The motor.
    pub motor: String,
    /// The block.
    pub block: String,
    /// Windows with FAULT lit.
    pub fault_windows: u32,
    /// Windows judged.
    pub judged_windows: u32,
    /// When it was lit first, s.
    pub first_s: f64,
    /// Lamps seen.
    pub lamps: String,
    /// Likeliest cause named.
    pub named: String,
    /// The conditions without any single one of which FAULT stays dark.
    pub cause: String,
    /// The conditions in words.
    pub conditions: String,
}

/// How well one fault is detected in one direction.
#[derive(Clone, Debug, Serialize)]
pub struct Detection {
    /// The motor.
    pub motor: String,
    /// The block.
    pub block: String,
    /// The fault.
    pub fault: String,
    /// Runs that say nothing because FAULT was lit before the fault came.
    pub lit_before: Share,
    /// The sizes, from small to large.
    pub sizes: Vec<Size>,
    /// The smallest size from which on 99 of 100 runs are detected, percent.
    pub smallest_percent: Option<f64>,
    /// The size that is wanted, percent.
    pub target_percent: Option<f64>,
    /// Whether it is reached.
    pub target_met: Option<bool>,
    /// What limits it, in words.
    pub limit: String,
    /// The size at which isolation counts: the first that is at least twice the smallest.
    pub isolation_percent: Option<f64>,
    /// What was named, of the detected runs from the smallest size on (of all sizes where none is reached).
    pub named: Vec<Named>,
}

/// One size of a fault.
#[derive(Clone, Debug, Serialize)]
pub struct Size {
    /// Change, percent.
    pub change_percent: f64,
    /// Runs with FAULT after the fault.
    pub detected: Share,
    /// Probability of that, at least, with 95 % confidence.
    pub probability_at_least: f64,
    /// Median delay, s.
    pub delay_median_s: Option<f64>,
    /// Delay that 95 % of the detected runs keep, s.
    pub delay_95_s: Option<f64>,
    /// Detected runs in which the true cause is likelier than any other.
    pub cause_right: Share,
    /// Detected runs in which cause and phase are right.
    pub isolated: Share,
    /// Runs that say nothing because FAULT was lit before.
    pub lit_before: u64,
}

/// An answer and how often it came.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Named {
    /// Likeliest cause, with what is known about its phase.
    pub cause: String,
    /// Runs.
    pub runs: u64,
}

impl Table {
    /// Counts a campaign.
    pub fn of(results: &Results) -> Table {
        let rows = &results.rows;
        let (healthy, detection) = (healthy(rows), detection(results));
        Table {
            about: results.about.clone(),
            counted: rows.len() as u64,
            not_run: rows.iter().filter(|row| !row.not_run.is_empty()).count() as u64,
            healthy_windows: healthy.iter().map(|row| row.judged_windows).sum(),
            fault_windows: healthy.iter().map(|row| row.fault_windows).sum(),
            targets_met: Share::count(detection.iter().filter_map(|row| row.target_met)),
            alarms: rows.iter().filter(is_alarm).map(alarm).collect(),
            causes: counted(
                rows.iter()
                    .filter(is_alarm)
                    .map(|row| row.false_cause.clone()),
            ),
            healthy,
            detection,
        }
    }
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

/// Rows in groups, in the order of their first appearance.
fn grouped<K: Ord + Clone>(rows: &[Row], key: impl Fn(&Row) -> Option<K>) -> Vec<Vec<&Row>> {
    let mut places = BTreeMap::new();
    let mut groups: Vec<Vec<&Row>> = Vec::new();
    for row in rows {
        let Some(key) = key(row) else {
            continue;
        };
        let place = *places.entry(key).or_insert_with(|| {
            groups.push(Vec::new());
            groups.len() - 1
        });
        groups[place].push(row);
    }
    groups
}

fn healthy(rows: &[Row]) -> Vec<Healthy> {
    let key = |row: &Row| {
        row.not_run
            .is_empty()
            .then(|| (row.motor.clone(), row.block.clone()))
    };
    let groups = grouped(rows, key).into_iter();
    let count = |group: Vec<&Row>| {
        let fault_runs = Share::count(group.iter().map(is_alarm));
        let sum = |of: fn(&Row) -> u32| group.iter().map(|row| u64::from(of(row))).sum();
        Healthy {
            motor: group[0].motor.clone(),
            block: group[0].block.clone(),
            judged_windows: sum(|row| row.healthy_judged_windows),
            fault_windows: sum(|row| row.healthy_fault_windows),
            fault_runs,
            fault_run_probability_at_most: fault_runs.at_most(),
        }
    };
    groups.map(count).collect()
}

fn is_alarm(row: &&Row) -> bool {
    row.healthy_fault_windows > 0
}

fn alarm(row: &Row) -> Alarm {
    Alarm {
        index: row.index,
        motor: row.motor.clone(),
        block: row.block.clone(),
        fault_windows: row.healthy_fault_windows,
        judged_windows: row.healthy_judged_windows,
        first_s: row.first_false_s,
        lamps: row.healthy_lamps.clone(),
        named: row.named.clone(),
        cause: row.false_cause.clone(),
        conditions: conditions(row),
    }
}

/// The conditions of a run in words.
pub fn conditions(row: &Row) -> String {
    let step = |to: f64| {
        if to.is_nan() {
            String::new()
        } else {
            format!(" to {to:.0}")
        }
    };
    format!(
        "load {:.0}{} %, voltage {:.0}{} %, {:.1} Hz, unbalance {:.1} %, THD {:.1} %, {:.0} degC, noise {:.2} %, gains within {:.2} %",
        row.load_percent,
        step(row.load_step_to_percent),
        row.voltage_percent,
        step(row.voltage_step_to_percent),
        row.frequency_hz,
        row.unbalance_percent,
        row.voltage_thd_percent,
        row.winding_degc,
        row.noise_percent_of_full_scale,
        row.sensor_gain_error_percent,
    )
}

fn detection(results: &Results) -> Vec<Detection> {
    let key = |row: &Row| {
        let is_faulty = !row.fault.is_empty() && row.not_run.is_empty();
        let names = || (row.motor.clone(), row.block.clone(), row.fault.clone());
        is_faulty.then(|| (names(), row.change_percent < 0.0))
    };
    let groups = grouped(&results.rows, key).into_iter();
    let mut all: Vec<_> = groups
        .map(|group| one_fault(&results.about, &group))
        .collect();
    let order = |d: &Detection| (d.motor.clone(), d.block.clone());
    all.sort_by_key(order);
    all
}

fn one_fault(about: &About, group: &[&Row]) -> Detection {
    let first = group[0];
    let sizes = sizes(group);
    let smallest = smallest(&sizes);
    let target = about
        .targets
        .iter()
        .find(|target| target.block == first.block && target.fault == first.fault);
    let target_percent = target.and_then(|target| target.percent);
    let met = |target: f64| smallest.is_some_and(|smallest| smallest.abs() <= target);
    Detection {
        motor: first.motor.clone(),
        block: first.block.clone(),
        fault: first.fault.clone(),
        lit_before: Share::count(group.iter().map(|row| row.lit_before)),
        smallest_percent: smallest,
        target_percent,
        target_met: target_percent.map(met),
        limit: target.map_or(String::new(), |target| target.limit.clone()),
        isolation_percent: smallest.and_then(|smallest| at_least_twice(&sizes, smallest)),
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
        probability_at_least: detected.at_least(),
        delay_median_s: quantile(&mut delays, 0.5),
        delay_95_s: quantile(&mut delays, 0.95),
        cause_right: Share::count(found.iter().map(|row| row.name_right)),
        isolated: Share::count(found.iter().map(|row| row.is_isolated())),
        lit_before: rows.iter().filter(|row| row.lit_before).count() as u64,
    }
}

/// The smallest size from which on every size is detected.
fn smallest(sizes: &[Size]) -> Option<f64> {
    let is_detected = |size: &&Size| size.detected.of > 0 && size.detected.value() >= DETECTED;
    let from = sizes.iter().rev().take_while(is_detected).last();
    from.map(|size| size.change_percent)
}

fn at_least_twice(sizes: &[Size], smallest: f64) -> Option<f64> {
    // Sizes such as 3.3 are not doubled exactly.
    let twice = 1.999 * smallest.abs();
    let mut sizes = sizes.iter().map(|size| size.change_percent);
    sizes.find(|percent| percent.abs() >= twice)
}

fn named(group: &[&Row], from: f64) -> Vec<Named> {
    let is_counted =
        |row: &&&Row| row.is_a_try() && row.detected && row.change_percent.abs() >= from;
    counted(group.iter().filter(is_counted).map(|row| answer(row)))
}

/// How often each text came, the most frequent first.
fn counted(texts: impl Iterator<Item = String>) -> Vec<Named> {
    let mut counts: BTreeMap<String, u64> = BTreeMap::new();
    for text in texts {
        *counts.entry(text).or_default() += 1;
    }
    let mut named: Vec<_> = counts
        .into_iter()
        .map(|(cause, runs)| Named { cause, runs })
        .collect();
    named.sort_by_key(|named| std::cmp::Reverse(named.runs));
    named
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
