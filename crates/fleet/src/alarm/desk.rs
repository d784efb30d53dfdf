//! The life cycle of all alarms of a plant, without clock, file or network.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::change::{Alarm, AlarmCause, AlarmChange, AlarmState, Change, Evidence, Severity, Who};
use super::flood::Flood;
use super::read::{Details, Told, conditions};
use super::rules::Rules;
use crate::entry::Entry;
use crate::motor::MotorId;

/// What an alarm is of: `None` is the plant.
type Key = (Option<MotorId>, AlarmCause);

/// A board writes an event within a minute of what it tells; within this time of an alarm that seconds raised, the event is the
/// same occurrence, ms.
const SAME_MS: i64 = 60_000;

/// A size that grew by this factor is told.
const GREW: f32 = 1.5;

/// A condition whose delay runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Pending {
    motor: MotorId,
    cause: AlarmCause,
    on: bool,
    since_ms: i64,
    details: Details,
}

/// What a desk knows beside its alarms: running delays, recent alarms. It is stored with every change.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// Number of the newest alarm.
    last: u64,
    #[serde(with = "listed")]
    pending: BTreeMap<(MotorId, AlarmCause), Pending>,
    flood: Flood,
}

/// What a person does to an alarm.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Action {
    /// Takes note.
    Acknowledge,
    /// Sets it aside until a time.
    Shelve {
        /// End, Unix ms.
        until_ms: i64,
    },
    /// Ends the shelf.
    Unshelve,
    /// Sets it aside while the motor is out of service.
    Suppress,
    /// Ends that.
    Unsuppress,
}

/// Why an action is refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ActionError {
    /// There never was such an alarm.
    #[error("there is no alarm {0}")]
    Unknown(u64),
    /// It is over.
    #[error("alarm {0} is back to normal: there is nothing to set aside")]
    Over(u64),
    /// Who sets an alarm aside says why.
    #[error("give a reason: who finds the alarm set aside must know why")]
    NoReason,
    /// The end is past or too far away.
    #[error("a shelf ends between now and {longest_h} hours from now")]
    Shelf {
        /// Longest shelf, hours.
        longest_h: i64,
    },
}

/// All alarms that are not normal, and what is about to become one.
#[derive(Clone, Debug)]
pub struct Desk {
    rules: Rules,
    memory: Memory,
    alarms: BTreeMap<Key, Alarm>,
}

impl Desk {
    /// A desk that goes on from stored alarms (those that are normal are over) and memory.
    pub fn new(rules: Rules, alarms: Vec<Alarm>, memory: Memory) -> Self {
        let open = alarms
            .into_iter()
            .filter(|alarm| alarm.state != AlarmState::Normal);
        let alarms = open
            .map(|alarm| ((alarm.motor.clone(), alarm.cause), alarm))
            .collect();
        Self {
            rules,
            memory,
            alarms,
        }
    }

    /// What has to be stored with its changes.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Alarms that are not normal.
    pub fn alarms(&self) -> impl Iterator<Item = &Alarm> {
        self.alarms.values()
    }

    /// Takes an entry of a motor; times are those of the entry.
    pub fn take(&mut self, motor: &MotorId, entry: &Entry) -> Vec<AlarmChange> {
        let time_ms = entry.time_ms();
        let told = conditions(entry);
        let mut changes = Vec::new();
        told.into_iter()
            .for_each(|told| self.observe(motor, told, time_ms, &mut changes));
        changes
    }

    /// Lets delays, shelves and floods end. Call it when every entry was taken: `now_ms` is later than all of them.
    pub fn tick(&mut self, now_ms: i64) -> Vec<AlarmChange> {
        let mut changes = Vec::new();
        for pending in self.due(now_ms) {
            self.fire(pending, now_ms, &mut changes);
        }
        self.end_shelves(now_ms, &mut changes);
        self.end_flood(now_ms, &mut changes);
        changes
    }

    /// A person acts. What was done before is done: no change, no error.
    ///
    /// # Errors
    /// No such alarm, no reason, an end of a shelf that cannot be.
    pub fn act(
        &mut self,
        number: u64,
        action: &Action,
        user: &str,
        why: &str,
        now_ms: i64,
    ) -> Result<Vec<AlarmChange>, ActionError> {
        if number == 0 || number > self.memory.last {
            return Err(ActionError::Unknown(number));
        }
        self.allowed(action, why, now_ms)?;
        let Some(alarm) = self
            .alarms
            .values_mut()
            .find(|alarm| alarm.number == number)
        else {
            return match action {
                Action::Shelve { .. } | Action::Suppress => Err(ActionError::Over(number)),
                _ => Ok(Vec::new()),
            };
        };
        let change = apply(alarm, action, Who::User(user.to_owned()), why, now_ms);
        if matches!(action, Action::Unsuppress) {
            self.memory.flood.collected.remove(&number);
        }
        self.forget_normal();
        Ok(change.into_iter().collect())
    }

    /// Takes out the conditions whose delay is over.
    fn due(&mut self, now_ms: i64) -> Vec<Pending> {
        let rules = &self.rules;
        let over = |p: &Pending| now_ms - p.since_ms >= rules.delay_ms(p.cause, p.on);
        let due: Vec<_> = self
            .memory
            .pending
            .values()
            .filter(|p| over(p))
            .cloned()
            .collect();
        for pending in &due {
            self.memory
                .pending
                .remove(&(pending.motor.clone(), pending.cause));
        }
        due
    }

    fn allowed(&self, action: &Action, why: &str, now_ms: i64) -> Result<(), ActionError> {
        let sets_aside = matches!(action, Action::Shelve { .. } | Action::Suppress);
        if sets_aside && why.trim().is_empty() {
            return Err(ActionError::NoReason);
        }
        let longest = self.rules.longest_shelf_ms;
        match action {
            Action::Shelve { until_ms }
                if !(1..=longest).contains(&until_ms.saturating_sub(now_ms)) =>
            {
                Err(ActionError::Shelf {
                    longest_h: longest / 3_600_000,
                })
            }
            _ => Ok(()),
        }
    }

    fn observe(
        &mut self,
        motor: &MotorId,
        told: Told,
        time_ms: i64,
        changes: &mut Vec<AlarmChange>,
    ) {
        let Told {
            cause,
            on,
            details,
            by_event,
        } = told;
        let alarm = self.alarms.get_mut(&(Some(motor.clone()), cause));
        if by_event {
            if let Some(alarm) = alarm.filter(|alarm| overruled(alarm, on, time_ms)) {
                if on && alarm.evidence.event.is_none() {
                    changes.push(with_event(alarm, details, time_ms));
                }
                return;
            }
        } else if let Some(alarm) = alarm.filter(|alarm| on && alarm.present) {
            changes.extend(updated(alarm, &details, time_ms, self.rules.update_ms));
        }
        self.delay(motor, cause, on, details, time_ms, changes);
    }

    /// Runs the delay of a condition that differs from what its alarm says.
    fn delay(
        &mut self,
        motor: &MotorId,
        cause: AlarmCause,
        on: bool,
        details: Details,
        time_ms: i64,
        changes: &mut Vec<AlarmChange>,
    ) {
        let key = (Some(motor.clone()), cause);
        let present = self.alarms.get(&key).is_some_and(|alarm| alarm.present);
        let key = (motor.clone(), cause);
        let before = self.memory.pending.remove(&key);
        if on == present {
            return;
        }
        let since_ms = before.map_or(time_ms, |before| before.since_ms);
        let pending = Pending {
            motor: motor.clone(),
            cause,
            on,
            since_ms,
            details,
        };
        if time_ms - since_ms >= self.rules.delay_ms(cause, on) {
            self.fire(pending, time_ms, changes);
        } else {
            self.memory.pending.insert(key, pending);
        }
    }

    /// A condition came or went, its delay is over.
    fn fire(&mut self, pending: Pending, time_ms: i64, changes: &mut Vec<AlarmChange>) {
        let key = (Some(pending.motor.clone()), pending.cause);
        match (pending.on, self.alarms.get_mut(&key)) {
            (true, Some(alarm)) => changes.push(raised_again(alarm, pending.details, time_ms)),
            (true, None) => self.raise(key, pending.details, time_ms, changes),
            (false, Some(alarm)) => {
                let latch = self.rules.latch;
                let Details { who, evidence, .. } = pending.details;
                let change = alarm.step(Change::Returned, who, &evidence.words, time_ms, |alarm| {
                    alarm.present = false;
                    alarm.acknowledged |= !latch;
                });
                changes.push(change);
                self.forget_normal();
            }
            (false, None) => {}
        }
    }

    /// An alarm that was not there.
    fn raise(&mut self, key: Key, details: Details, time_ms: i64, changes: &mut Vec<AlarmChange>) {
        let severity = details.severity;
        let too_many = self.memory.flood.new_alarm(severity, time_ms, &self.rules);
        let change = self.put_new(key, details, too_many, time_ms);
        let number = change.alarm.number;
        changes.push(change);
        if too_many {
            self.memory.flood.collected.insert(number);
            self.flooded(severity, time_ms, changes);
        }
    }

    fn put_new(
        &mut self,
        key: Key,
        details: Details,
        suppressed: bool,
        time_ms: i64,
    ) -> AlarmChange {
        self.memory.last += 1;
        let Details {
            severity,
            fault,
            phase,
            size,
            evidence,
            who,
        } = details;
        let why = evidence.words.clone();
        let mut alarm = Alarm {
            number: self.memory.last,
            motor: key.0.clone(),
            cause: key.1,
            state: AlarmState::Normal,
            present: true,
            acknowledged: false,
            suppressed,
            severity,
            fault,
            phase,
            size,
            evidence,
            raised_ms: time_ms,
            changed_ms: time_ms,
            times: 1,
            shelved_until_ms: None,
        };
        let change = alarm.step(Change::Raised, who, &why, time_ms, |_| {});
        self.alarms.insert(key, alarm);
        change
    }

    /// Raises the flood's own alarm, or tells that it grew.
    fn flooded(&mut self, severity: Severity, time_ms: i64, changes: &mut Vec<AlarmChange>) {
        let count = self.memory.flood.collected.len();
        let words = format!("{count} alarms are collected here until fewer rise");
        let evidence = Evidence {
            words,
            ..Evidence::default()
        };
        let (size, who) = (Some(count as f32), Who::Gateway);
        let details = Details {
            severity,
            fault: 0,
            phase: None,
            size,
            evidence,
            who,
        };
        let key = (None, AlarmCause::Flood);
        let change = match self.alarms.get_mut(&key) {
            Some(alarm) if alarm.present => {
                let update_ms = self.rules.update_ms;
                updated(alarm, &details, time_ms, update_ms)
            }
            Some(alarm) => Some(raised_again(alarm, details, time_ms)),
            None => Some(self.put_new(key, details, false, time_ms)),
        };
        changes.extend(change);
    }

    fn end_shelves(&mut self, now_ms: i64, changes: &mut Vec<AlarmChange>) {
        for alarm in self.alarms.values_mut() {
            if alarm.shelved_until_ms.is_some_and(|end| end <= now_ms) {
                let unshelve = |alarm: &mut Alarm| alarm.shelved_until_ms = None;
                let who = Who::Gateway;
                changes.push(alarm.step(
                    Change::Unshelved,
                    who,
                    "the shelf ended",
                    now_ms,
                    unshelve,
                ));
            }
        }
        self.forget_normal();
    }

    fn end_flood(&mut self, now_ms: i64, changes: &mut Vec<AlarmChange>) {
        let flood = &mut self.memory.flood;
        if flood.collected.is_empty() || !flood.is_over(now_ms, &self.rules) {
            return;
        }
        let collected = std::mem::take(&mut flood.collected);
        let why = "the flood is over";
        for alarm in self.alarms.values_mut() {
            if collected.contains(&alarm.number) && alarm.suppressed {
                let release = |alarm: &mut Alarm| alarm.suppressed = false;
                changes.push(alarm.step(Change::Unsuppressed, Who::Gateway, why, now_ms, release));
            }
        }
        let latch = self.rules.latch;
        if let Some(alarm) = self.alarms.get_mut(&(None, AlarmCause::Flood)) {
            changes.push(
                alarm.step(Change::Returned, Who::Gateway, why, now_ms, |alarm| {
                    alarm.present = false;
                    alarm.acknowledged |= !latch;
                    alarm.size = Some(collected.len() as f32);
                }),
            );
        }
        self.forget_normal();
    }

    fn forget_normal(&mut self) {
        self.alarms
            .retain(|_, alarm| alarm.state != AlarmState::Normal);
    }
}

/// Whether an event tells nothing new of an alarm: it is the occurrence that seconds showed, and what is now they know better.
fn overruled(alarm: &Alarm, on: bool, time_ms: i64) -> bool {
    let by_seconds = alarm.evidence.second.is_some();
    by_seconds && (!on || (time_ms - alarm.raised_ms).abs() <= SAME_MS)
}

/// The alarm gets the number of the event that tells the same.
fn with_event(alarm: &mut Alarm, details: Details, time_ms: i64) -> AlarmChange {
    let Details { evidence, who, .. } = details;
    alarm.step(Change::Updated, who, &evidence.words, time_ms, |alarm| {
        alarm.evidence.event = evidence.event;
    })
}

/// It was there, went, and comes again before it was normal.
fn raised_again(alarm: &mut Alarm, details: Details, time_ms: i64) -> AlarmChange {
    let Details {
        severity,
        fault,
        phase,
        size,
        evidence,
        who,
    } = details;
    let why = evidence.words.clone();
    alarm.step(Change::Raised, who, &why, time_ms, |alarm| {
        alarm.present = true;
        alarm.acknowledged = false;
        alarm.severity = severity;
        (alarm.fault, alarm.phase, alarm.size) = (fault, phase, size);
        alarm.evidence = evidence;
        alarm.raised_ms = time_ms;
        alarm.times = alarm.times.saturating_add(1);
    })
}

/// Cause, phase or size of an alarm that is there changed: the same alarm, told at most once in `update_ms`. Size and residuals
/// are the largest since it rose.
fn updated(alarm: &mut Alarm, new: &Details, time_ms: i64, update_ms: i64) -> Option<AlarmChange> {
    let grew = match (alarm.size, new.size) {
        (Some(before), Some(now)) => now > before * GREW,
        (before, now) => before.is_none() && now.is_some(),
    };
    let other = new.fault != 0 && new.fault != alarm.fault;
    let other_phase = new.phase.is_some() && new.phase != alarm.phase;
    // Who must act sooner is told at once.
    let worse = new.severity > alarm.severity;
    let due = time_ms - alarm.changed_ms >= update_ms;
    if !(worse || due && (grew || other || other_phase)) {
        return None;
    }
    let (why, who) = (new.evidence.words.clone(), new.who.clone());
    Some(alarm.step(Change::Updated, who, &why, time_ms, |alarm| {
        alarm.phase = new.phase.or(alarm.phase);
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

/// Does what a person asks; `None` where it is so already.
fn apply(
    alarm: &mut Alarm,
    action: &Action,
    who: Who,
    why: &str,
    now_ms: i64,
) -> Option<AlarmChange> {
    type Work = fn(&mut Alarm, Option<i64>);
    let (change, until, work): (Change, Option<i64>, Work) = match action {
        Action::Acknowledge if !alarm.acknowledged => (Change::Acknowledged, None, |alarm, _| {
            alarm.acknowledged = true
        }),
        Action::Shelve { until_ms } if alarm.shelved_until_ms != Some(*until_ms) => {
            (Change::Shelved, Some(*until_ms), |alarm, until| {
                alarm.shelved_until_ms = until
            })
        }
        Action::Unshelve if alarm.shelved_until_ms.is_some() => {
            (Change::Unshelved, None, |alarm, until| {
                alarm.shelved_until_ms = until
            })
        }
        Action::Suppress if !alarm.suppressed => {
            (Change::Suppressed, None, |alarm, _| alarm.suppressed = true)
        }
        Action::Unsuppress if alarm.suppressed => (Change::Unsuppressed, None, |alarm, _| {
            alarm.suppressed = false
        }),
        _ => return None,
    };
    Some(alarm.step(change, who, why, now_ms, |alarm| work(alarm, until)))
}

/// A map whose keys are no text, as a list.
mod listed {
    use super::{AlarmCause, BTreeMap, MotorId, Pending};
    use serde::{Deserialize, Deserializer, Serializer};

    type Map = BTreeMap<(MotorId, AlarmCause), Pending>;

    pub fn serialize<S: Serializer>(map: &Map, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(map.values())
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Map, D::Error> {
        let list = Vec::<Pending>::deserialize(deserializer)?;
        Ok(list
            .into_iter()
            .map(|p| ((p.motor.clone(), p.cause), p))
            .collect())
    }
}
