//! The one program that keeps a plant's store.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rusqlite::{Connection, ErrorCode};

use crate::store::StoreError;

/// How long a program that is just ending may take to let go.
const PATIENCE: Duration = Duration::from_secs(2);

/// Held while a program keeps a store: nobody else can claim it. The system lets go of it when the program ends, however it ends.
///
/// It is an exclusive lock of SQLite on a file of its own beside the store, so that readers of the store are not disturbed. Within a
/// program the last that opens a [`crate::Store`] writes: what an ended gateway still has at work must not keep its successor out.
#[derive(Debug)]
pub struct Claim {
    _held: Connection,
}

impl Claim {
    /// Claims a store, which need not be there yet.
    ///
    /// # Errors
    /// [`StoreError::Claimed`] where another program keeps it; the file beside the store cannot be made.
    pub fn take(store: &Path) -> Result<Self, StoreError> {
        let path = beside(store);
        let failed = |reason: rusqlite::Error| match reason.sqlite_error_code() {
            Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => {
                StoreError::Claimed(store.to_owned())
            }
            _ => StoreError::Open {
                path: path.clone(),
                reason,
            },
        };
        let held = Connection::open(&path).map_err(failed)?;
        held.busy_timeout(PATIENCE).map_err(failed)?;
        held.execute_batch("BEGIN EXCLUSIVE").map_err(failed)?;
        Ok(Claim { _held: held })
    }
}

fn beside(store: &Path) -> PathBuf {
    let mut name = OsString::from(store.as_os_str());
    name.push(".claim");
    name.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_store_is_claimed_once_until_it_is_let_go() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = folder.path().join("plant.db");
        let first = Claim::take(&store).expect("nobody else");
        let second = Claim::take(&store).expect_err("claimed");
        assert!(matches!(second, StoreError::Claimed(_)), "{second}");
        assert!(second.to_string().contains("plant.db"), "{second}");
        let other = folder.path().join("other.db");
        Claim::take(&other).expect("another store");
        drop(first);
        Claim::take(&store).expect("let go");
    }

    #[test]
    fn a_folder_that_is_not_there_is_told() {
        let nowhere = Path::new("/nowhere/plant.db");
        let error = Claim::take(nowhere).expect_err("no folder");
        assert!(matches!(error, StoreError::Open { .. }), "{error}");
    }
}
