//! Why a question about people fails.

use std::path::PathBuf;

use thiserror::Error;

/// Why a question about people fails.
#[derive(Debug, Error)]
pub enum PeopleError {
    /// The file cannot be opened.
    #[error("{}: {reason}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What SQLite says.
        reason: rusqlite::Error,
    },
    /// The file is a database of something else.
    #[error("{}: a database of another program", .0.display())]
    Foreign(PathBuf),
    /// A name that cannot be told from others in the audit trail.
    #[error(
        "{0:?} is not a user's name: write 1 to 60 letters, digits, spaces or . _ - @, and no space at an end"
    )]
    Name(String),
    /// The name is taken.
    #[error("there is a user {0:?} already: remove that one first, or choose another name")]
    Taken(String),
    /// The name is not known.
    #[error("there is no user {0:?}")]
    Unknown(String),
    /// The system gives no random numbers for a token.
    #[error("no token can be made: {0}")]
    Random(getrandom::Error),
    /// Reading or writing failed.
    #[error("people of the plant: {0}")]
    Sqlite(#[from] rusqlite::Error),
    /// What is stored cannot be read.
    #[error("people of the plant: {0}")]
    Text(#[from] serde_json::Error),
}
