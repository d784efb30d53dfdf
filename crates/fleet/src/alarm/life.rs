//! One alarm from state to state.

use super::change::{Alarm, AlarmChange, AlarmState, Change, Who};
use super::read::Details;

/// A board writes an event within a minute of what it tells; within this time of an alarm that seconds raised, the event is the
/// same occurrence, ms.
const SAME_MS: i64 = 60_000;

/// A size that grew by this factor is told.
const GREW: f32 = 1.5;

impl Alarm {
    /// The state that follows from what is known of it.
    pub(super) fn derived(&self) -> AlarmState {
        if self.suppressed {
            return AlarmState::Suppressed;
        }
        if self.shelved_until_ms.is_some() {
            return AlarmState::Shelved;
        }
        match (self.present, self.acknowledged) {
            (true, false) => AlarmState::Unacknowledged,
            (true, true) => AlarmState::Acknowledged,
            (false, false) => AlarmState::ReturnedUnacknowledged,
            (false, true) => AlarmState::Normal,
        }
    }

    /// Changes it and tells the change.
    pub(super) fn step(
        &mut self,
        change: Change,
        who: Who,
        why: &str,
        time_ms: i64,
        work: impl FnOnce(&mut Self),
    ) -> AlarmChange {
        let before = self.state;
        work(self);
        self.state = self.derived();
        self.changed_ms = time_ms;
        AlarmChange {
            change,
            before,
            alarm: self.clone(),
            who,
            time_ms,
            why: why.to_owned(),
        }
    }
}

/// Whether an event tells nothing new of an alarm: it is the occurrence that seconds showed, and what is now they know better.
pub(super) fn overruled(alarm: &Alarm, on: bool, time_ms: i64) -> bool {
    let by_seconds = alarm.evidence.second.is_some();
    by_seconds && (!on || (time_ms - alarm.raised_ms).abs() <= SAME_MS)
}

/// The alarm gets the number of the event that tells the same.
pub(super) fn with_event(alarm: &mut Alarm, details: Details, time_ms: i64) -> AlarmChange {
    let Details { evidence, who, .. } = details;
    alarm.step(Change::Updated, who, &evidence.words, time_ms, |alarm| {
        alarm.evidence.event = evidence.event;
    })
}

/// It was there, went, and comes again before it was normal.
pub(super) fn raised_again(alarm: &mut Alarm, details: Details, time_ms: i64) -> AlarmChange {
    let Details {
        severity,
        fault,
        size,
        evidence,
        who,
    } = details;
    let why = evidence.words.clone();
    alarm.step(Change::Raised, who, &why, time_ms, |alarm| {
        alarm.present = true;
        alarm.acknowledged = false;
        alarm.severity = severity;
        (alarm.fault, alarm.size) = (fault, size);
        alarm.evidence = evidence;
        alarm.raised_ms = time_ms;
        alarm.times = alarm.times.saturating_add(1);
    })
}

/// Cause or size of an alarm that is there changed: the same alarm, told at most once in `update_ms`. Size and residuals
/// are the largest since it rose.
pub(super) fn updated(
    alarm: &mut Alarm,
    new: &Details,
    time_ms: i64,
    update_ms: i64,
) -> Option<AlarmChange> {
    let grew = match (alarm.size, new.size) {
        (Some(before), Some(now)) => now > before * GREW,
        (before, now) => before.is_none() && now.is_some(),
    };
    let other = new.fault != 0 && new.fault != alarm.fault;
    // Who must act sooner is told at once.
    let worse = new.severity > alarm.severity;
    let due = time_ms - alarm.changed_ms >= update_ms;
    if !(worse || due && (grew || other)) {
        return None;
    }
    let (why, who) = (new.evidence.words.clone(), new.who.clone());
    Some(alarm.step(Change::Updated, who, &why, time_ms, |alarm| {
        alarm.severity = alarm.severity.max(new.severity);
        if new.fault != 0 {
            alarm.fault = new.fault;
        }
        if grew {
            alarm.size = new.size;
            alarm.evidence.residuals = new.evidence.residuals;
            alarm.evidence.second = new.evidence.second.or(alarm.evidence.second);
            alarm.evidence.words = new.evidence.words.clone();
        }
    }))
}
