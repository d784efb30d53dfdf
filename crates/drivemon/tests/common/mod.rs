//! Running the binary.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub const PROJECT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Runs `drivemon` in the project's folder.
#[allow(dead_code)]
pub fn drivemon(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .args(arguments)
        .current_dir(PROJECT)
        .output()
        .expect("the binary runs")
}

#[allow(dead_code)]
pub fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A folder of this test's own, emptied before use.
pub fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    folder
}

#[allow(dead_code)]
pub fn text(path: &Path) -> &str {
    path.to_str().expect("the path is UTF-8")
}
