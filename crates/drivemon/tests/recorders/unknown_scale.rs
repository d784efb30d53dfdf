//! A measured recording with an uncalibrated tachometer, through the binary. Skipped with a message where the
//! recording is absent (docs/data.md).

use std::path::{Path, PathBuf};

use crate::common::{PROJECT, drivemon, scratch, stderr, stdout, text};
use serde_json::Value;

/// Raw reading at no load, in the last tenth of a second of the start, and at rest before it; the motor then runs at
/// 1497 rpm, three in fifteen hundred below the field (docs/data.md).
const RAW: [f64; 2] = [152.98, -2.11];
const NO_LOAD_RPM: f64 = 1497.0;

fn laboratory(name: &str) -> Option<PathBuf> {
    let shared = std::env::var_os("DRIVE_MONITOR_SHARED_DATA").map(PathBuf::from);
    let shared = shared.unwrap_or_else(|| Path::new(PROJECT).join("../shared/data"));
    let path = shared.join(format!("measured/chalmers_lab_4kw/{name}.csv.gz"));
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: {} is absent", path.display());
    None
}

fn json(path: &Path) -> Value {
    let written = std::fs::read_to_string(path).expect("the JSON was written");
    serde_json::from_str(&written).expect("it is JSON")
}

fn names(list: &Value) -> Vec<&str> {
    let items = list.as_array().into_iter().flatten();
    items.filter_map(|item| item["name"].as_str()).collect()
}

#[test]
fn the_laboratory_start_is_explained_with_its_scale_free() {
    let Some(recording) = laboratory("direct_start") else {
        return;
    };
    let folder = scratch("unknown-scale");
    let (result, page) = (folder.join("explain.json"), folder.join("explain.html"));
    let output = drivemon(&[
        "explain",
        text(&recording),
        "--motor",
        "motors/chalmers-4kw.toml",
        "--column",
        "speed=speed_raw",
        "--scale",
        "speed=unknown",
        "--json",
        text(&result),
        "--report",
        text(&page),
    ]);
    let shown = stdout(&output);
    assert!(output.status.code() < Some(2), "{}", stderr(&output));
    let report = json(&result);

    let findings = report["audit"]["findings"].as_array().expect("findings");
    let of = |code: &str| -> Vec<&str> {
        let found = findings.iter().filter(|f| f["code"] == code);
        found.filter_map(|f| f["channel"].as_str()).collect()
    };
    assert_eq!(of("clipping"), ["ia", "ib", "ic"]);
    assert_eq!(of("scale-unknown"), ["speed"]);
    let clips = findings.iter().find(|f| f["channel"] == "ic").expect("ic");
    let detail = clips["detail"].as_str().expect("a sentence");
    assert!(detail.contains("second probe ic2"), "{detail}");

    let scale = &report["speed_scale"];
    let factor = scale["factor"].as_f64().expect("a number");
    let expected = NO_LOAD_RPM * std::f64::consts::TAU / 60.0 / (RAW[0] - RAW[1]);
    // The slip of an idling motor of this size is a few tenths of a per cent.
    assert!(
        (factor / expected - 1.0).abs() < 0.005,
        "{factor} for {expected}"
    );
    assert!(scale["std_error"].as_f64() > Some(0.0));
    assert_eq!(scale["offset_is"], "measured");
    assert!((scale["offset"].as_f64().expect("a number") - RAW[1]).abs() < 0.1);

    let open = names(&report["cannot_be_concluded"]);
    assert!(open.contains(&"rotor_resistance_ohm"), "{open:?}\n{shown}");
    for said in [
        "declared unknown",
        "Cannot be concluded",
        "rotor_resistance_ohm",
    ] {
        assert!(shown.contains(said), "{said}:\n{shown}");
    }
    let page = std::fs::read_to_string(page).expect("the page was written");
    assert!(page.contains("What cannot be concluded"));
}

/// `compare` reads the third current from the second probe: what it reports of ic is what it reports when told to.
#[test]
fn the_second_probe_is_taken_without_being_told() {
    let Some(recording) = laboratory("direct_start") else {
        return;
    };
    let folder = scratch("second-probe");
    let signal = |name: &str, more: &[&str]| {
        let result = folder.join(name);
        let mut arguments = vec!["compare", text(&recording)];
        arguments.extend([
            "--motor",
            "motors/chalmers-4kw.toml",
            "--column",
            "speed=speed_raw",
        ]);
        arguments.extend(["--scale", "speed=unknown", "--json", text(&result)]);
        arguments.extend(more);
        let output = drivemon(&arguments);
        assert!(output.status.code() < Some(2), "{}", stderr(&output));
        json(&result)["signals"][2].clone()
    };
    let own = signal("own.json", &[]);
    assert_eq!(own["name"], "ic");
    assert_eq!(own, signal("told.json", &["--column", "ic=ic2"]));
}

#[test]
fn an_idling_motor_says_nothing_about_its_rotor() {
    let Some(recording) = laboratory("no_load") else {
        return;
    };
    let result = scratch("idling").join("compare.json");
    let output = drivemon(&[
        "compare",
        text(&recording),
        "--motor",
        "motors/chalmers-4kw.toml",
        "--column",
        "speed=speed_raw",
        "--scale",
        "speed=unknown",
        "--json",
        text(&result),
    ]);
    assert!(output.status.code() < Some(2), "{}", stderr(&output));
    let report = json(&result);
    assert_eq!(report["speed_scale"]["offset_is"], "assumed");
    // 2.45 raw at 1497 rpm.
    let rpm = report["speed_scale"]["factor"].as_f64().expect("a number") * 2.4535 * 60.0
        / std::f64::consts::TAU;
    assert!((rpm / NO_LOAD_RPM - 1.0).abs() < 0.005, "{rpm}");
    let open = names(&report["cannot_be_concluded"]);
    assert!(
        open.contains(&"slip") && open.contains(&"rotor_resistance_ohm"),
        "{open:?}"
    );
}

/// The scale is not declared unknown: the audit finds it, and says what to type.
#[test]
fn a_speed_that_cannot_be_one_is_told_with_the_flag() {
    let Some(recording) = laboratory("no_load") else {
        return;
    };
    let output = drivemon(&[
        "compare",
        text(&recording),
        "--motor",
        "motors/chalmers-4kw.toml",
        "--column",
        "speed=speed_raw",
    ]);
    let shown = stdout(&output);
    assert!(shown.contains("--scale speed=unknown"), "{shown}");
}
