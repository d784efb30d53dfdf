//! Reading a store beside the program that writes it.

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use rusqlite::{Connection, OptionalExtension, params};

use super::recordings::{self, Samples};
use super::{StoreError, Trend, alarms, history, lock, read, schema};
use crate::alarm::change::{Alarm, AlarmFilter};
use crate::entry::Numbered;
use crate::motor::MotorId;
use crate::state::MotorState;

/// Readers that are kept open between two questions.
const KEPT: usize = 4;

/// A store that another program writes, or nobody: any number of readers, in any number of programs.
pub struct Reader {
    path: PathBuf,
    free: Mutex<Vec<Connection>>,
    /// The one that notices changes.
    noticing: Mutex<Connection>,
}

/// Which entries are asked for; what is `None` does not restrict.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EntryFilter {
    /// Of this motor.
    pub motor: Option<MotorId>,
    /// Before this id: the next page behind the last entry of a page.
    pub before: Option<u64>,
    /// Changes of alarms, too; they are most entries of a busy plant.
    pub alarms: bool,
}

impl Reader {
    /// Opens a store for reading.
    ///
    /// # Errors
    /// There is no such file, it is no store, or a newer program wrote it.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        let noticing = schema::open_reader(path)?;
        schema::check(&noticing, path)?;
        Ok(Self {
            path: path.to_owned(),
            free: Mutex::default(),
            noticing: Mutex::new(noticing),
        })
    }

    /// Its file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A number that differs from that of the last call when somebody wrote in between.
    ///
    /// # Errors
    /// Reading failed.
    pub fn version(&self) -> Result<i64, StoreError> {
        let version = lock(&self.noticing).pragma_query_value(None, "data_version", |r| r.get(0));
        Ok(version?)
    }

    /// As [`super::Store::motors`].
    ///
    /// # Errors
    /// Reading failed.
    pub fn motors(&self) -> Result<Vec<MotorState>, StoreError> {
        self.reading(read::motors)
    }

    /// As [`super::Store::alarms`].
    ///
    /// # Errors
    /// Reading failed.
    pub fn alarms(&self, filter: &AlarmFilter) -> Result<Vec<Alarm>, StoreError> {
        self.reading(|connection| alarms::get(connection, filter))
    }

    /// Alarms that are not normal, all of them.
    ///
    /// # Errors
    /// Reading failed.
    pub fn alarms_not_normal(&self) -> Result<Vec<Alarm>, StoreError> {
        self.reading(alarms::not_normal)
    }

    /// As [`super::Store::recording`].
    ///
    /// # Errors
    /// Reading failed.
    pub fn recording(&self, name: &str) -> Result<Option<Samples>, StoreError> {
        self.reading(|connection| recordings::get(connection, name))
    }

    /// An alarm by its number, as it is now; `None`: there is none, or it is long over.
    ///
    /// # Errors
    /// Reading failed.
    pub fn alarm(&self, number: u64) -> Result<Option<Alarm>, StoreError> {
        self.reading(|connection| alarms::one(connection, number))
    }

    /// When the oldest second that the history still tells of a motor was, Unix ms; `None`: it has none.
    ///
    /// # Errors
    /// There is no such motor, or reading failed.
    pub fn first_ms(&self, motor: &MotorId) -> Result<Option<i64>, StoreError> {
        self.reading(|connection| history::first_ms(connection, key_of(connection, motor)?))
    }

    /// As [`super::Store::trend`].
    ///
    /// # Errors
    /// There is no such motor, or reading failed.
    pub fn trend(
        &self,
        motor: &MotorId,
        from_ms: i64,
        to_ms: i64,
        points: usize,
    ) -> Result<Trend, StoreError> {
        self.reading(|connection| {
            let key = key_of(connection, motor)?;
            history::trend(connection, key, from_ms, to_ms, points)
        })
    }

    /// Entries apart from seconds, the newest first, at most `limit`.
    ///
    /// # Errors
    /// Reading failed.
    pub fn entries(&self, filter: &EntryFilter, limit: usize) -> Result<Vec<Numbered>, StoreError> {
        self.reading(|connection| {
            let of_motor = match filter.motor {
                Some(_) => "entry.motor = (SELECT key FROM motor WHERE id = ?1)",
                None => "?1 IS NULL",
            };
            let text = format!(
                "SELECT entry.id, motor.id, body FROM entry LEFT JOIN motor ON motor.key = entry.motor
                 WHERE {of_motor} AND entry.id < ?2 AND (?3 OR kind <> 'alarm') ORDER BY entry.id DESC LIMIT ?4"
            );
            let mut statement = connection.prepare_cached(&text)?;
            let before = filter.before.map_or(i64::MAX, |id| id as i64);
            let motor = filter.motor.as_ref().map(MotorId::as_str);
            let mut rows = statement.query(params![motor, before, filter.alarms, limit as i64])?;
            let mut found = Vec::new();
            while let Some(row) = rows.next()? {
                found.push(read::numbered(row)?);
            }
            Ok(found)
        })
    }

    /// Lends a connection.
    pub(super) fn reading<T>(
        &self,
        work: impl FnOnce(&Connection) -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        let free = lock(&self.free).pop();
        let connection = match free {
            Some(connection) => connection,
            None => schema::open_reader(&self.path)?,
        };
        let done = work(&connection);
        let mut free = lock(&self.free);
        if free.len() < KEPT {
            free.push(connection);
        }
        done
    }
}

/// The store's own number of a motor.
fn key_of(connection: &Connection, motor: &MotorId) -> Result<i64, StoreError> {
    let text = "SELECT key FROM motor WHERE id = ?1";
    let mut statement = connection.prepare_cached(text)?;
    let key = statement
        .query_row([motor.as_str()], |row| row.get(0))
        .optional()?;
    key.ok_or_else(|| StoreError::UnknownMotor(motor.clone()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Entry, Limits, Link, MotorInfo, Second, Store};

    fn motor(name: &str) -> MotorId {
        name.parse().expect("a name")
    }

    #[test]
    fn a_reader_sees_what_another_connection_writes_and_notices_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("plant.db");
        assert!(Reader::open(&path).is_err(), "there is no store yet");
        let store = Store::open(&path, &Limits::default()).expect("a store");
        store
            .declare(&["a", "b"].map(|name| MotorInfo::new(motor(name))))
            .expect("declared");
        let reader = Reader::open(&path).expect("a reader");
        let before = reader.version().expect("a version");
        assert_eq!(before, reader.version().expect("a version"));
        let link = |up| {
            Entry::Link(Link {
                up,
                time_ms: 5,
                why: String::new(),
            })
        };
        let second = Second {
            start: 1,
            number: 1,
            time_ms: 1_000,
            ..Second::default()
        };
        let batch = [
            (motor("a"), link(true)),
            (motor("b"), link(true)),
            (motor("a"), Entry::Second(second)),
            (motor("a"), link(false)),
        ];
        store.append(&batch).expect("stored");
        assert_ne!(before, reader.version().expect("a version"));
        let filter = EntryFilter {
            motor: Some(motor("a")),
            ..EntryFilter::default()
        };
        let [down, up] = &reader.entries(&filter, 10).expect("read")[..] else {
            panic!("two links of a");
        };
        assert_eq!((&down.entry, &up.entry), (&link(false), &link(true)));
        let next = EntryFilter {
            before: Some(down.id),
            ..filter
        };
        assert_eq!(reader.entries(&next, 10).expect("read").len(), 1);
        let all = reader.entries(&EntryFilter::default(), 2).expect("read");
        assert_eq!(all.len(), 2);
        assert_eq!(
            reader.motors().expect("read")[0]
                .last
                .as_ref()
                .map(|s| s.number),
            Some(1)
        );
        assert_eq!(
            reader
                .trend(&motor("a"), 0, 2_000, 2)
                .expect("read")
                .points
                .len(),
            1
        );
        let firsts = ["a", "b"].map(|name| reader.first_ms(&motor(name)).expect("read"));
        assert_eq!(firsts, [Some(1_000), None]);
        let unknown = reader.trend(&motor("c"), 0, 2_000, 2);
        assert!(matches!(unknown, Err(StoreError::UnknownMotor(_))));
    }

    #[test]
    fn a_database_of_another_program_is_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("other.db");
        let other = Connection::open(&path).expect("a database");
        other.execute_batch("CREATE TABLE a(b)").expect("a table");
        assert!(matches!(Reader::open(&path), Err(StoreError::Foreign(_))));
    }
}
