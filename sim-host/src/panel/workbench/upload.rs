//! Files that the page sends, into a folder of their own.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use axum::body::Body;
use axum::http::HeaderMap;
use axum::http::header::CONTENT_LENGTH;
use tokio_stream::StreamExt;

use crate::panel::session::Refusal;

/// Largest recording, bytes as it is sent.
pub(super) const MOST_BYTES: u64 = 256 << 20;
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

/// Writes a body into `folder`, as it comes.
///
/// # Errors
/// More than [`MOST_BYTES`], a page that went away, or a disk that is full.
pub(super) async fn store(
    folder: &Path,
    name: &str,
    headers: &HeaderMap,
    body: Body,
) -> Result<PathBuf, Refusal> {
    let announced = headers
        .get(CONTENT_LENGTH)
        .and_then(|length| length.to_str().ok());
    if announced.and_then(|length| length.parse().ok()) > Some(MOST_BYTES) {
        return Err(too_large(name));
    }
    let path = folder.join(harmless(name));
    let failed = |error: std::io::Error| Refusal::of(format!("{name}: cannot be kept: {error}"));
    let mut file = File::create(&path).map_err(failed)?;
    let mut chunks = body.into_data_stream();
    let mut bytes = 0;
    while let Some(chunk) = chunks.next().await {
        let chunk =
            chunk.map_err(|error| Refusal::of(format!("{name}: did not arrive: {error}")))?;
        bytes += chunk.len() as u64;
        if bytes > MOST_BYTES {
            return Err(too_large(name));
        }
        file.write_all(&chunk).map_err(failed)?;
    }
    Ok(path)
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
}
