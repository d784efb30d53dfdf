//! What a command writes: never over what it reads, files before the terminal, and plain errors where there is no room.
#![cfg(unix)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use crate::common::{PROJECT, scratch, stderr, stdout};

const TABLE: &str = "tests/data/imc_18k5_load_test/load_test.csv";
const MOTOR: &str = "motors/imc-18k5.toml";

fn shipped(path: &str) -> PathBuf {
    Path::new(PROJECT).join(path)
}

/// A folder with a load table `rec.csv`, its sidecar, a motor file `m.toml` and a scenario `s.toml` that names it.
fn bench(name: &str) -> PathBuf {
    let folder = scratch(name);
    fs::copy(shipped(TABLE), folder.join("rec.csv")).expect("copied");
    fs::write(folder.join("rec.toml"), "supply = \"grid\"\n").expect("written");
    fs::copy(shipped(MOTOR), folder.join("m.toml")).expect("copied");
    let scenario = "motor = \"m.toml\"\nduration_s = 0.1\nstart = \"running\"\n";
    fs::write(folder.join("s.toml"), scenario).expect("written");
    folder
}

fn within(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the binary runs")
}

/// Names and contents of a folder's files.
fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut all: Vec<_> = entries
        .map(|entry| entry.expect("an entry").path())
        .map(|path| (path.clone(), fs::read(path).expect("a file")))
        .collect();
    all.sort();
    all
}

#[test]
fn nothing_that_is_read_is_written_and_nothing_is_written_twice() {
    let folder = bench("overwrite");
    std::os::unix::fs::symlink("m.toml", folder.join("soft")).expect("linked");
    fs::hard_link(folder.join("rec.csv"), folder.join("hard")).expect("linked");
    let before = contents(&folder);
    let monitor = ["monitor", "rec.csv", "--motor", "m.toml"];
    let calibrate = ["calibrate", "rec.csv", "--motor", "m.toml", "-o"];
    let adopt = ["adopt", "core-loss", "rec.csv", "--motor", "m.toml", "-o"];
    let cases: [(&[&str], &[&str], &str); 17] = [
        (
            &["simulate", "s.toml", "-o"],
            &["m.csv"],
            "the motor file m.toml",
        ),
        (
            &["simulate", "s.toml", "-o"],
            &["s.csv.gz"],
            "the scenario s.toml",
        ),
        (&calibrate, &["rec.toml"], "what belongs to rec.csv"),
        (&calibrate, &["./rec.csv"], "the recording rec.csv"),
        (&calibrate, &["m.toml"], "the motor file m.toml"),
        (&calibrate, &["soft"], "the motor file m.toml"),
        (
            &adopt,
            &["x.toml", "--json", "x.toml"],
            "-o would overwrite --json",
        ),
        (&adopt, &["hard"], "the recording rec.csv"),
        (&monitor, &["--json", "rec.csv"], "the recording rec.csv"),
        (&monitor, &["--json", "hard"], "the recording rec.csv"),
        (&monitor, &["--report", "m.toml"], "the motor file m.toml"),
        (&monitor, &["--report", "soft"], "the motor file m.toml"),
        (&monitor, &["--json", "X", "--report", "./X"], "--json X"),
        (&monitor, &["--report", "-"], "only --json"),
        (
            &["compare", "rec.csv", "--motor", "m.toml", "--json"],
            &["rec.toml"],
            "rec.csv",
        ),
        (
            &["explain", "rec.csv", "--motor", "m.toml", "--report"],
            &["rec.csv"],
            "rec.csv",
        ),
        (
            &["demo", "--motor", "m.toml", "--json"],
            &["m.toml"],
            "the motor file",
        ),
    ];
    for (command, outputs, words) in cases {
        let arguments = [command, outputs].concat();
        let done = within(&folder, &arguments);
        let said = stderr(&done);
        assert_eq!(done.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(words), "{arguments:?}: {said}");
        assert_eq!(contents(&folder), before, "{arguments:?}");
    }
}

#[test]
fn a_sidecar_is_written_over_a_sidecar_only() {
    let folder = bench("sidecar");
    fs::copy(shipped(MOTOR), folder.join("other.toml")).expect("copied");
    let before = contents(&folder);
    let done = within(&folder, &["simulate", "s.toml", "-o", "other.csv"]);
    assert_eq!(done.status.code(), Some(2), "{}", stderr(&done));
    assert!(
        stderr(&done).contains("other.toml, which is no sidecar"),
        "{}",
        stderr(&done)
    );
    assert_eq!(contents(&folder), before);
    for _ in 0..2 {
        let done = within(&folder, &["simulate", "s.toml", "-o", "new.csv"]);
        assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    }
}

#[test]
fn the_other_half_of_a_comtrade_pair_is_an_input() {
    let folder = scratch("pair");
    for end in ["cfg", "dat"] {
        let name = format!("crates/formats/tests/data/binary-1999.{end}");
        fs::copy(shipped(&name), folder.join(format!("x.{end}"))).expect("copied");
    }
    let before = contents(&folder);
    let done = within(&folder, &["monitor", "x.cfg", "--json", "x.dat"]);
    assert_eq!(done.status.code(), Some(2), "{}", stderr(&done));
    assert_eq!(contents(&folder), before);
}

/// Runs a line of `bash`, in which `$D` is the program.
fn bash(folder: &Path, line: &str) -> Output {
    Command::new("bash")
        .args(["-c", line])
        .env("D", env!("CARGO_BIN_EXE_drivemon"))
        .current_dir(folder)
        .output()
        .expect("bash runs")
}

#[test]
fn a_terminal_without_room_is_a_plain_error_and_the_files_are_there() {
    let folder = bench("no-room");
    let json = folder.join("x.json");
    for command in [
        "monitor rec.csv --json x.json",
        "compare rec.csv --motor m.toml --json x.json",
    ] {
        let _ = fs::remove_file(&json);
        let done = bash(&folder, &format!("$D {command} > /dev/full"));
        let said = stderr(&done);
        assert_eq!(done.status.code(), Some(2), "{command}: {said}");
        assert!(
            said.starts_with("error: standard output: "),
            "{command}: {said}"
        );
        assert!(!said.contains("panicked"), "{command}: {said}");
        let written = fs::read_to_string(&json).expect("the JSON is written");
        serde_json::from_str::<serde_json::Value>(&written).expect("it is whole");
    }
    for command in [
        "--help",
        "--version",
        "completions bash",
        "monitor rec.csv --json -",
    ] {
        let done = bash(&folder, &format!("$D {command} > /dev/full"));
        let said = stderr(&done);
        assert_eq!(done.status.code(), Some(2), "{command}: {said}");
        assert!(said.contains("standard output: "), "{command}: {said}");
    }
}

#[test]
fn nobody_to_tell_is_no_panic() {
    let folder = bench("no-errors");
    let done = bash(&folder, "$D monitor none.csv 2> /dev/full");
    assert_eq!(done.status.code(), Some(2));
    let done = bash(&folder, "$D monitor rec.csv > /dev/full 2> /dev/full");
    assert_eq!(done.status.code(), Some(2));
}

#[test]
fn a_reader_that_has_seen_enough_changes_nothing() {
    let folder = bench("enough");
    for command in [
        "monitor rec.csv --json x.json",
        "completions bash",
        "monitor rec.csv --json -",
        "--help",
    ] {
        // The reader ends before the program begins to write.
        let line = format!("set -o pipefail; (sleep 0.3; $D {command}) | true");
        let done = bash(&folder, &line);
        assert_eq!(
            (done.status.code(), stderr(&done)),
            (Some(0), String::new()),
            "{command}"
        );
    }
    assert!(folder.join("x.json").is_file());
}

/// A recording of 0.3 s as CSV, gzip and Parquet, and what is said about it without its name.
#[test]
fn standard_input_is_read_whatever_it_holds() {
    let folder = bench("stdin");
    let scenario = "motor = \"m.toml\"\nduration_s = 0.3\nstart = \"running\"\n";
    fs::write(folder.join("s.toml"), scenario).expect("written");
    let mut answers = Vec::new();
    for name in ["a.csv", "a.csv.gz", "a.parquet"] {
        let done = within(&folder, &["simulate", "s.toml", "-o", name]);
        assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
        for line in [
            format!("$D monitor - --json - < {name}"),
            format!("cat {name} | $D monitor - --json -"),
            format!("$D monitor <(cat {name}) --json -"),
        ] {
            let done = bash(&folder, &line);
            assert!(
                done.status.code().is_some_and(|code| code != 2),
                "{line}: {}",
                stderr(&done)
            );
            let mut json: serde_json::Value = serde_json::from_slice(&done.stdout).expect("JSON");
            let name = json["recording"].take();
            let expected = if line.contains("<(") {
                "/dev/fd/"
            } else {
                "standard input"
            };
            assert!(
                name.as_str().is_some_and(|name| name.starts_with(expected)),
                "{name}"
            );
            answers.push(json);
        }
    }
    assert!(answers.windows(2).all(|pair| pair[0] == pair[1]));
    let done = bash(&folder, "$D monitor - < /dev/null");
    assert_eq!(done.status.code(), Some(2));
    assert!(
        stderr(&done).starts_with("error: standard input: is empty"),
        "{}",
        stderr(&done)
    );
    let done = bash(&folder, "$D compare - - --motor m.toml < a.csv");
    assert!(
        stderr(&done).contains("more than once"),
        "{}",
        stderr(&done)
    );
}

#[test]
fn endings_have_no_case() {
    let folder = bench("case");
    let gz = fs::File::create(folder.join("X.CSV.GZ")).expect("made");
    let mut gz = flate2::write::GzEncoder::new(gz, flate2::Compression::fast());
    std::io::copy(
        &mut fs::File::open(folder.join("rec.csv")).expect("there"),
        &mut gz,
    )
    .expect("copied");
    gz.finish().expect("written");
    let done = within(&folder, &["monitor", "X.CSV.GZ"]);
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    // The sidecar is found and read.
    fs::write(folder.join("X.TOML"), "colour = 1\n").expect("written");
    let done = within(&folder, &["monitor", "X.CSV.GZ"]);
    assert!(
        stderr(&done).contains("X.TOML:1: colour"),
        "{}",
        stderr(&done)
    );
    let done = within(&folder, &["simulate", "s.toml", "-o", "Y.CSV.Gz"]);
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    assert!(
        fs::read(folder.join("Y.CSV.Gz"))
            .expect("there")
            .starts_with(&[0x1F, 0x8B])
    );
    assert!(folder.join("Y.toml").is_file());
}

#[test]
fn several_recordings_are_judged_each_by_itself() {
    let folder = bench("several");
    let one = within(&folder, &["monitor", "rec.csv", "--json", "one.json"]);
    assert_eq!(one.status.code(), Some(0));
    fs::write(folder.join("bad.csv"), "t,ia\n0,1\n1,x\n").expect("written");
    fs::write(
        folder.join("short.csv"),
        "t,ia,ib,ic\n0,1,2,3\n1,1,2,3\n2,1,2,3\n",
    )
    .expect("written");
    let arguments = [
        "monitor",
        "rec.csv",
        "bad.csv",
        "short.csv",
        "--json",
        "all.json",
    ];
    let all = within(&folder, &arguments);
    let said = stdout(&all);
    assert_eq!(all.status.code(), Some(2), "the worst: {}", stderr(&all));
    assert!(stderr(&all).contains("bad.csv:3: ia"), "{}", stderr(&all));
    for name in ["rec.csv", "bad.csv", "short.csv"] {
        assert!(
            said.lines().any(|line| line.starts_with(name)),
            "{name} in {said}"
        );
    }
    assert!(
        said.contains("3 recordings:\n  not read      bad.csv\n"),
        "{said}"
    );
    let json = |name: &str| -> serde_json::Value {
        serde_json::from_slice(&fs::read(folder.join(name)).expect("written")).expect("JSON")
    };
    let list = json("all.json");
    assert_eq!(list.as_array().map(Vec::len), Some(3));
    assert_eq!(
        list[0],
        json("one.json"),
        "a recording's JSON is the same alone and in the list"
    );
    assert_eq!(list[1]["recording"], "bad.csv");
    assert!(
        list[1]["error"]
            .as_str()
            .is_some_and(|text| text.contains("is not a number"))
    );
    assert_eq!(list[2]["recording"], "short.csv");

    let page = within(
        &folder,
        &["monitor", "rec.csv", "short.csv", "--report", "x.html"],
    );
    assert_eq!(page.status.code(), Some(2));
    assert!(stderr(&page).contains("one recording"), "{}", stderr(&page));
}

#[test]
fn several_recordings_may_come_as_json_on_standard_output() {
    let folder = bench("several-json");
    let done = Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .args(["monitor", "rec.csv", "-", "--json", "-"])
        .current_dir(&folder)
        .stdin(Stdio::from(
            fs::File::open(folder.join("rec.csv")).expect("there"),
        ))
        .output()
        .expect("the binary runs");
    let list: serde_json::Value = serde_json::from_slice(&done.stdout).expect("JSON alone");
    assert_eq!(list.as_array().map(Vec::len), Some(2));
}

#[test]
fn what_a_recording_has_no_use_for_is_refused() {
    let folder = bench("no-use");
    for (arguments, words) in [
        (&["rec.csv", "--for", "3"][..], "cannot be used with"),
        (
            &["--serial", "/dev/null", "--for", "nan"],
            "a time in seconds above 0",
        ),
        (
            &["--serial", "/dev/null", "--for", "1e300"],
            "a time in seconds above 0",
        ),
        (
            &["rec.csv", "--motor", "m.toml", "--capture", "x.csv"],
            "cannot be used with",
        ),
        (
            &["rec.csv", "--pulses-per-revolution", "0"],
            "the number on its plate",
        ),
        (&["."], ".: is a folder; name a .csv"),
        (
            &["s.toml"],
            "s.toml: is a motor file, a scenario or a sidecar by its name",
        ),
        (
            &["rec.csv", "--sidecar", "/dev/zero"],
            "more than 1048576 bytes",
        ),
    ] {
        let done = within(&folder, &[&["monitor"], arguments].concat());
        let said = stderr(&done);
        assert_eq!(done.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(words), "{arguments:?}: {said}");
    }
}
