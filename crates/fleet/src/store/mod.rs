//! The durable store of a plant: one file of SQLite.
//!
//! One writer (this process), any number of readers beside it, in other programs too.

mod alarms;
mod append;
mod error;
mod history;
mod limits;
mod marks;
mod parquet;
mod read;
mod reader;
mod recordings;
mod schema;
mod seconds;

use std::collections::HashMap;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use rusqlite::{Connection, OptionalExtension, Row, Transaction, TransactionBehavior, params};

pub use append::Appended;
pub use error::StoreError;
pub use history::{Trend, TrendPoint, Values};
pub use limits::Limits;
pub use reader::{EntryFilter, Reader};
pub use recordings::{AlarmRecording, NoRecording, Samples};

use crate::alarm::change::{Alarm, AlarmChange, AlarmFilter};
use crate::entry::{Entry, Numbered};
use crate::motor::{MotorId, MotorInfo};
use crate::state::MotorState;
use append::Batch;
use marks::Marks;

/// The store of a plant.
pub struct Store {
    limits: Limits,
    writer: Mutex<Writer>,
    reader: Reader,
}

/// The one connection that writes, and what it knows without asking.
struct Writer {
    connection: Connection,
    marks: HashMap<MotorId, Marks>,
    next: u64,
    token: i64,
}

/// A lock whose holder panicked is as good as any: every change is a transaction.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A motor's name in column `at`.
fn id_of(row: &Row<'_>, at: usize) -> rusqlite::Result<MotorId> {
    let text: String = row.get(at)?;
    text.parse().map_err(|e| {
        rusqlite::Error::FromSqlConversionFailure(at, rusqlite::types::Type::Text, Box::new(e))
    })
}

impl Writer {
    fn open(path: &Path) -> Result<Self, StoreError> {
        let mut connection = schema::open_writer(path)?;
        let now = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .unwrap_or_default();
        // Two programs do not open the same file within the same nanosecond and process number.
        let token = (now.as_nanos() as i64) ^ (i64::from(std::process::id()) << 40);
        let tx = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
        tx.execute(
            "INSERT OR REPLACE INTO meta(key, value) VALUES ('writer', ?1)",
            [token],
        )?;
        let next = "SELECT max(coalesce((SELECT max(id) FROM queue), 0), coalesce((SELECT max(id) FROM entry), 0),
             coalesce((SELECT value FROM meta WHERE key = 'last'), 0)) + 1";
        let next = tx.query_row(next, [], |row| row.get::<_, i64>(0))? as u64;
        tx.commit()?;
        let marks = marks::read(&connection)?;
        Ok(Self {
            connection,
            marks,
            next,
            token,
        })
    }

    /// Runs a change in one transaction, if this is still the only writer.
    fn change<T>(
        &mut self,
        work: impl FnOnce(&Transaction<'_>, &HashMap<MotorId, Marks>, u64) -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        let tx = self
            .connection
            .transaction_with_behavior(TransactionBehavior::Immediate)?;
        let writer = "SELECT value FROM meta WHERE key = 'writer'";
        if tx
            .prepare_cached(writer)?
            .query_row([], |row| row.get::<_, i64>(0))?
            != self.token
        {
            return Err(StoreError::OtherWriter);
        }
        let done = work(&tx, &self.marks, self.next)?;
        tx.commit()?;
        Ok(done)
    }

    fn append<'e>(
        &mut self,
        entries: impl Iterator<Item = (Option<&'e MotorId>, &'e Entry)>,
        also: impl FnOnce(&Transaction<'_>) -> Result<(), StoreError>,
    ) -> Result<Appended, StoreError> {
        let (next, moved, done) = self.change(|tx, marks, next| {
            let mut batch = Batch::new(tx, marks, next)?;
            for (motor, entry) in entries {
                batch.take(motor, entry)?;
            }
            let done = batch.finish()?;
            also(tx)?;
            Ok(done)
        })?;
        // What failed before this left neither the file nor this memory changed.
        self.next = next;
        self.marks.extend(moved);
        Ok(done)
    }
}

impl Store {
    /// Its file.
    pub fn path(&self) -> &Path {
        self.reader.path()
    }

    /// Opens a store, or makes a new one. From now on other programs may only read it: the last that opens is the writer.
    ///
    /// # Errors
    /// The file cannot be opened, is no store, or was written by a newer program; a limit is out of its range.
    pub fn open(path: &Path, limits: &Limits) -> Result<Self, StoreError> {
        limits.check()?;
        let writer = Mutex::new(Writer::open(path)?);
        Ok(Self {
            limits: limits.clone(),
            writer,
            reader: Reader::open(path)?,
        })
    }

    /// The limits it was opened with.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Makes motors known. Motors of before that are not among them keep their history and leave [`Store::motors`].
    ///
    /// # Errors
    /// Writing failed.
    pub fn declare(&self, motors: &[MotorInfo]) -> Result<(), StoreError> {
        let mut writer = lock(&self.writer);
        writer.change(|tx, _, _| {
            tx.execute("UPDATE motor SET in_force = 0", [])?;
            motors.iter().try_for_each(|motor| declare(tx, motor))
        })?;
        writer.marks = marks::read(&writer.connection)?;
        Ok(())
    }

    /// Stores a batch in one transaction; on return it is on the disk. What was stored before is recognised by its number, what
    /// is missing between two numbers is stored as a gap.
    ///
    /// # Errors
    /// A motor is not declared, or writing failed: nothing of the batch is stored then.
    pub fn append(&self, entries: &[(MotorId, Entry)]) -> Result<Appended, StoreError> {
        let entries = entries.iter().map(|(motor, entry)| (Some(motor), entry));
        lock(&self.writer).append(entries, |_| Ok(()))
    }

    /// Entries after `cursor`, in order, at most `limit`. Start with 0; go on with the last id.
    ///
    /// # Errors
    /// Reading failed.
    pub fn since(&self, cursor: u64, limit: usize) -> Result<Vec<Numbered>, StoreError> {
        self.reading(|connection| read::since(connection, cursor, limit))
    }

    /// How far an output has delivered; 0: it is new.
    ///
    /// # Errors
    /// Reading failed.
    pub fn cursor(&self, sink: &str) -> Result<u64, StoreError> {
        self.reading(|connection| {
            let text = "SELECT cursor FROM sink WHERE name = ?1";
            let found = connection
                .query_row(text, [sink], |row| row.get::<_, i64>(0))
                .optional()?;
            Ok(found.unwrap_or(0) as u64)
        })
    }

    /// An output has delivered up to `id`. A cursor never goes back.
    ///
    /// # Errors
    /// Writing failed.
    pub fn set_cursor(&self, sink: &str, id: u64) -> Result<(), StoreError> {
        lock(&self.writer).change(|tx, _, _| set_cursor(tx, sink, id))
    }

    /// Names the outputs of the configuration: each new one begins with what is stored from now on, and the queue no longer waits
    /// for others.
    ///
    /// # Errors
    /// Writing failed.
    pub fn declare_sinks(&self, names: &[&str]) -> Result<(), StoreError> {
        lock(&self.writer).change(|tx, _, next| {
            let names_json = serde_json::to_string(names)?;
            let others = "DELETE FROM sink WHERE memory = '' AND name NOT IN (SELECT value FROM json_each(?1))";
            tx.execute(others, [names_json])?;
            for name in names {
                let text = "INSERT OR IGNORE INTO sink(name, cursor) VALUES (?1, ?2)";
                tx.execute(text, params![name, next as i64 - 1])?;
            }
            Ok(())
        })
    }

    /// Newest second of a motor that is durable: start and number. A gateway asks the board for what comes after.
    ///
    /// # Errors
    /// The motor is not declared.
    pub fn last_second(&self, motor: &MotorId) -> Result<Option<(u32, u32)>, StoreError> {
        Ok(self.marks_of(motor)?.second)
    }

    /// Newest event of a motor that is durable; 0: none.
    ///
    /// # Errors
    /// The motor is not declared.
    pub fn last_event(&self, motor: &MotorId) -> Result<u32, StoreError> {
        Ok(self.marks_of(motor)?.event)
    }

    /// Every declared motor with its present state, in the order of names, in one query.
    ///
    /// # Errors
    /// Reading failed.
    pub fn motors(&self) -> Result<Vec<MotorState>, StoreError> {
        self.reader.motors()
    }

    /// Alarms: those that somebody has to look at first, of these the worst first, then the newest.
    ///
    /// # Errors
    /// Reading failed.
    pub fn alarms(&self, filter: &AlarmFilter) -> Result<Vec<Alarm>, StoreError> {
        self.reader.alarms(filter)
    }

    /// A motor's history from `from_ms` to before `to_ms` (Unix ms) in at most `points` points.
    ///
    /// # Errors
    /// The motor is not declared, or reading failed.
    pub fn trend(
        &self,
        motor: &MotorId,
        from_ms: i64,
        to_ms: i64,
        points: usize,
    ) -> Result<Trend, StoreError> {
        self.reader.trend(motor, from_ms, to_ms, points)
    }

    /// Name of the place of the alarms among the outputs.
    const ALARMS: &str = " alarms";

    /// How far alarms were looked for, and the memory that belongs to it.
    pub(crate) fn alarm_place(&self) -> Result<(u64, String), StoreError> {
        self.reading(|connection| {
            let text = "SELECT cursor, memory FROM sink WHERE name = ?1";
            let row = |row: &Row<'_>| Ok((row.get::<_, i64>(0)? as u64, row.get(1)?));
            Ok(connection
                .query_row(text, [Self::ALARMS], row)
                .optional()?
                .unwrap_or_default())
        })
    }

    /// Alarms that are not normal, all of them.
    pub(crate) fn alarms_not_normal(&self) -> Result<Vec<Alarm>, StoreError> {
        self.reader.alarms_not_normal()
    }

    /// Stores changes of alarms, how far they were looked for and the memory that belongs to it, in one transaction.
    pub(crate) fn keep_alarms(
        &self,
        changes: &[AlarmChange],
        cursor: u64,
        memory: &str,
    ) -> Result<(), StoreError> {
        let entries: Vec<_> = changes
            .iter()
            .map(|change| (change.alarm.motor.as_ref(), Entry::Alarm(change.clone())))
            .collect();
        let entries = entries.iter().map(|(motor, entry)| (*motor, entry));
        lock(&self.writer).append(entries, |tx| {
            let text = "INSERT OR REPLACE INTO sink(name, cursor, memory) VALUES (?1, ?2, ?3)";
            tx.execute(text, params![Self::ALARMS, cursor as i64, memory])?;
            Ok(())
        })?;
        Ok(())
    }

    fn marks_of(&self, motor: &MotorId) -> Result<Marks, StoreError> {
        let found = lock(&self.writer).marks.get(motor).copied();
        found.ok_or_else(|| StoreError::UnknownMotor(motor.clone()))
    }

    /// Lends a connection that reads, beside the writer.
    fn reading<T>(
        &self,
        work: impl FnOnce(&Connection) -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        self.reader.reading(work)
    }
}

fn set_cursor(tx: &Transaction<'_>, sink: &str, id: u64) -> Result<(), StoreError> {
    let text = "INSERT INTO sink(name, cursor) VALUES (?1, ?2)
         ON CONFLICT(name) DO UPDATE SET cursor = max(cursor, excluded.cursor)";
    tx.prepare_cached(text)?.execute(params![sink, id as i64])?;
    Ok(())
}

fn declare(tx: &Transaction<'_>, motor: &MotorInfo) -> Result<(), StoreError> {
    let text = "INSERT INTO motor(id, title, nameplate, place, link, motor_file) VALUES (?1, ?2, ?3, ?4, ?5, ?6)
         ON CONFLICT(id) DO UPDATE SET title = ?2, nameplate = ?3, place = ?4, link = ?5, motor_file = ?6, in_force = 1";
    let MotorInfo {
        id,
        title,
        nameplate,
        place,
        link,
        motor_file,
    } = motor;
    tx.prepare_cached(text)?.execute(params![
        id.as_str(),
        title,
        nameplate,
        place,
        link,
        motor_file
    ])?;
    let text = "INSERT OR IGNORE INTO state(motor) SELECT key FROM motor WHERE id = ?1";
    tx.prepare_cached(text)?.execute([id.as_str()])?;
    Ok(())
}
