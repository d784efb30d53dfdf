//! Alarms of a month: when they rose and ended, who took note, what people called false.

use std::collections::{BTreeMap, HashMap, HashSet};

use fleet::alarm::{AlarmChange, Change, Who};
use fleet::{Entry, EntryFilter, Reader, StoreError};
use schemars::JsonSchema;
use serde::Serialize;

use super::OfCause;
use super::calendar::minute;
use crate::fleet::convert;

/// Entries of one question.
const PAGE: usize = 2_000;
/// An hour, ms.
const HOUR_MS: f64 = 3_600_000.0;
/// A person marks an alarm as false with these words in a comment.
pub(in crate::fleet) const MARK: &str = "false alarm";

/// An alarm that rose.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Happened {
    /// Its number in this plant.
    pub number: u64,
    /// Its motor; `null`: the plant as a whole.
    pub motor: Option<String>,
    /// What it is about, in words.
    pub words: String,
    /// `high`, `medium` or `low`.
    pub severity: &'static str,
    /// When it rose, Unix ms.
    pub raised_ms: i64,
    /// The same in UTC, as 2026-10-05 14:03.
    pub raised: String,
    /// When it returned, Unix ms; `null`: not within the month.
    pub returned_ms: Option<i64>,
    /// How long it lasted within the month, h.
    pub hours: f64,
    /// Who acknowledged it; `null`: nobody within the month.
    pub acknowledged_by: Option<String>,
    /// How long that took, h.
    pub acknowledged_after_hours: Option<f64>,
    /// What the person wrote.
    pub comment: String,
    /// Whether a person marked it as false: "false alarm" in a comment.
    pub marked_false: bool,
}

/// Alarms that rose in a time, the first of them first.
///
/// # Errors
/// The store cannot be read.
pub(super) fn of_month(
    reader: &Reader,
    from_ms: i64,
    to_ms: i64,
) -> Result<Vec<Happened>, StoreError> {
    let mut all: Vec<Happened> = Vec::new();
    let mut open: HashMap<u64, usize> = HashMap::new();
    for change in changes(reader, from_ms, to_ms)? {
        let number = change.alarm.number;
        if change.change == Change::Raised {
            open.insert(number, all.len());
            all.push(raised(&change));
        } else if let Some(alarm) = open.get(&number).and_then(|place| all.get_mut(*place)) {
            take(alarm, &change);
        }
    }
    for alarm in &mut all {
        let end_ms = alarm.returned_ms.unwrap_or(to_ms);
        alarm.hours = (end_ms - alarm.raised_ms).max(0) as f64 / HOUR_MS;
    }
    Ok(all)
}

/// Changes of alarms within a time, the oldest first.
fn changes(reader: &Reader, from_ms: i64, to_ms: i64) -> Result<Vec<AlarmChange>, StoreError> {
    let mut found = Vec::new();
    let mut filter = EntryFilter {
        alarms: true,
        ..EntryFilter::default()
    };
    loop {
        let page = reader.entries(&filter, PAGE)?;
        filter.before = page.last().map(|stored| stored.id);
        let last_ms = page.last().map(|stored| stored.entry.time_ms());
        let is_last = page.len() < PAGE;
        for stored in page {
            if let Entry::Alarm(change) = stored.entry
                && (from_ms..to_ms).contains(&change.time_ms)
            {
                found.push(change);
            }
        }
        // Entries stand in the order in which they were stored: a link that was away for long brings older ones, a day at most.
        let passed = last_ms.is_none_or(|ms| ms < from_ms - super::DAY_MS);
        if is_last || passed {
            found.reverse();
            return Ok(found);
        }
    }
}

fn raised(change: &AlarmChange) -> Happened {
    let alarm = &change.alarm;
    Happened {
        number: alarm.number,
        motor: alarm.motor.as_ref().map(ToString::to_string),
        words: convert::about(alarm),
        severity: convert::severity(alarm.severity),
        raised_ms: change.time_ms,
        raised: minute(change.time_ms),
        returned_ms: None,
        hours: 0.0,
        acknowledged_by: None,
        acknowledged_after_hours: None,
        comment: String::new(),
        marked_false: false,
    }
}

fn take(alarm: &mut Happened, change: &AlarmChange) {
    let Who::User(name) = &change.who else {
        if change.change == Change::Returned {
            alarm.returned_ms = Some(change.time_ms);
        }
        return;
    };
    alarm.marked_false |= change.why.to_lowercase().contains(MARK);
    if !change.why.is_empty() {
        alarm.comment.clone_from(&change.why);
    }
    if change.change == Change::Acknowledged && alarm.acknowledged_by.is_none() {
        let after_ms = change.time_ms - alarm.raised_ms;
        alarm.acknowledged_by = Some(name.clone());
        alarm.acknowledged_after_hours = Some(after_ms.max(0) as f64 / HOUR_MS);
    }
}

/// The same by cause, most first.
pub(super) fn by_cause(all: &[Happened]) -> Vec<OfCause> {
    let mut causes: BTreeMap<&str, (OfCause, HashSet<Option<&str>>)> = BTreeMap::new();
    for alarm in all {
        let (cause, motors) = causes.entry(&alarm.words).or_insert_with(|| {
            let cause = OfCause {
                words: alarm.words.clone(),
                alarms: 0,
                motors: 0,
                marked_false: 0,
                hours: 0.0,
            };
            (cause, HashSet::new())
        });
        cause.alarms += 1;
        cause.marked_false += u32::from(alarm.marked_false);
        cause.hours += alarm.hours;
        motors.insert(alarm.motor.as_deref());
        cause.motors = motors.len() as u32;
    }
    let mut causes: Vec<OfCause> = causes.into_values().map(|(cause, _)| cause).collect();
    causes.sort_by_key(|cause| std::cmp::Reverse(cause.alarms));
    causes
}
