//! Writing: one transaction a batch, nothing twice, no hole untold.

use std::collections::HashMap;

use rusqlite::{CachedStatement, Transaction, params};

use super::marks::{Found, Marks};
use super::{StoreError, alarms, recordings, seconds};
use crate::entry::{BoardEvent, Entry, Gap, GapOf, Link, Recording, Second};
use crate::motor::MotorId;

/// What became of a batch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Appended {
    /// Entries that are new, and durable now.
    pub stored: u64,
    /// Entries that were stored before.
    pub already: u64,
    /// Gaps that nobody had told, and that are stored now.
    pub gaps: u64,
}

/// A batch on its way into the store.
pub(super) struct Batch<'a> {
    tx: &'a Transaction<'a>,
    queue: CachedStatement<'a>,
    entry: CachedStatement<'a>,
    next: u64,
    known: &'a HashMap<MotorId, Marks>,
    /// Marks that this batch moved.
    pub moved: HashMap<MotorId, Marks>,
    newest: HashMap<i64, Second>,
    /// What became of it so far.
    pub done: Appended,
}

impl<'a> Batch<'a> {
    /// An empty batch; its first entry gets the id `next`.
    pub fn new(
        tx: &'a Transaction<'a>,
        known: &'a HashMap<MotorId, Marks>,
        next: u64,
    ) -> Result<Self, StoreError> {
        let queue = format!(
            "INSERT INTO queue(id, motor, {}) VALUES (?1,?2,?3,?4,?5,?6,?7,?8,?9,?10,?11,?12,?13,?14,?15,?16,?17,?18)",
            seconds::COLUMNS
        );
        let entry = "INSERT INTO entry(id, motor, kind, time_ms, board, number, body) VALUES (?1,?2,?3,?4,?5,?6,?7)";
        Ok(Self {
            tx,
            queue: tx.prepare_cached(&queue)?,
            entry: tx.prepare_cached(entry)?,
            next,
            known,
            moved: HashMap::new(),
            newest: HashMap::new(),
            done: Appended::default(),
        })
    }

    /// Takes an entry of a motor, or of the plant (`None`).
    pub fn take(&mut self, motor: Option<&MotorId>, entry: &Entry) -> Result<(), StoreError> {
        let mut marks = motor
            .map(|motor| self.marks(motor))
            .transpose()?
            .unwrap_or_default();
        let new = match entry {
            Entry::Second(second) => self.second(&mut marks, second)?,
            Entry::Event(event) => self.event(&mut marks, event)?,
            Entry::Gap(gap) => marks.gap(gap) && self.plain(&marks, entry)?,
            Entry::Board { serial, .. } => {
                self.board(&mut marks, serial)? && self.plain(&marks, entry)?
            }
            Entry::Link(link) => self.link(&marks, link)? && self.plain(&marks, entry)?,
            Entry::Alarm(change) => {
                alarms::put(self.tx, marks.key, &change.alarm)?;
                self.plain(&marks, entry)?
            }
            Entry::Recording(recording) => match motor {
                Some(motor) => self.recording(&marks, motor, recording)?,
                None => self.plain(&marks, entry)?,
            },
            Entry::Thinned(_) => self.plain(&marks, entry)?,
        };
        match new {
            true => self.done.stored += 1,
            false => self.done.already += 1,
        }
        if let Some(motor) = motor {
            self.moved.insert(motor.clone(), marks);
        }
        Ok(())
    }

    /// Writes marks and newest second of each motor; the next free id, the marks that moved, what became of all.
    pub fn finish(self) -> Result<(u64, HashMap<MotorId, Marks>, Appended), StoreError> {
        let text =
            "UPDATE state SET event = ?2, mark_start = ?3, mark_number = ?4 WHERE motor = ?1";
        let mut numbers = self.tx.prepare_cached(text)?;
        for (motor, marks) in &self.moved {
            if self.known.get(motor) != Some(marks) {
                let (start, number) = marks.second.unzip();
                numbers.execute(params![marks.key, marks.event, start, number])?;
            }
        }
        let text = format!(
            "UPDATE state SET ({}) = (?2,?3,?4,?5,?6,?7,?8,?9,?10,?11,?12,?13,?14,?15,?16,?17) WHERE motor = ?1",
            seconds::COLUMNS
        );
        let mut newest = self.tx.prepare_cached(&text)?;
        for (key, second) in &self.newest {
            newest.execute(&seconds::params(&[*key], &seconds::values_of(second))[..])?;
        }
        Ok((self.next, self.moved, self.done))
    }

    fn marks(&self, motor: &MotorId) -> Result<Marks, StoreError> {
        let found = self.moved.get(motor).or_else(|| self.known.get(motor));
        found
            .copied()
            .ok_or_else(|| StoreError::UnknownMotor(motor.clone()))
    }

    fn id(&mut self) -> u64 {
        self.next += 1;
        self.next - 1
    }

    fn second(&mut self, marks: &mut Marks, second: &Second) -> Result<bool, StoreError> {
        match marks.second(second.start, second.number) {
            Found::Already => return Ok(false),
            Found::Next => {}
            Found::After(first) => {
                let what = GapOf::Seconds {
                    start: second.start,
                };
                self.untold(marks, what, first, second.number - 1, second.time_ms)?;
            }
        }
        let keys = [self.id() as i64, marks.key];
        self.queue
            .execute(&seconds::params(&keys, &seconds::values_of(second))[..])?;
        self.newest.insert(marks.key, second.clone());
        Ok(true)
    }

    fn event(&mut self, marks: &mut Marks, event: &BoardEvent) -> Result<bool, StoreError> {
        match marks.event(event.number) {
            Found::Already => return Ok(false),
            Found::Next => {}
            Found::After(first) => {
                self.untold(marks, GapOf::Events, first, event.number - 1, event.time_ms)?;
            }
        }
        self.plain(marks, &Entry::Event(event.clone()))
    }

    /// A hole that nobody told.
    fn untold(
        &mut self,
        marks: &Marks,
        what: GapOf,
        first: u32,
        last: u32,
        time_ms: i64,
    ) -> Result<(), StoreError> {
        self.done.gaps += 1;
        self.plain(
            marks,
            &Entry::Gap(Gap {
                what,
                first,
                last,
                time_ms,
            }),
        )?;
        Ok(())
    }

    fn board(&mut self, marks: &mut Marks, serial: &str) -> Result<bool, StoreError> {
        let known = "SELECT serial FROM state WHERE motor = ?1";
        let before: String = self.tx.query_row(known, [marks.key], |row| row.get(0))?;
        if before == serial {
            return Ok(false);
        }
        // The first serial number that is told belongs to the board that was there all the time.
        if !before.is_empty() {
            marks.new_board();
        }
        let text = "UPDATE state SET serial = ?2, board = ?3 WHERE motor = ?1";
        self.tx
            .execute(text, params![marks.key, serial, marks.board])?;
        Ok(true)
    }

    /// `false` where the link was as it is.
    fn link(&mut self, marks: &Marks, link: &Link) -> Result<bool, StoreError> {
        let text = "UPDATE state SET link_up = ?2, link_ms = ?3, link_why = ?4
             WHERE motor = ?1 AND (link_up IS NOT ?2 OR link_why IS NOT ?4)";
        let changed = self
            .tx
            .execute(text, params![marks.key, link.up, link.time_ms, link.why])?;
        Ok(changed > 0)
    }

    /// `false` where it is stored. Samples that come after all take the place of the reason why there were none.
    fn recording(
        &mut self,
        marks: &Marks,
        motor: &MotorId,
        recording: &Recording,
    ) -> Result<bool, StoreError> {
        let named = Recording {
            file: recording.key.name(motor, marks.board),
            ..recording.clone()
        };
        if !recordings::put(self.tx, marks.key, &named)? {
            return Ok(false);
        }
        self.plain(marks, &Entry::Recording(named))
    }

    /// Writes anything but a second.
    fn plain(&mut self, marks: &Marks, entry: &Entry) -> Result<bool, StoreError> {
        let motor = (marks.key != 0).then_some(marks.key);
        let (kind, number, body) = text_of(entry)?;
        let (id, board) = (self.id(), number.map(|_| marks.board));
        self.entry.execute(params![
            id as i64,
            motor,
            kind,
            entry.time_ms(),
            board,
            number,
            body
        ])?;
        Ok(true)
    }
}

/// Kind, number and body of an entry as the table holds them.
fn text_of(entry: &Entry) -> Result<(&'static str, Option<i64>, String), StoreError> {
    let number = match entry {
        Entry::Event(event) => Some(i64::from(event.number)),
        Entry::Alarm(change) => Some(change.alarm.number as i64),
        _ => None,
    };
    let kind = match entry {
        Entry::Second(_) => "second",
        Entry::Event(_) => "event",
        Entry::Gap(_) => "gap",
        Entry::Link(_) => "link",
        Entry::Alarm(_) => "alarm",
        Entry::Recording(_) => "recording",
        Entry::Board { .. } => "board",
        Entry::Thinned(_) => "thinned",
    };
    Ok((kind, number, serde_json::to_string(entry)?))
}
