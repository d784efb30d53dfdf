//! `drivemon calibrate` as a person uses it: what it writes, what it refuses, exit codes.

mod common;

use std::path::{Path, PathBuf};

use common::{PROJECT, drivemon, scratch, stderr, stdout, text};

const MOTOR: &str = "motors/peer-2k2.toml";
const HEALTHY: &str = "tests/data/peer/none/recording.csv.gz";

/// Runs `calibrate` and expects a refusal: exit code and words of the reason; nothing may be written.
fn refused(folder: &str, recording: &str, motor: &str, code: i32, words: &[&str]) {
    let out = scratch(folder).join("calibrated.toml");
    let output = drivemon(&["calibrate", recording, "--motor", motor, "-o", text(&out)]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{message}");
    for word in words {
        assert!(message.contains(word), "{word} is missing in: {message}");
    }
    assert!(!out.exists(), "a refused calibration wrote a file");
}

/// The lines of the healthy recording, its header first.
fn lines() -> Vec<String> {
    let packed = std::fs::File::open(Path::new(PROJECT).join(HEALTHY));
    let packed = packed.expect("part of the source tree");
    let whole = std::io::read_to_string(flate2::read::GzDecoder::new(packed)).expect("UTF-8");
    whole.lines().map(str::to_owned).collect()
}

/// The lines of a recording, changed one by one, beside a copy of its sidecar.
fn altered(folder: &str, change: impl Fn(usize, &str) -> Option<String>) -> PathBuf {
    let all = lines();
    let lines = all.iter().enumerate();
    let kept: Vec<String> = lines.filter_map(|(k, line)| change(k, line)).collect();
    // Beside `scratch` of the output, which is emptied.
    let folder = scratch(&format!("{folder}-source"));
    let sidecar = Path::new(PROJECT)
        .join(HEALTHY)
        .with_file_name("recording.toml");
    std::fs::copy(sidecar, folder.join("altered.toml")).expect("room for a copy");
    let file = folder.join("altered.csv");
    std::fs::write(&file, kept.join("\n")).expect("writable");
    file
}

#[test]
fn a_calibrated_motor_is_written_and_judges_its_recording_healthy() {
    let folder = scratch("calibrate");
    let (out, json) = (
        folder.join("calibrated.toml"),
        folder.join("calibrated.json"),
    );
    let output = drivemon(&[
        "calibrate",
        HEALTHY,
        "--motor",
        MOTOR,
        "-o",
        text(&out),
        "--json",
        text(&json),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(
        stdout(&output).contains("steady windows"),
        "{}",
        stdout(&output)
    );
    let written = std::fs::read_to_string(&out).expect("the motor file was written");
    assert!(written.contains("[healthy]"), "{written}");
    let json = std::fs::read_to_string(&json).expect("the JSON was written");
    let json: serde_json::Value = serde_json::from_str(&json).expect("it is JSON");
    assert_eq!(json["parameters"][0]["name"], "stator_resistance_ohm");
    assert!(
        json["windows"]
            .as_u64()
            .is_some_and(|windows| windows >= 50)
    );
    let output = drivemon(&["monitor", HEALTHY, "--motor", text(&out)]);
    assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
}

#[test]
fn a_load_table_has_no_waveforms() {
    let table = "tests/data/imc_18k5_load_test/load_test.csv";
    refused(
        "calibrate-table",
        table,
        "motors/imc-18k5.toml",
        2,
        &["load table", "no waveforms", "explain"],
    );
}

#[test]
fn a_faulty_motor_is_refused_by_its_recording() {
    let faulty = "tests/data/itsc_075hp/sc_a0_b4_c0_004.csv.gz";
    let words = ["sc_a0_b4_c0_004", "not one healthy state"];
    refused(
        "calibrate-faulty",
        faulty,
        "motors/itsc-075hp.toml",
        3,
        &words,
    );
}

#[test]
fn a_dead_sensor_is_refused_by_its_phase() {
    let header = column("ib");
    let dead = altered("calibrate-dead", |k, line| {
        let mut cells: Vec<&str> = line.split(',').collect();
        if k > 0 {
            cells[header] = "0";
        }
        Some(cells.join(","))
    });
    refused("calibrate-dead", text(&dead), MOTOR, 3, &["dead"]);
}

#[test]
fn too_few_steady_windows_are_refused_with_what_to_record() {
    // 0.5 s at 10 kHz: the start and little more.
    let short = altered("calibrate-short", |k, line| {
        (k < 5000).then(|| line.to_owned())
    });
    let words = ["steady windows", "50 are needed", "constant load"];
    refused("calibrate-short", text(&short), MOTOR, 3, &words);
}

#[test]
fn a_recording_without_speed_is_refused_by_what_is_missing() {
    let speed = column("speed");
    let without = altered("calibrate-speed", |_, line| {
        let mut cells: Vec<&str> = line.split(',').collect();
        cells.remove(speed);
        Some(cells.join(","))
    });
    // The sidecar speaks of the column that is gone.
    let sidecar = without.with_extension("toml");
    let old = std::fs::read_to_string(&sidecar).expect("copied");
    let new = old.replace("[columns.speed]\nscale = 0.09765625\n", "");
    assert_ne!(old, new);
    std::fs::write(sidecar, new).expect("writable");
    refused(
        "calibrate-speed",
        text(&without),
        MOTOR,
        3,
        &["speed is not recorded"],
    );
}

#[test]
fn options_out_of_range_are_refused() {
    for (option, value) in [("--false-alarm-rate", "0.5"), ("--winding-kelvin", "300")] {
        let output = drivemon(&[
            "calibrate",
            HEALTHY,
            "--motor",
            MOTOR,
            "-o",
            "never.toml",
            option,
            value,
        ]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains("outside"), "{}", stderr(&output));
    }
}

/// Place of a column in the recording.
fn column(name: &str) -> usize {
    let header = lines().swap_remove(0);
    let mut cells = header.split(',');
    cells
        .position(|cell| cell == name)
        .expect("a column of the recording")
}
