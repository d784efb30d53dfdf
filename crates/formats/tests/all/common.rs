//! Where the tests find their files.
#![allow(dead_code)]

use flate2::{Compression, write::GzEncoder};
use formats::Progress;
use std::io::Write;
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

/// A temporary folder, removed at the end of a test.
pub struct Folder(PathBuf);

impl Folder {
    /// Makes a folder of its own for the test called `test`.
    pub fn new(test: &str) -> Folder {
        use std::sync::atomic::{AtomicU32, Ordering};
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("recording-{test}-{}-{count}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).expect("a temporary folder");
        Folder(path)
    }

    /// A path inside the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Writes a file and returns its path.
    pub fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, bytes).expect("a file in the temporary folder");
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Bytes as a gzip file.
pub fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).expect("memory");
    encoder.finish().expect("memory")
}

/// A recording of the peer sets, as this repository carries it.
pub fn peer(set: &str, file: &str) -> PathBuf {
    committed(&format!("peer/{set}/{file}.csv.gz"))
}
