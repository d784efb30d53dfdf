//! Disks that are full and folders that take nothing: a clear error, and what was there before is still there.
#![cfg(unix)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::common::{PROJECT, drivemon, scratch, stderr, stdout, text};

/// Runs `drivemon` where no file can grow beyond this size: the system refuses the write as it would on a full disk.
fn with_room_for(kibibyte: u32, arguments: &[&str]) -> Output {
    Command::new("bash")
        // The signal is ignored, so that the write fails instead of the process.
        .args([
            "-c",
            &format!("trap '' XFSZ; ulimit -f {kibibyte}; exec \"$@\""),
        ])
        .args(["bash", env!("CARGO_BIN_EXE_drivemon")])
        .args(arguments)
        .current_dir(PROJECT)
        .output()
        .expect("bash runs")
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<_> = entries
        .map(|entry| {
            let name = entry.expect("an entry").file_name();
            name.to_string_lossy().into_owned()
        })
        .collect();
    names.sort();
    names
}

/// Asserts that the command fails for want of room, says for which file, and leaves the old one as it was, alone.
fn assert_refused(kibibyte: u32, folder: &Path, file: &str, arguments: &[&str]) {
    let path = folder.join(file);
    std::fs::write(&path, "old").expect("written");
    let before = names(folder);
    let done = with_room_for(kibibyte, arguments);
    let said = stderr(&done);
    assert_eq!(done.status.code(), Some(2), "{said}");
    assert!(said.contains(file), "which file: {said}");
    assert!(said.contains("too large"), "why: {said}");
    assert!(!said.contains("panicked"), "{said}");
    assert_eq!(std::fs::read_to_string(&path).expect("there"), "old");
    assert_eq!(names(folder), before, "something was left behind");
}

fn paths<const N: usize>(folder: &Path, names: [&str; N]) -> [PathBuf; N] {
    names.map(|name| folder.join(name))
}

const SCENARIO: &str = "sim-host/scenarios/healthy-300w.toml";
const TABLE: &str = "tests/data/imc_18k5_load_test/load_test.csv";
const MOTOR: &str = "motors/imc-18k5.toml";

#[test]
fn a_recording_is_written_whole_or_not_at_all() {
    let folder = scratch("full-recording");
    for file in ["rec.csv", "rec.csv.gz", "rec.parquet"] {
        let path = folder.join(file);
        let simulate = ["simulate", SCENARIO, "-o", text(&path)];
        assert_refused(8, &folder, file, &simulate);
        std::fs::remove_file(&path).expect("removed");
    }
}

#[test]
fn results_and_motor_files_are_written_whole_or_not_at_all() {
    let folder = scratch("full-results");
    let [motor, json, page] = paths(&folder, ["better.toml", "result.json", "page.html"]);
    let adopt = [
        "adopt",
        "core-loss",
        TABLE,
        "--motor",
        MOTOR,
        "-o",
        text(&motor),
    ];
    assert_refused(1, &folder, "better.toml", &adopt);
    let explain = ["explain", TABLE, "--motor", MOTOR];
    let with = |option, path| [&explain[..], &[option, text(path)]].concat();
    assert_refused(1, &folder, "result.json", &with("--json", &json));
    assert_refused(64, &folder, "page.html", &with("--report", &page));
}

#[test]
fn a_campaign_goes_on_when_there_is_room_again() {
    let folder = scratch("full-campaign");
    let [whole, cut, page] = paths(&folder, ["whole.parquet", "cut.parquet", "page.md"]);
    let run = |path| ["campaign", "run", "campaigns/smoke.toml", "-o", path];
    let refused = with_room_for(4, &run(text(&cut)));
    let said = stderr(&refused);
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(
        said.contains("cut.parquet") && said.contains("too large"),
        "{said}"
    );
    assert!(!cut.exists());
    for path in [&cut, &whole] {
        let done = drivemon(&run(text(path)));
        assert!(
            done.status.code().is_some_and(|code| code < 2),
            "{}",
            stderr(&done)
        );
    }
    let bytes = |path| std::fs::read(path).expect("written");
    assert!(bytes(&cut) == bytes(&whole));

    let table = ["campaign", "table", text(&whole), "--markdown", text(&page)];
    assert_refused(1, &folder, "page.md", &table);
}

#[test]
fn a_folder_that_takes_nothing_is_named() {
    // Not even root makes files in the first.
    for (folder, remedy) in [
        ("/proc", "check the folder"),
        ("/no/such/folder", "make it"),
    ] {
        let path = format!("{folder}/rec.csv");
        let done = drivemon(&["simulate", SCENARIO, "-o", &path]);
        let said = stderr(&done);
        assert_eq!(done.status.code(), Some(2), "{said}");
        assert!(said.contains(&path) && said.contains(remedy), "{said}");
        assert_eq!(stdout(&done), "");
    }
}
