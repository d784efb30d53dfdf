//! `check` of motors that are hardly ever steady, and what keeps it from calling a lacking effect a fault.

use std::path::{Path, PathBuf};

use super::common::{PROJECT, drivemon, scratch, stderr, stdout, text};
use super::json;

fn shipped(path: &str) -> String {
    Path::new(PROJECT).join(path).display().to_string()
}

/// The press of the scenarios, whose current sensor b shows 5 % too much from 2 s on.
fn press(folder: &Path) -> PathBuf {
    let recording = folder.join("press.csv.gz");
    let scenario = shipped("sim-host/scenarios/press.toml");
    let output = drivemon(&["simulate", &scenario, "-o", text(&recording)]);
    assert!(output.status.success(), "{}", stderr(&output));
    recording
}

/// A motor file with one line less, or changed.
fn changed(folder: &Path, motor: &str, from: &str, to: &str) -> PathBuf {
    let whole = std::fs::read_to_string(shipped(motor)).unwrap();
    assert!(whole.contains(from));
    let file = folder.join("changed.toml");
    std::fs::write(&file, whole.replace(from, to)).unwrap();
    file
}

#[test]
fn a_fault_that_comes_in_motion_is_told_with_its_cause() {
    let folder = scratch("check-in-motion");
    let recording = press(&folder);
    let motor = shipped("motors/peer-2k2-calibrated.toml");
    let page = folder.join("press.html");
    let output = drivemon(&[
        "check",
        text(&recording),
        "--motor",
        &motor,
        "--json",
        "-",
        "--report",
        text(&page),
    ]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let answer = json(&output);
    let one = &answer["recordings"][0];
    assert_eq!(
        (&one["state"], &one["verdict"]["state"]),
        (&"fault".into(), &"healthy".into())
    );
    assert_eq!(one["told"]["cause"], "current sensor, phase b");
    let sure = one["told"]["sure"].as_str().unwrap();
    assert!(sure.starts_with("it came in motion"), "{sure}");
    assert_eq!(
        one["told"]["severity"],
        "an instrument is wrong, not the motor"
    );
    assert_eq!(one["todo"][0], "clamp a second ammeter around each lead");
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains("windows that were not at rest were judged"));
    assert!(page.contains("current sensor, phase b"));
}

/// Nobody saw this motor move in good order: what looks like a fault in motion may be what its file lacks.
#[test]
fn what_was_never_seen_in_motion_is_no_fault() {
    let folder = scratch("check-never-in-motion");
    let recording = press(&folder);
    let motor = changed(
        &folder,
        "motors/peer-2k2-calibrated.toml",
        "in_motion = \"fits\"\n",
        "",
    );
    for command in ["check", "monitor"] {
        let output = drivemon(&[command, text(&recording), "--motor", text(&motor)]);
        assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
        let told = stdout(&output);
        assert!(
            told.contains("it looks like current sensor, phase b"),
            "{told}"
        );
        assert!(told.contains("never seen in motion"), "{told}");
    }
}

/// Another simulator's motor whose iron saturates, and a file that does not know it. Held against a recording of itself in good order it is no
/// fault that it moves otherwise; against one of a motor without saturation it is.
#[test]
fn a_healthy_motor_whose_file_lacks_an_effect_is_not_judged_in_motion() {
    let folder = scratch("check-lacks-effect");
    let peer = |name: &str| shipped(&format!("tests/data/peer/{name}"));
    let [healthy, other] = ["recording", "recording_b"]
        .map(|name| peer(&format!("magnetizing-saturation/{name}.csv.gz")));
    let linear = peer("none/recording.csv.gz");
    let motor = shipped("motors/peer-2k2.toml");
    let check = |healthy: &str, recording: &str| {
        drivemon(&["check", recording, "--motor", &motor, "--healthy", healthy])
    };
    for recording in [&healthy, &other] {
        let output = check(&healthy, recording);
        assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
        let told = stdout(&output);
        assert!(
            told.contains("in motion not judged: in good order it moved otherwise"),
            "{told}"
        );
    }
    assert_eq!(check(&linear, &other).status.code(), Some(1));

    let learnt = folder.join("learnt.toml");
    let output = drivemon(&[
        "calibrate",
        &healthy,
        "--motor",
        &motor,
        "-o",
        text(&learnt),
    ]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stdout(&output).contains("it moved otherwise than its file says"));
    let written = std::fs::read_to_string(&learnt).unwrap();
    assert!(written.contains("in_motion = \"differs\""), "{written}");
    let output = drivemon(&["monitor", &other, "--motor", text(&learnt)]);
    assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
}
