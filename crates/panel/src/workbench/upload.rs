//! Files that the page sends, into a folder of their own.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use axum::body::Body;
use axum::http::HeaderMap;
use axum::http::header::CONTENT_LENGTH;
use tempfile::TempDir;
use tokio_stream::StreamExt;

use crate::running::shared::Refusal;

/// Largest recording, bytes as it is sent.
pub(super) const MOST_BYTES: u64 = 256 << 20;
/// The same of all uploads together: two on the desk, and one that is to replace one of them.
const MOST_BYTES_OF_ALL: u64 = 3 * MOST_BYTES;
/// Characters of a file name that are kept.
const MOST_NAME: usize = 100;

/// A name that stays in its folder, its end as it was: the end tells the format.
pub(super) fn harmless(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or_default();
    let kept = |c: char| {
        if c.is_alphanumeric() || "._-+() ".contains(c) {
            c
        } else {
            '_'
        }
    };
    let clean: Vec<char> = last
        .trim()
        .trim_start_matches('.')
        .chars()
        .map(kept)
        .collect();
    let from = clean.len().saturating_sub(MOST_NAME);
    let name: String = clean[from..].iter().collect();
    match name.trim_matches(['.', ' ']).is_empty() {
        true => "recording.csv".into(),
        false => name,
    }
}

/// What all uploads together may take on the disk, those on the desk and those on their way.
#[derive(Debug, Default)]
pub(super) struct Budget(AtomicU64);

/// A share of the budget; given back when the file is gone.
#[derive(Debug)]
struct Share {
    budget: Arc<Budget>,
    bytes: u64,
}

impl Share {
    /// Takes more; `false` where the budget does not hold it.
    fn grow(&mut self, bytes: u64) -> bool {
        let fits = |used: u64| Some(used + bytes).filter(|used| *used <= MOST_BYTES_OF_ALL);
        let used = self.budget.0.fetch_update(Relaxed, Relaxed, fits);
        self.bytes += if used.is_ok() { bytes } else { 0 };
        used.is_ok()
    }
}

impl Drop for Share {
    fn drop(&mut self) {
        self.budget.0.fetch_sub(self.bytes, Relaxed);
    }
}

/// A file that arrived, in a folder of its own; both are gone with it.
#[derive(Debug)]
pub(super) struct Stored {
    /// The file.
    pub path: PathBuf,
    _folder: TempDir,
    _share: Share,
}

/// Writes a body beside everything that lies in `desk`, as it comes.
///
/// # Errors
/// More than [`MOST_BYTES`], no room beside the other uploads, a page that went away, or a disk that is full.
pub(super) async fn store(
    desk: &Path,
    budget: &Arc<Budget>,
    name: &str,
    headers: &HeaderMap,
    body: Body,
) -> Result<Stored, Refusal> {
    let announced = headers
        .get(CONTENT_LENGTH)
        .and_then(|length| length.to_str().ok());
    if announced.and_then(|length| length.parse().ok()) > Some(MOST_BYTES) {
        return Err(too_large(name));
    }
    let failed = |error: std::io::Error| Refusal::of(format!("{name}: cannot be kept: {error}"));
    let folder = tempfile::Builder::new()
        .prefix("recording-")
        .tempdir_in(desk);
    let folder = folder.map_err(failed)?;
    let path = folder.path().join(harmless(name));
    let mut file = File::create(&path).map_err(failed)?;
    let mut share = Share {
        budget: budget.clone(),
        bytes: 0,
    };
    let mut chunks = body.into_data_stream();
    while let Some(chunk) = chunks.next().await {
        let chunk =
            chunk.map_err(|error| Refusal::of(format!("{name}: did not arrive: {error}")))?;
        let room = share.grow(chunk.len() as u64);
        if share.bytes > MOST_BYTES {
            return Err(too_large(name));
        }
        if !room {
            return Err(no_room(name));
        }
        file.write_all(&chunk).map_err(failed)?;
    }
    Ok(Stored {
        path,
        _folder: folder,
        _share: share,
    })
}

fn no_room(name: &str) -> Refusal {
    Refusal {
        status: 413,
        ..Refusal::of(format!(
            "{name}: all uploads together may take {} MiB: wait for the others, or remove a recording",
            MOST_BYTES_OF_ALL >> 20
        ))
    }
}

fn too_large(name: &str) -> Refusal {
    Refusal {
        status: 413,
        ..Refusal::of(format!(
            "{name}: is larger than {} MiB; cut the recording, a few seconds with load steps are enough",
            MOST_BYTES >> 20
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_in_their_folder_and_keep_their_end() {
        for (sent, kept) in [
            ("rec.csv.gz", "rec.csv.gz"),
            ("../../etc/passwd", "passwd"),
            ("C:\\data\\Messung 3 (ü).csv", "Messung 3 (ü).csv"),
            ("..", "recording.csv"),
            ("", "recording.csv"),
            (".hidden.csv", "hidden.csv"),
            ("a\0b\n.csv", "a_b_.csv"),
        ] {
            assert_eq!(harmless(sent), kept, "{sent:?}");
        }
        let long = harmless(&format!("{}.parquet", "x".repeat(500)));
        assert!(long.len() == MOST_NAME && long.ends_with(".parquet"));
    }

    #[test]
    fn one_budget_is_for_all_and_is_given_back() {
        let budget = Arc::new(Budget::default());
        let share = || Share {
            budget: budget.clone(),
            bytes: 0,
        };
        let (mut first, mut second) = (share(), share());
        assert!(first.grow(2 * MOST_BYTES) && second.grow(MOST_BYTES));
        assert!(!second.grow(1), "together they have all of it");
        drop(first);
        assert!(second.grow(1));
        drop(second);
        assert_eq!(budget.0.load(Relaxed), 0);
    }
}
