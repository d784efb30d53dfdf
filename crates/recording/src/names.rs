//! The names of files: how they end, in upper or lower case, and which files belong to a recording.

use std::path::{Path, PathBuf};

/// Whether a name ends like this, `.csv.gz`, in upper or lower case.
pub fn ends_in(path: &Path, end: &str) -> bool {
    let name = path.to_string_lossy().to_lowercase();
    name.ends_with(end)
}

/// The extension in lower case; empty without one.
pub fn extension(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default();
    extension.to_string_lossy().to_lowercase()
}

/// The file of the same name with another extension, in the case that is there: `x.cfg`, `x.CFG` or `x.Cfg`.
pub fn beside(path: &Path, extension: &str) -> Option<PathBuf> {
    let first: String = extension[..1].to_uppercase() + &extension[1..];
    let spellings = [extension.to_owned(), extension.to_uppercase(), first];
    let paths = spellings.iter().map(|end| path.with_extension(end));
    paths.into_iter().find(|path| path.exists())
}

/// The sidecar that belongs to a recording: `a/x.csv.gz` and `a/x.csv` have `a/x.toml`, or `a/x.TOML` where that is there.
pub fn sidecar_path(recording: &Path) -> PathBuf {
    let unpacked = match extension(recording).as_str() {
        "gz" => recording.with_extension(""),
        _ => recording.to_owned(),
    };
    beside(&unpacked, "toml").unwrap_or_else(|| unpacked.with_extension("toml"))
}

/// What is read together with a recording, there or not: its sidecar, and the other half of a COMTRADE pair.
pub fn companions(recording: &Path) -> Vec<PathBuf> {
    let partner = match extension(recording).as_str() {
        "cfg" => Some("dat"),
        "dat" => Some("cfg"),
        _ => None,
    };
    let partner =
        partner.map(|end| beside(recording, end).unwrap_or_else(|| recording.with_extension(end)));
    std::iter::once(sidecar_path(recording))
        .chain(partner)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sidecar_stands_beside_its_recording() {
        for (recording, sidecar) in [
            ("a/x.csv.gz", "a/x.toml"),
            ("a/X.CSV.GZ", "a/X.toml"),
            ("x.csv", "x.toml"),
            ("a.b/x.1.csv.gz", "a.b/x.1.toml"),
            ("x", "x.toml"),
        ] {
            assert_eq!(sidecar_path(Path::new(recording)), Path::new(sidecar));
        }
    }

    #[test]
    fn an_end_has_no_case() {
        assert!(ends_in(Path::new("a/X.CSV.gz"), ".csv.gz"));
        assert!(!ends_in(Path::new("a/X.CSV"), ".csv.gz"));
        assert_eq!(extension(Path::new("X.ParQuet")), "parquet");
    }

    #[test]
    fn both_halves_of_a_pair_belong_together() {
        let both = companions(Path::new("a/x.CFG"));
        assert_eq!(both, [Path::new("a/x.toml"), Path::new("a/x.dat")]);
        assert_eq!(companions(Path::new("a/x.csv")), [Path::new("a/x.toml")]);
    }
}
