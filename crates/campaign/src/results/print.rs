//! The table as a person reads it.

use std::fmt::{Display, Formatter, Result};

use crate::results::detection::{Detection, Direction, Size};
use crate::results::groups::Named;
use crate::results::statistics::Share;
use crate::results::table::{Healthy, Table};

/// More alarms than this are left to the JSON.
const MOST_ALARMS: usize = 20;

impl Display for Table {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let about = &self.about;
        writeln!(
            f,
            "{}: {} of {} runs, seed {}; {} could not run under their conditions",
            about.plan, self.counted, about.runs, about.seed, self.not_run
        )?;
        healthy(f, self)?;
        if self.detection.is_empty() {
            return Ok(());
        }
        detection(f, self)
    }
}

fn healthy(f: &mut Formatter<'_>, table: &Table) -> Result {
    writeln!(
        f,
        "\nHealthy: {} windows judged, FAULT in {}",
        table.healthy_windows, table.fault_windows
    )?;
    writeln!(
        f,
        "  motor              block                              windows  FAULT    runs  with FAULT  at most"
    )?;
    for row in &table.healthy {
        writeln!(
            f,
            "  {:<18} {:<32} {:>9}  {:>5}  {:>6}  {:>10}  {:>5.2} %",
            row.motor,
            row.block,
            row.judged_windows,
            row.fault_windows,
            row.fault_runs.of,
            row.fault_runs.count,
            100.0 * row.fault_run_probability_at_most
        )?;
    }
    if let Some(moved) = in_motion(table) {
        writeln!(f, "  {moved}")?;
    }
    if !table.causes.is_empty() {
        writeln!(
            f,
            "  to blame for FAULT: {}",
            named(&table.causes, table.causes.len())
        )?;
    }
    for alarm in table.alarms.iter().take(MOST_ALARMS) {
        writeln!(
            f,
            "  run {:>6} {}: FAULT from {:.3} s in {} windows ({} judged), lamps {}, named {}, to blame: {}; {}",
            alarm.index,
            alarm.motor,
            alarm.first_s,
            alarm.fault_windows,
            alarm.judged_windows,
            alarm.lamps,
            alarm.named,
            alarm.cause,
            alarm.conditions
        )?;
    }
    let more = table.alarms.len().saturating_sub(MOST_ALARMS);
    if more > 0 {
        writeln!(f, "  ... and {more} more runs (--json FILE has them all)")?;
    }
    Ok(())
}

/// What came of the windows that were not at rest, where the plan asks for them.
pub(crate) fn in_motion(table: &Table) -> Option<String> {
    let sum = |of: fn(&Healthy) -> u64| table.healthy.iter().map(of).sum::<u64>();
    let moved = sum(|row| row.moved_windows);
    let judged = sum(|row| row.motion_judged_windows);
    let unexplained = sum(|row| row.unexplained_runs);
    (moved > 0).then(|| {
        format!(
            "{moved} windows were not at rest; {judged} of them were judged in motion; in {unexplained} runs something came that no \
             fault explains"
        )
    })
}

fn detection(f: &mut Formatter<'_>, table: &Table) -> Result {
    writeln!(
        f,
        "\nDetection: smallest size seen in 99 of 100 runs, and what is named from there on; left out: FAULT was lit before the fault"
    )?;
    let mut place = (String::new(), String::new());
    for row in &table.detection {
        let now = (row.motor.clone(), row.block.clone());
        if now != place {
            writeln!(f, "\n  {}, {}", now.0, now.1)?;
            writeln!(
                f,
                "  fault     smallest  proven  median     95 %  cause  at twice  left out  target  named"
            )?;
            place = now;
        }
        one(f, row)?;
    }
    Ok(())
}

fn one(f: &mut Formatter<'_>, row: &Detection) -> Result {
    write!(f, "  {:<8} ", row.fault)?;
    match row.smallest() {
        Some(size) => smallest(f, &size_of(row), size)?,
        None => write!(f, "{:>9}  {:<30}", "none", best(row))?,
    }
    let isolated = row.isolation().map(|size| size.isolated);
    writeln!(
        f,
        " {:>8}  {:>8}  {:<7} {}",
        percent(isolated),
        percent(Some(row.lit_before)),
        target(row),
        named(&row.named, 3)
    )
}

/// The smallest size in words: `dead`, `+15 %`, `<= +2 %` where nothing smaller was tried.
pub(crate) fn size_of(row: &Detection) -> String {
    let percent = row.smallest_percent.unwrap_or(f64::NAN);
    match (row.direction, row.or_smaller) {
        (Direction::Dead, _) => "dead".to_owned(),
        (_, true) => format!("<= {percent:+} %"),
        (_, false) => format!("{percent:+} %"),
    }
}

fn smallest(f: &mut Formatter<'_>, words: &str, size: &Size) -> Result {
    write!(
        f,
        "{words:>9}  {:>5.1}%  {}  {}  {:>5}",
        100.0 * size.probability_at_least,
        milliseconds(size.delay_median_s),
        milliseconds(size.delay_95_s),
        percent(Some(size.cause_right))
    )
}

/// How far the largest size comes.
fn best(row: &Detection) -> String {
    row.sizes.last().map_or(String::new(), |size| {
        format!(
            "{} of {:+.0} %",
            percent(Some(size.detected)),
            size.change_percent
        )
    })
}

fn milliseconds(seconds: Option<f64>) -> String {
    seconds.map_or(format!("{:>6}", "-"), |s| format!("{:>4.0}ms", 1000.0 * s))
}

/// A share in percent; `-` of nothing.
pub(crate) fn percent(share: Option<Share>) -> String {
    match share {
        Some(share) if share.of > 0 => format!("{:.0} %", 100.0 * share.value()),
        _ => "-".to_owned(),
    }
}

/// The wanted size and whether it is reached.
pub(crate) fn target(row: &Detection) -> String {
    match (row.target_percent, row.target_met) {
        (Some(target), Some(true)) => format!("{target:.0} % ="),
        (Some(target), _) => format!("{target:.0} % x"),
        _ => String::new(),
    }
}

/// The most frequent answers with their shares.
pub(crate) fn named(all: &[Named], most: usize) -> String {
    let of: u64 = all.iter().map(|named| named.runs).sum();
    let one = |named: &Named| {
        let share = Share {
            count: named.runs,
            of,
        };
        format!("{} {}", named.cause, percent(Some(share)))
    };
    all.iter()
        .take(most)
        .map(one)
        .collect::<Vec<_>>()
        .join(", ")
}
