//! Tables of the store, and how an older file becomes a newer one.

use std::path::Path;
use std::time::{Duration, Instant};

use rusqlite::{Connection, OpenFlags, TransactionBehavior};

use super::StoreError;

/// `PRAGMA application_id` of a store: "dmFL".
const APPLICATION: i32 = 0x646d_464c;

/// What leads from schema k to schema k + 1, in order. A published step never changes.
const STEPS: [&str; 3] = [
    include_str!("schema_1.sql"),
    include_str!("schema_2.sql"),
    include_str!("schema_3.sql"),
];

/// Newest schema this program knows.
const NEWEST: u32 = STEPS.len() as u32;

/// Time between two looks at an empty file.
const AGAIN: Duration = Duration::from_millis(20);
/// How long a reader or the writer waits for a lock of another program.
const PATIENCE: Duration = Duration::from_secs(10);

/// Opens for writing, and brings the schema up to date.
pub(super) fn open_writer(path: &Path) -> Result<Connection, StoreError> {
    let failed = |reason| StoreError::Open {
        path: path.to_owned(),
        reason,
    };
    let mut connection = Connection::open(path).map_err(failed)?;
    connection.busy_timeout(PATIENCE).map_err(failed)?;
    // Every commit is on the disk before it is acknowledged.
    let pragmas = "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;
        PRAGMA wal_autocheckpoint = 4000; PRAGMA journal_size_limit = 64000000; PRAGMA cache_size = -65536;
        PRAGMA temp_store = MEMORY;";
    connection.execute_batch(pragmas).map_err(failed)?;
    migrate(&mut connection, path)?;
    connection.set_prepared_statement_cache_capacity(64);
    Ok(connection)
}

/// Opens for reading, beside the writer.
pub(super) fn open_reader(path: &Path) -> Result<Connection, StoreError> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let failed = |reason| StoreError::Open {
        path: path.to_owned(),
        reason,
    };
    let connection = Connection::open_with_flags(path, flags).map_err(failed)?;
    connection.busy_timeout(PATIENCE).map_err(failed)?;
    connection.set_prepared_statement_cache_capacity(32);
    Ok(connection)
}

fn migrate(connection: &mut Connection, path: &Path) -> Result<(), StoreError> {
    let tx = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    let found = schema_of(&tx, path)?;
    for (k, step) in STEPS.iter().enumerate().skip(found as usize) {
        tx.execute_batch(step)?;
        let now =
            "INSERT INTO migration(schema, applied) VALUES (?1, strftime('%Y-%m-%dT%H:%M:%SZ'))";
        tx.execute(now, [k as u32 + 1])?;
    }
    tx.pragma_update(None, "application_id", APPLICATION)?;
    tx.commit()?;
    Ok(())
}

/// Refuses a file that is no store, or not one of this program's. An empty one may be about to become a store: it is waited for.
pub(super) fn check(connection: &Connection, path: &Path) -> Result<(), StoreError> {
    let end = Instant::now() + PATIENCE;
    while schema_of(connection, path)? == 0 {
        if Instant::now() > end {
            return Err(StoreError::Foreign(path.to_owned()));
        }
        std::thread::sleep(AGAIN);
    }
    Ok(())
}

/// Schema of the file, 0 of an empty one.
fn schema_of(tx: &Connection, path: &Path) -> Result<u32, StoreError> {
    let tables: u32 = tx.query_row("SELECT count(*) FROM sqlite_schema", [], |row| row.get(0))?;
    if tables == 0 {
        return Ok(0);
    }
    let application: i32 = tx.pragma_query_value(None, "application_id", |row| row.get(0))?;
    if application != APPLICATION {
        return Err(StoreError::Foreign(path.to_owned()));
    }
    let found = tx.query_row("SELECT max(schema) FROM migration", [], |row| row.get(0))?;
    if found > NEWEST {
        let path = path.to_owned();
        return Err(StoreError::Newer {
            path,
            found,
            known: NEWEST,
        });
    }
    Ok(found)
}
