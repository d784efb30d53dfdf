//! The desk at work: it reads the store like an output, and keeps there what it answers.

use std::sync::{Mutex, PoisonError};

use thiserror::Error;

use super::action::{Action, ActionError};
use super::change::{Alarm, AlarmChange};
use super::desk::Desk;
use super::memory::Memory;
use super::rules::Rules;
use crate::entry::Numbered;
use crate::store::{Store, StoreError};

/// Entries that are read at once.
const AT_ONCE: usize = 10_000;

/// Time after which the place is stored although nothing changed, ms: a restart need not read far, the queue need not wait.
const PLACE_AFTER_MS: i64 = 20_000;

/// Why alarms could not be worked on.
#[derive(Debug, Error)]
pub enum WatchError {
    /// The store failed; what was not stored is done again.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A person asked for what cannot be.
    #[error(transparent)]
    Action(#[from] ActionError),
}

/// The alarms of a plant, fed from its store.
///
/// Changes, the place in the store up to which they were found, and running delays are stored in one transaction: after a
/// crash the entries behind that place are read again and give the same.
pub struct Watch {
    rules: Rules,
    /// `None`: to be read from the store.
    at_work: Mutex<Option<AtWork>>,
}

/// A desk and how far it has read.
struct AtWork {
    desk: Desk,
    cursor: u64,
    stored: u64,
    stored_ms: i64,
}

impl Watch {
    /// Alarms by these rules.
    pub fn new(rules: Rules) -> Self {
        Self {
            rules,
            at_work: Mutex::new(None),
        }
    }

    /// Takes every entry that is new, then lets delays, shelves and floods end; what changed, in order. Call it after each
    /// batch, and every second.
    ///
    /// # Errors
    /// The store failed. Nothing is lost: the next call begins where the store is.
    pub fn work(&self, store: &Store, now_ms: i64) -> Result<Vec<AlarmChange>, WatchError> {
        let done = self.with(store, |at_work| {
            let mut changes = Vec::new();
            while at_work.read(store, &mut changes)? {}
            let ended = at_work.desk.tick(now_ms);
            if !ended.is_empty() || at_work.is_far(now_ms) {
                at_work.keep(store, &ended)?;
                at_work.stored_ms = now_ms;
            }
            changes.extend(ended);
            Ok(changes)
        });
        Ok(done?)
    }

    /// A person acts on an alarm; on return it is on the disk.
    ///
    /// # Errors
    /// The action is refused, or the store failed.
    pub fn act(
        &self,
        store: &Store,
        number: u64,
        action: &Action,
        user: &str,
        why: &str,
        now_ms: i64,
    ) -> Result<Vec<AlarmChange>, WatchError> {
        self.with(store, |at_work| {
            let changes = match at_work.desk.act(number, action, user, why, now_ms) {
                Ok(changes) => changes,
                Err(refused) => return Ok(Err(refused)),
            };
            if !changes.is_empty() {
                at_work.keep(store, &changes)?;
            }
            Ok(Ok(changes))
        })?
        .map_err(WatchError::Action)
    }

    /// Alarms that are not normal.
    ///
    /// # Errors
    /// The store failed.
    pub fn alarms(&self, store: &Store) -> Result<Vec<Alarm>, WatchError> {
        Ok(self.with(store, |at_work| {
            Ok(at_work.desk.alarms().cloned().collect())
        })?)
    }

    /// Runs work on the desk. Where it fails the desk is read from the store again: what was not stored did not happen.
    fn with<T>(
        &self,
        store: &Store,
        work: impl FnOnce(&mut AtWork) -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        let mut held = self.at_work.lock().unwrap_or_else(PoisonError::into_inner);
        let mut at_work = match held.take() {
            Some(at_work) => at_work,
            None => AtWork::open(store, &self.rules)?,
        };
        let done = work(&mut at_work)?;
        *held = Some(at_work);
        Ok(done)
    }
}

impl AtWork {
    fn open(store: &Store, rules: &Rules) -> Result<Self, StoreError> {
        let (cursor, memory) = store.alarm_place()?;
        let memory: Memory = match memory.as_str() {
            "" => Memory::default(),
            text => serde_json::from_str(text)?,
        };
        let desk = Desk::new(rules.clone(), store.alarms_not_normal()?, memory);
        Ok(Self {
            desk,
            cursor,
            stored: cursor,
            stored_ms: 0,
        })
    }

    /// Whether the place in the store is long ago.
    fn is_far(&self, now_ms: i64) -> bool {
        self.cursor > self.stored && now_ms - self.stored_ms >= PLACE_AFTER_MS
    }

    /// Takes some entries. `false`: there were none.
    fn read(&mut self, store: &Store, changes: &mut Vec<AlarmChange>) -> Result<bool, StoreError> {
        let entries = store.since(self.cursor, AT_ONCE)?;
        let Some(last) = entries.last().map(|entry| entry.id) else {
            return Ok(false);
        };
        let mut new = Vec::new();
        for Numbered { motor, entry, .. } in &entries {
            if let Some(motor) = motor {
                new.extend(self.desk.take(motor, entry));
            }
        }
        self.cursor = last;
        if !new.is_empty() {
            self.keep(store, &new)?;
        }
        changes.extend(new);
        Ok(true)
    }

    fn keep(&mut self, store: &Store, changes: &[AlarmChange]) -> Result<(), StoreError> {
        let memory = serde_json::to_string(self.desk.memory())?;
        store.keep_alarms(changes, self.cursor, &memory)?;
        self.stored = self.cursor;
        Ok(())
    }
}
