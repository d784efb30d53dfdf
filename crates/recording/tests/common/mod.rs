//! Where the tests find their files.
#![allow(dead_code)]

use recording::Progress;
use std::path::{Path, PathBuf};

/// Variable that names the folder of recordings which are not part of this repository.
const SHARED: &str = "DRIVE_MONITOR_SHARED_DATA";

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A file of this repository's test data.
pub fn committed(name: &str) -> PathBuf {
    workspace().join("tests/data").join(name)
}

/// A file beside the repository, or `None` with a message when it is absent.
pub fn shared(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os(SHARED).map(PathBuf::from);
    let path = folder
        .unwrap_or_else(|| workspace().join("../shared/data"))
        .join(name);
    if path.exists() {
        return Some(path);
    }
    eprintln!(
        "skipped: {} is absent; {SHARED} names the folder that holds it",
        path.display()
    );
    None
}

/// A progress callback that does nothing.
pub fn quiet() -> impl FnMut(Progress) {
    |_| {}
}
