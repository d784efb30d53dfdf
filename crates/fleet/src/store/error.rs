//! Why the store refuses.

use std::path::PathBuf;

use thiserror::Error;

use crate::motor::MotorId;

/// Why the store refuses.
#[derive(Debug, Error)]
pub enum StoreError {
    /// The file cannot be opened, or is none of SQLite.
    #[error("{}: {reason}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What SQLite says.
        reason: rusqlite::Error,
    },
    /// The file was written by a newer program.
    #[error(
        "{}: the store has schema {found}, this program knows {known}: use the newer program, or another file",
        path.display()
    )]
    Newer {
        /// The file.
        path: PathBuf,
        /// Schema of the file.
        found: u32,
        /// Newest schema this program knows.
        known: u32,
    },
    /// The file is a database of something else.
    #[error("{}: a database of another program; give the store a file of its own", .0.display())]
    Foreign(PathBuf),
    /// Another program keeps the store.
    #[error(
        "{}: another gateway keeps this store and goes on: end it first, or give this one a store of its own ([store] path)",
        .0.display()
    )]
    Claimed(PathBuf),
    /// Another program opened the store for writing after this one.
    #[error("another program writes to this store since: end one of the two")]
    OtherWriter,
    /// A motor that was never declared.
    #[error("motor {0} is not declared: it is not in the gateway's configuration")]
    UnknownMotor(MotorId),
    /// A limit outside its range.
    #[error("{key} = {value}: {range}")]
    Limit {
        /// Name of the limit.
        key: &'static str,
        /// Its value.
        value: u64,
        /// What it may be.
        range: &'static str,
    },
    /// A name that no user may have.
    #[error("{0:?} is no user's name: use 1 to 64 characters, no control characters")]
    UserName(String),
    /// No random numbers for a token.
    #[error("no random numbers for a token: {0}")]
    Random(String),
    /// A file for other programs cannot be written.
    #[error("{}: {reason}", path.display())]
    Export {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// What is stored cannot be read.
    #[error("entry {id} of the store cannot be read: {reason}")]
    Damaged {
        /// Its id.
        id: u64,
        /// Why.
        reason: String,
    },
    /// Reading or writing failed: disk full, damaged file.
    #[error("store: {0}")]
    Sqlite(#[from] rusqlite::Error),
    /// An entry cannot be written as text.
    #[error("store: {0}")]
    Text(#[from] serde_json::Error),
}
