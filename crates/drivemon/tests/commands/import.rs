//! A file of another recorder: what was assumed is printed, stands in the JSON, and is written into a sidecar on request.

use std::fmt::Write as _;
use std::fs;

use crate::common::{drivemon, scratch, stderr, text};
use serde_json::Value;

/// Currents of clamps in mV, semicolons, decimal comma.
fn clamps() -> String {
    let mut rows = "Logger 7\nZeit (ms);CH1;CH2;CH3\n".to_owned();
    for k in 0..2000 {
        let angle = f64::from(k) * std::f64::consts::TAU / 100.0;
        let i = [0.0, -2.1, 2.1]
            .map(|shift| format!("{:.2}", 500.0 * (angle + shift).cos()).replace('.', ","));
        let _ = writeln!(
            rows,
            "{};{}",
            format!("{:.1}", f64::from(k) * 0.2).replace('.', ","),
            i.join(";")
        );
    }
    rows
}

#[test]
fn what_was_assumed_is_said_and_written_down() {
    let folder = scratch("import");
    let (file, json) = (folder.join("logger.csv"), folder.join("answer.json"));
    fs::write(&file, clamps()).expect("written");
    let flags = [
        "--columns",
        "t,ia,ib,ic",
        "--sensor",
        "i=100mV/A",
        "--unit",
        "ia=mV",
        "--unit",
        "ib=mV",
        "--unit",
        "ic=mV",
    ];
    let read = ["monitor", text(&file), "--json", text(&json)];
    let first = drivemon(&[&read[..], &flags[..], &["--write-sidecar"]].concat());
    let said = stderr(&first);
    for words in [
        "assumed: columns are separated by `;`",
        "assumed: numbers are written 3,7",
        "assumed: CH1 is ia, user's assumption",
    ] {
        assert!(said.contains(words), "{words} is not in:\n{said}");
    }
    let answer: Value = serde_json::from_slice(&fs::read(&json).expect("an answer")).expect("JSON");
    let assumptions = answer["audit"]["assumptions"].as_array().expect("a list");
    assert!(assumptions.iter().any(|one| {
        one.as_str()
            .is_some_and(|one| one.contains("through a sensor of 100mV/A"))
    }));

    let sidecar = fs::read_to_string(folder.join("logger.toml")).expect("a sidecar");
    assert!(
        sidecar.contains("column_order = \"t,ia,ib,ic\"") && sidecar.contains("ia = \"100mV/A\""),
        "{sidecar}"
    );
    let again = drivemon(&read);
    assert_eq!(
        first.status.code(),
        again.status.code(),
        "{}",
        stderr(&again)
    );
    let second: Value = serde_json::from_slice(&fs::read(&json).expect("an answer")).expect("JSON");
    assert_eq!(answer["sequence"], second["sequence"]);
    assert!(
        !stderr(&again).contains("user's assumption"),
        "{}",
        stderr(&again)
    );

    let kept = drivemon(&[&read[..], &["--write-sidecar"]].concat());
    assert_eq!(kept.status.code(), Some(2));
    assert!(
        stderr(&kept).contains("exists and is kept"),
        "{}",
        stderr(&kept)
    );
}
