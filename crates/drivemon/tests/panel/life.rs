//! How a panel begins and ends, and what its interface says.

use std::path::Path;
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::http::{get, post};
use crate::server::{Server, refused, root};

/// Waits for something that the source's thread brings about.
pub fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !holds() {
        assert!(
            begin.elapsed() < Duration::from_secs(120),
            "{what} did not happen"
        );
        sleep(Duration::from_millis(50));
    }
}

#[test]
fn bad_input_ends_with_the_usual_words() {
    for (arguments, word) in [
        (vec!["--motor", "motors/none.toml"], "motors/none.toml"),
        (vec!["--sim", "motors/peer-2k2.toml"], "motor"),
        (vec!["--replay", "none.csv"], "none.csv"),
        (
            vec!["--replay", "tests/data/imc_18k5_load_test/load_test.csv"],
            "drivemon monitor",
        ),
        (vec!["--serial", "/dev/no-such-port"], "/dev/no-such-port"),
        (vec!["--speed", "0"], "0.01"),
        (vec!["--sim", "a", "--replay", "b"], "cannot be used with"),
    ] {
        let (code, said) = refused(&[&["--port", "0"], arguments.as_slice()].concat());
        assert_eq!(code, Some(2), "{arguments:?}: {said}");
        assert!(said.contains(word), "{arguments:?}: {said}");
    }
}

#[test]
fn a_port_in_use_is_named_and_ctrl_c_ends_it() {
    let server = Server::start(&[]);
    let (code, said) = refused(&["--port", server.port()]);
    assert_eq!(code, Some(2));
    assert!(
        said.contains(&server.address) && said.contains("--port 0"),
        "{said}"
    );
    // A page that listens must not keep it alive.
    let _page = std::net::TcpStream::connect(&server.address).expect("it listens");
    assert_eq!(server.interrupt(), Some(0));
}

#[test]
fn an_alarm_leaves_a_recording_that_compare_reads() {
    let server = Server::start(&["--speed", "4"]);
    let address = server.address.as_str();
    let second = || {
        get(address, "/api/history")
            .json()
            .as_array()
            .is_some_and(|rows| rows.len() > 80)
    };
    until("more than a second", second);
    let faults = "{\"faults\": [{\"name\": \"Rs\", \"change_percent\": 50}]}";
    assert_eq!(post(address, "/api/faults", faults).status, 204);
    let event = || get(address, "/api/events").json()[0].clone();
    until("the recording of the alarm", || {
        event()["samples"].as_u64() > Some(0)
    });
    let event = event();
    assert_eq!(event["lit"], serde_json::json!(["r1", "r4", "fault"]));
    assert_eq!(event["causes"][0]["name"], "Rs");
    for k in [0, 1] {
        assert_eq!(event["causes"][k]["tied"], true);
    }
    acknowledged(address);
    let folder = std::env::temp_dir().join(format!("drivemon-panel-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    for format in ["csv", "parquet", "toml"] {
        let answer = get(address, &format!("/api/events/0/recording.{format}"));
        assert_eq!(answer.status, 200);
        std::fs::write(folder.join(format!("alarm.{format}")), &answer.body).expect("written");
    }
    for name in ["alarm.csv", "alarm.parquet"] {
        let recording = formats::read_recording(
            &folder.join(name),
            &recording::Mapping::default(),
            &mut |_| {},
        );
        let recording = recording.expect("a recording");
        // From 1 s before to 0.5 s after.
        assert!(
            (1.4..1.55).contains(&recording.duration()),
            "{}",
            recording.duration()
        );
        assert!(
            recording.voltages().is_some()
                && recording.currents().is_some()
                && recording.speed().is_some()
        );
    }
    for (format, begin) in [("csv", "t_s,"), ("json", "[{\"t_s\":"), ("parquet", "PAR1")] {
        let answer = get(address, &format!("/api/export/windows.{format}"));
        assert!(answer.text().starts_with(begin), "{format}");
        assert!(
            answer
                .header("content-disposition")
                .is_some_and(|value| value.starts_with("attachment"))
        );
    }
    std::fs::remove_dir_all(folder).expect("it was made");
}

/// Who, when and what is kept by the server: every page is told, also one that comes later.
fn acknowledged(address: &str) {
    let seen = |by: &str, comment: &str| {
        let body = serde_json::json!({"by": by, "comment": comment}).to_string();
        post(address, "/api/acknowledge", &body).status
    };
    assert_eq!(seen(&"x".repeat(61), ""), 422);
    assert_eq!(seen("Ada", "terminal tightened"), 204);
    // What one has seen another does not overwrite.
    assert_eq!(seen("Bob", ""), 204);
    let kept = get(address, "/api/events").json()[0]["acknowledged"].clone();
    assert_eq!(
        (&kept["by"], &kept["comment"]),
        (&"Ada".into(), &"terminal tightened".into())
    );
    let now = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)
        .expect("now");
    let when = kept["unix_s"].as_u64().expect("a time");
    assert!(now.as_secs().abs_diff(when) < 60, "{when}");
}

#[test]
fn a_replay_that_has_ended_or_is_paused_can_be_sought() {
    let peer = "tests/data/peer/supply-unbalance/recording.csv.gz";
    let server = Server::start(&[
        "--replay",
        peer,
        "--motor",
        "motors/peer-2k2.toml",
        "--speed",
        "50",
    ]);
    let address = server.address.as_str();
    let status = || get(address, "/api/status").json();
    until("the end", || status()["ended"] == true);
    let last = || {
        let rows = get(address, "/api/history").json();
        rows.as_array()
            .and_then(|rows| rows.last()?["t_s"].as_f64())
            .unwrap_or(f64::NAN)
    };
    let end = status()["source"]["span_s"][1].as_f64().expect("an end");
    assert!((last() - end).abs() < 0.05, "{} of {end}", last());
    assert_eq!(
        post(address, "/api/pause", "{\"paused\": true}").status,
        204
    );
    for t_s in [0.5 * end, end, 0.3 * end] {
        let body = format!("{{\"t_s\": {t_s}}}");
        assert_eq!(post(address, "/api/seek", &body).status, 204);
        assert!((last() - t_s).abs() < 0.05, "{} after {t_s}", last());
    }
    assert_eq!(
        (&status()["paused"], &status()["ended"]),
        (&true.into(), &false.into())
    );
}

#[test]
fn what_cannot_be_done_is_said() {
    let server = Server::start(&[]);
    let refusal = |path: &str, body: &str| {
        let answer = post(&server.address, path, body);
        assert_eq!(answer.status, 422, "{path}");
        answer.json()
    };
    let negative = refusal(
        "/api/parameters",
        "{\"parameters.stator_leakage_henry\": \"-0.02\"}",
    );
    assert_eq!(
        negative["problems"][0]["key"],
        "parameters.stator_leakage_henry"
    );
    assert!(
        negative["problems"][0]["message"]
            .as_str()
            .is_some_and(|words| words.contains("-0.02"))
    );
    for (body, word) in [
        (
            "{\"faults\": [{\"name\": \"Xx\", \"change_percent\": 5}]}",
            "Rs, Rr",
        ),
        (
            "{\"faults\": [{\"name\": \"Rs\", \"change_percent\": -100}]}",
            "-95",
        ),
        (
            "{\"faults\": [{\"name\": \"bars\", \"change_percent\": 900}]}",
            "bars",
        ),
    ] {
        let said = refusal("/api/faults", body)["message"]
            .as_str()
            .unwrap_or_default()
            .to_owned();
        assert!(
            said.contains(word) || said.contains("another size"),
            "{said}"
        );
    }
    assert!(
        refusal("/api/seek", "{\"t_s\": 1}")["message"]
            .as_str()
            .is_some_and(|words| words.contains("recording"))
    );
}

#[test]
fn a_calibrated_motor_names_phase_and_size() {
    let server = Server::start(&[
        "--motor",
        "motors/assumed-300w-calibrated.toml",
        "--speed",
        "4",
    ]);
    let address = server.address.as_str();
    let faults = "{\"faults\": [{\"name\": \"Rsa\", \"change_percent\": 100}]}";
    assert_eq!(post(address, "/api/faults", faults).status, 204);
    let cause = || get(address, "/api/events").json()[0]["causes"][0].clone();
    until("the cause", || cause()["phase"] == "a");
    until("its size", || {
        let size = cause()["size_percent"].as_f64().unwrap_or(0.0);
        // As drivemon monitor estimates it; the first windows still contain the healthy motor.
        (80.0..110.0).contains(&size)
    });
    assert_eq!(cause()["name"], "Rs");
    let row = get(address, "/api/history")
        .json()
        .as_array()
        .and_then(|rows| rows.last().cloned());
    let sigma = row.and_then(|row| row["significance_sigma"].as_f64());
    assert!(sigma.is_some_and(|sigma| sigma > 5.0), "{sigma:?}");
}

#[test]
fn a_recording_that_the_audit_refuses_is_not_played() {
    let path = std::env::temp_dir().join(format!("drivemon-rms-{}.csv", std::process::id()));
    let rows = (0..3000).map(|k| format!("{},231,230,229,1,1,1,5\n", f64::from(k) * 1e-4));
    let text: String = std::iter::once("t,va,vb,vc,ia,ib,ic,speed\n".to_owned())
        .chain(rows)
        .collect();
    std::fs::write(&path, text).expect("written");
    let name = path.to_str().expect("UTF-8");
    let (code, said) = refused(&[
        "--port",
        "0",
        "--replay",
        name,
        "--motor",
        "motors/assumed-300w.toml",
    ]);
    std::fs::remove_file(&path).expect("it was made");
    assert_eq!(code, Some(3), "{said}");
    assert!(said.contains("effective values"), "{said}");
}

/// A press that is never steady for five cycles: its recording is judged, and the current sensor that shows 5 % too much from 2 s on
/// lights FAULT.
#[test]
fn a_recording_is_judged_in_motion() {
    let press = Path::new(env!("CARGO_TARGET_TMPDIR")).join("panel-press.csv.gz");
    let press = press.to_str().expect("a name");
    let simulated = Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .args(["simulate", "sim-host/scenarios/press.toml", "-o", press])
        .current_dir(root())
        .output()
        .expect("it runs");
    assert!(simulated.status.success(), "{simulated:?}");
    let motor = "motors/peer-2k2-calibrated.toml";
    let server = Server::start(&["--replay", press, "--motor", motor, "--speed", "50"]);
    let address = server.address.as_str();
    until("the end", || {
        get(address, "/api/status").json()["ended"] == true
    });
    let rows = get(address, "/api/history").json();
    let rows = rows.as_array().expect("rows");
    let at = |row: &serde_json::Value| row["t_s"].as_f64().expect("a time");
    let moving = rows.iter().filter(|row| at(row) > 0.7);
    assert!(moving.clone().count() > 100);
    assert!(moving.clone().all(|row| row["judged"] == true));
    // Named 0.4 s after it was found.
    let lit = moving.filter(|row| row["fault"] == true);
    let first = lit.map(at).next().expect("a fault");
    assert!((2.4..2.7).contains(&first), "{first}");
}
