//! Where the loader's file is, which every board has in flash before its program.

use std::path::{Path, PathBuf};

use crate::error::BoardError;

const LOADER_VARIABLE: &str = "DRIVE_MONITOR_LOADER";
const PROGRAM_VARIABLE: &str = "DRIVE_MONITOR_ELF";
/// Where `tools/thumb` puts what it builds.
const BUILT: &str = "target/thumbv7em-none-eabihf/release";

/// The loader's ELF file: the one that `DRIVE_MONITOR_LOADER` names, or `loader` beside the program of `DRIVE_MONITOR_ELF`,
/// or what was built last.
pub fn read() -> Result<Vec<u8>, BoardError> {
    let path = path();
    std::fs::read(&path).map_err(|error| {
        BoardError::Elf(format!(
            "{}: {error}; `tools/thumb build --release -p loader` builds the loader",
            path.display()
        ))
    })
}

fn path() -> PathBuf {
    let named = |name| std::env::var_os(name).map(PathBuf::from);
    let beside = || named(PROGRAM_VARIABLE).map(|program| program.with_file_name("loader"));
    let built = || {
        let tree = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        tree.join(BUILT).join("loader")
    };
    named(LOADER_VARIABLE).or_else(beside).unwrap_or_else(built)
}
