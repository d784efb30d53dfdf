//! What can be wrong with a file, and what helps.

use std::path::Path;

/// A file that cannot be used: which one, why, and what helps.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {what}; {remedy}")]
pub struct Error {
    file: String,
    what: String,
    remedy: String,
}

impl Error {
    pub(crate) fn new(file: &Path, what: impl ToString, remedy: impl ToString) -> Self {
        Error {
            file: file.display().to_string(),
            what: what.to_string(),
            remedy: remedy.to_string(),
        }
    }
}

/// Bytes of a file.
pub(crate) fn read(file: &Path, remedy: &str) -> Result<Vec<u8>, Error> {
    let cannot = |error| Error::new(file, format!("cannot be read: {error}"), remedy);
    std::fs::read(file).map_err(cannot)
}
