//! The people of a plant: who may do what, what they asked for, and the audit trail.
//!
//! It is a file of its own beside the store, because the store has one writer, the gateway. A page that takes an action of a person
//! writes it here; the gateway does it and writes down how it ended. So an action outlives a crash of either.

mod error;
mod role;
mod trail;
mod users;

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use rusqlite::{Connection, ErrorCode, TransactionBehavior};

pub use error::PeopleError;
pub use role::{Role, User};
pub use trail::{Asked, Outcome, Trail};

/// `PRAGMA application_id`: "dmPE".
const APPLICATION: i32 = 0x646d_5045;
/// How long a lock of another program is waited for.
const PATIENCE: Duration = Duration::from_secs(10);

/// Pause before a lock that SQLite does not wait for is asked for again.
const AGAIN: Duration = Duration::from_millis(20);

/// Users, what they asked for, and the audit trail of one plant. Several programs may have it open.
pub struct People {
    connection: Mutex<Connection>,
}

impl People {
    /// Where the people of a store are kept: the store's path with `.people` behind it.
    pub fn path_of(store: &Path) -> PathBuf {
        let mut path = store.as_os_str().to_owned();
        path.push(".people");
        path.into()
    }

    /// Opens the file that belongs to a store, or makes a new one without users.
    ///
    /// # Errors
    /// The file cannot be opened, or is a database of something else.
    pub fn open(store: &Path) -> Result<Self, PeopleError> {
        let path = Self::path_of(store);
        let failed = |reason| PeopleError::Open {
            path: path.clone(),
            reason,
        };
        let mut connection = Connection::open(&path).map_err(failed)?;
        connection.busy_timeout(PATIENCE).map_err(failed)?;
        write_ahead(&connection).map_err(failed)?;
        prepare(&mut connection, &path)?;
        Ok(Self {
            connection: Mutex::new(connection),
        })
    }

    /// A lock whose holder panicked is as good as any: every change is one statement.
    fn lock(&self) -> MutexGuard<'_, Connection> {
        self.connection
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }
}

/// Of two programs that make the file at the same time SQLite refuses one at once instead of letting it wait.
fn write_ahead(connection: &Connection) -> rusqlite::Result<()> {
    let end = Instant::now() + PATIENCE;
    loop {
        let done =
            connection.execute_batch("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;");
        let code = done
            .as_ref()
            .err()
            .and_then(rusqlite::Error::sqlite_error_code);
        match code {
            Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) if Instant::now() < end => {
                std::thread::sleep(AGAIN);
            }
            _ => return done,
        }
    }
}

fn prepare(connection: &mut Connection, path: &Path) -> Result<(), PeopleError> {
    let tx = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    let tables: u32 = tx.query_row("SELECT count(*) FROM sqlite_schema", [], |row| row.get(0))?;
    let application: i32 = tx.pragma_query_value(None, "application_id", |row| row.get(0))?;
    match (tables, application) {
        (0, _) => {
            tx.execute_batch(include_str!("schema.sql"))?;
            tx.pragma_update(None, "application_id", APPLICATION)?;
        }
        (_, APPLICATION) => {}
        _ => return Err(PeopleError::Foreign(path.to_owned())),
    }
    tx.commit()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_makes_the_file_at_the_same_time_is_waited_for() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = folder.path().join("plant.db");
        let other = Connection::open(People::path_of(&store)).expect("a new file");
        other.execute_batch("BEGIN IMMEDIATE").expect("a lock");
        let opened = std::thread::scope(|scope| {
            let opened = scope.spawn(|| People::open(&store).map(|_| ()));
            std::thread::sleep(10 * AGAIN);
            other.execute_batch("COMMIT").expect("nothing was written");
            opened.join().expect("no panic")
        });
        assert!(opened.is_ok(), "{opened:?}");
    }
}
