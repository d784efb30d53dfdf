//! What the tests across crates share.

use std::path::PathBuf;

/// A file of the project.
pub fn in_project(path: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join(path)
}
