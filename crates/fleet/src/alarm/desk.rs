//! The life cycle of all alarms of a plant, without clock, file or network.

use std::collections::BTreeMap;

use super::action::{Action, ActionError, apply};
use super::change::{Alarm, AlarmCause, AlarmChange, AlarmState, Change, Evidence, Severity, Who};
use super::life::{overruled, raised_again, updated, with_event};
use super::memory::{Memory, Pending};
use super::read::{Details, Told, conditions};
use super::rules::Rules;
use crate::entry::{Entry, Recording, RecordingKey};
use crate::motor::MotorId;

/// What an alarm is of: `None` is the plant.
type Key = (Option<MotorId>, AlarmCause);

/// How far the times of an alarm and of its recording may be apart, ms: an event is known to the second, and so is a recording.
const RECORDING_MS: i64 = 3_000;
/// The same where both name a second of the board.
const RECORDING_S: u32 = 2;

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
        let mut changes = Vec::new();
        if let Entry::Recording(recording) = entry {
            changes.extend(self.recorded(motor, recording));
        }
        let told = conditions(entry);
        told.into_iter()
            .for_each(|told| self.observe(motor, told, time_ms, &mut changes));
        changes
    }

    /// A recording belongs to the alarm that it names, else to the motor's fault or else sensor that rose at its time.
    fn recorded(&mut self, motor: &MotorId, recording: &Recording) -> Option<AlarmChange> {
        let causes = [AlarmCause::Fault, AlarmCause::Sensor];
        let named = recording.alarm.and_then(|number| {
            let mut alarms = self.alarms.iter();
            alarms
                .find(|(_, alarm)| alarm.number == number)
                .map(|(key, _)| key.clone())
        });
        let own = || {
            let keys = causes.into_iter().map(|cause| (Some(motor.clone()), cause));
            keys.into_iter().find(|key| {
                let alarm = self.alarms.get(key);
                alarm.is_some_and(|alarm| self.rose_with(alarm, recording))
            })
        };
        let key = if recording.alarm.is_some() {
            named
        } else {
            own()
        }?;
        let alarm = self.alarms.get_mut(&key)?;
        if recording.missing.is_some() && alarm.evidence.recording.is_some() {
            return None;
        }
        let why = match &recording.missing {
            Some(why) => format!("no recording: {why}"),
            None => format!("recording {} was fetched", recording.file),
        };
        Some(alarm.step(
            Change::Updated,
            Who::Gateway,
            &why,
            recording.time_ms,
            |alarm| {
                let file = recording.missing.is_none().then(|| recording.file.clone());
                alarm.evidence.recording = file;
                alarm.evidence.no_recording.clone_from(&recording.missing);
            },
        ))
    }

    /// Whether an alarm rose when a recording was taken, as far as seconds and delays tell.
    fn rose_with(&self, alarm: &Alarm, recording: &Recording) -> bool {
        let (shown, taken) = (alarm.evidence.second, recording.key);
        if let (Some((run, second)), RecordingKey::Second { start, second: at }) = (shown, taken)
            && run == start
            && second.abs_diff(at) <= RECORDING_S
        {
            return true;
        }
        let latest_ms = recording.to_ms + self.rules.on_delay_ms + RECORDING_MS;
        (recording.from_ms - RECORDING_MS..=latest_ms).contains(&alarm.raised_ms)
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
