//! The number of the last session, kept over restarts: a death that a broker still holds from before must not end a new session.

use std::fs;
use std::io;
use std::path::Path;

/// Number of the next session; 0 where none was kept.
pub(super) fn next(file: Option<&Path>) -> u8 {
    let text = file.and_then(|file| fs::read_to_string(file).ok());
    let last = text.and_then(|text| text.trim().parse::<u8>().ok());
    last.map_or(0, |last| last.wrapping_add(1))
}

/// Keeps the number of a session, before it begins.
pub(super) fn keep(file: Option<&Path>, number: u8) -> io::Result<()> {
    let Some(file) = file else {
        return Ok(());
    };
    let beside = file.with_extension("new");
    fs::write(&beside, format!("{number}\n"))?;
    fs::rename(&beside, file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_go_on_and_round() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("session");
        assert_eq!(next(Some(&file)), 0);
        for (kept, then) in [(0, 1), (254, 255), (255, 0)] {
            keep(Some(&file), kept).expect("a writable folder");
            assert_eq!(next(Some(&file)), then);
        }
        assert_eq!(next(None), 0);
    }
}
