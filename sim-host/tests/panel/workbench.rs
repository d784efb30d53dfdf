//! The workbench over HTTP: from two recordings to a better motor file, and everything that is refused.

use std::time::Duration;

use motor::MotorFile;
use serde_json::{Value, json};

use crate::http::{Answer, get, post, send};
use crate::life::until;
use crate::server::{Server, root};

const PEER: &str = "tests/data/peer/magnetizing-saturation";

/// A request whose body is a file.
fn upload(address: &str, path: &str, body: &[u8]) -> Answer {
    let head = format!(
        "POST /api/workbench/{path} HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\nConnection: close\r\n\
         Content-Type: application/octet-stream\r\nContent-Length: {}\r\n\r\n",
        body.len()
    );
    send(address, &[head.as_bytes(), body].concat())
}

fn project(name: &str) -> Vec<u8> {
    std::fs::read(root().join(name)).expect(name)
}

fn state(address: &str) -> Value {
    get(address, "/api/workbench/state").json()
}

/// Recording and sidecar into a slot, as the page sends them.
fn load(address: &str, slot: usize, name: &str) -> Value {
    let path = format!("recordings/{slot}/file?name={name}.csv.gz&sidecar_follows=true");
    let sent = upload(address, &path, &project(&format!("{PEER}/{name}.csv.gz")));
    assert_eq!(sent.status, 200, "{}", sent.text());
    let path = format!("recordings/{slot}/sidecar?name={name}.toml");
    let read = upload(address, &path, &project(&format!("{PEER}/{name}.toml")));
    assert_eq!(read.status, 200, "{}", read.text());
    read.json()["recordings"][slot].clone()
}

/// Asks and waits for the answer.
fn asked(address: &str, kind: &str, effect: &str) -> Value {
    let question = json!({"kind": kind, "effect": effect}).to_string();
    let begun = post(address, "/api/workbench/jobs", &question);
    assert_eq!(begun.status, 200, "{}", begun.text());
    until(kind, || state(address)["job"]["running"] == false);
    let job = state(address)["job"].clone();
    assert_eq!(job["problem"], Value::Null, "{job}");
    let answer = get(address, &format!("/api/workbench/results/{kind}"));
    assert_eq!(answer.status, 200, "{}", answer.text());
    answer.json()
}

fn number(value: &Value, pointer: &str) -> f64 {
    value
        .pointer(pointer)
        .and_then(Value::as_f64)
        .expect(pointer)
}

#[test]
fn a_hidden_effect_is_found_adopted_saved_and_undone() {
    let server = Server::start(&[]);
    let address = server.address.as_str();
    let loaded = load(address, 0, "recording");
    assert_eq!(loaded["summary"]["kind"], "recording");
    assert_eq!(loaded["preview"]["columns"][0], "t");
    assert_eq!(loaded["preview"]["rows"].as_array().map(Vec::len), Some(6));
    load(address, 1, "recording_b");
    let motor = project(&format!("{PEER}/motor.toml"));
    // The panel's own motor is one for 230 V: the audit wonders until the motor is the recording's.
    assert_eq!(loaded["audit"]["supported"], false);
    let chosen = upload(address, "motor/file?name=motor.toml", &motor);
    assert_eq!(chosen.status, 200);
    assert_eq!(chosen.json()["recordings"][0]["audit"]["supported"], true);

    let compared = asked(address, "compare", "");
    assert!(number(&compared, "/result/overall/error_over_noise") > 2.0);
    let html = compared["html"].as_str().expect("HTML");
    assert!(
        html.contains("data-chart") && !html.contains(" style=\"") && !html.contains("<script")
    );
    let (from, to) = (
        number(&compared, "/result/regions/0/from_s"),
        number(&compared, "/result/regions/0/to_s"),
    );
    let traces = get(
        address,
        &format!("/api/workbench/region?from_s={from}&to_s={to}"),
    )
    .json();
    let times: Vec<f64> = serde_json::from_value(traces["t"].clone()).expect("times");
    assert!(
        times.len() > 10
            && times
                .iter()
                .all(|t| (from - 0.001..=to + 0.001).contains(t))
    );

    let explained = asked(address, "explain", "");
    assert_eq!(
        explained["result"]["next"]["adopt"],
        "magnetizing-saturation"
    );

    let adopted = asked(address, "adopt", "magnetizing-saturation");
    let held_out = |when: &str| {
        number(
            &adopted,
            &format!("/result/{when}/held_out_error_over_noise"),
        )
    };
    // 2.1 times the noise before, the noise itself after.
    assert!(held_out("before") > 1.8 && held_out("after") < 1.1);
    saved_and_undone(address, &motor);
}

fn saved_and_undone(address: &str, before: &[u8]) {
    let saved = get(address, "/api/workbench/motor.toml");
    let name = saved.header("content-disposition").expect("a name");
    assert!(name.contains("motor-magnetizing-saturation.toml"), "{name}");
    let better = MotorFile::parse(&saved.text(), "saved").expect("a motor file");
    assert_eq!(better.effects.len(), 1);
    let compared = asked(address, "compare", "");
    // Nothing is refitted: what was adopted fits the first recording.
    assert!(number(&compared, "/result/overall/error_over_noise") < 1.1);
    assert_eq!(post(address, "/api/workbench/motor/undo", "{}").status, 200);
    assert_eq!(get(address, "/api/workbench/motor.toml").body, before);
    assert_eq!(state(address)["results"], json!([]));
    assert_eq!(post(address, "/api/workbench/motor/undo", "{}").status, 422);
}

#[test]
fn what_cannot_be_read_is_said_with_file_line_and_remedy() {
    let server = Server::start(&[]);
    let address = server.address.as_str();
    let slot = |path: &str, body: &[u8]| {
        let answer = upload(address, path, body);
        assert_eq!(answer.status, 200, "{}", answer.text());
        answer.json()["recordings"][0].clone()
    };
    for (name, body, words) in [
        (
            "a.csv",
            b"t,ia,ib,ic\n0,1,2,3\n0.001,1,x,3\n".as_slice(),
            "a.csv:3: ib",
        ),
        ("b.csv", &[0, 159, 146, 150, 7], "b.csv"),
        ("c.mat", b"", "c.mat: is empty"),
        ("d.parquet", b"PAR1 and nothing", "d.parquet"),
    ] {
        let read = slot(&format!("recordings/0/file?name={name}"), body);
        let problem = read["problem"].as_str().expect("a problem");
        assert!(
            problem.starts_with(words) && read["summary"].is_null(),
            "{name}: {problem}"
        );
    }
    let missing = post(address, "/api/workbench/jobs", r#"{"kind": "compare"}"#);
    assert_eq!(missing.status, 422);
    assert!(missing.text().contains("load a recording first"));
    too_large(address);
    for body in [b"name = 3".as_slice(), &[0xff, 0xfe]] {
        let refused = upload(address, "motor/file?name=m.toml", body);
        assert_eq!(refused.status, 422);
        assert!(refused.text().contains("m.toml"), "{}", refused.text());
    }
    for path in [
        "recordings/7/file?name=a.csv",
        "recordings/x/file?name=a.csv",
        "recordings/0/file",
    ] {
        assert!(
            (400..500).contains(&upload(address, path, b"t,ia\n").status),
            "{path}"
        );
    }
}

/// The bound is said before anything is read.
fn too_large(address: &str) {
    let head = format!(
        "POST /api/workbench/recordings/0/file?name=big.csv HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\
         Content-Type: application/octet-stream\r\nContent-Length: {}\r\n\r\nt,ia\n",
        300 << 20
    );
    let answer = send(address, head.as_bytes());
    assert_eq!(answer.status, 413);
    assert!(answer.text().contains("256 MiB"), "{}", answer.text());
}

#[test]
fn foreign_columns_are_mapped_and_the_audit_speaks() {
    let server = Server::start(&["--motor", "motors/peer-2k2.toml"]);
    let address = server.address.as_str();
    // 50 Hz and 4 A, in mA and under names of its own; no voltages.
    let sample = |k: u32| {
        let t = f64::from(k) / 5000.0;
        let i = |phase: f64| 4000.0 * (314.159 * t - 2.0944 * phase).cos();
        format!("{t};{:.3};{:.3};{:.3}\n", i(0.0), i(1.0), i(2.0)).replace('.', ",")
    };
    let text: String = std::iter::once("zeit;I1;I2;I3\n".to_owned())
        .chain((0..5000).map(sample))
        .collect();
    let sent = upload(
        address,
        "recordings/0/file?name=foreign.csv",
        text.as_bytes(),
    )
    .json();
    assert!(
        sent["recordings"][0]["problem"]
            .as_str()
            .is_some_and(|words| words.starts_with("foreign.csv:1"))
    );
    let columns = json!({
        "column": {"t": "zeit", "ia": "I1", "ib": "I2", "ic": "I3"}, "unit": {"ia": "mA", "ib": "mA", "ic": "mA"},
        "delimiter": ";", "decimal_comma": true,
    });
    let read = post(
        address,
        "/api/workbench/recordings/0/mapping",
        &columns.to_string(),
    )
    .json();
    let read = &read["recordings"][0];
    assert_eq!(read["problem"], Value::Null);
    assert_eq!(
        read["preview"]["columns"],
        json!(["zeit", "I1", "I2", "I3"])
    );
    assert_eq!(read["summary"]["samples"], 5000);
    let findings = read["audit"]["findings"].as_array().expect("findings");
    assert!(
        findings
            .iter()
            .any(|finding| finding["code"] == "channel-missing"),
        "{findings:?}"
    );
    let wrong = post(
        address,
        "/api/workbench/recordings/0/mapping",
        r#"{"column": {"ia": "I9"}, "delimiter": ";"}"#,
    )
    .json();
    let problem = wrong["recordings"][0]["problem"]
        .as_str()
        .expect("a problem");
    assert!(problem.contains("I9"), "{problem}");
}

#[test]
fn uploaded_files_go_with_the_panel() {
    let server = Server::start(&[]);
    let sent = upload(
        &server.address,
        "recordings/0/file?name=only-here.csv",
        b"t,ia\n",
    );
    assert_eq!(sent.status, 200);
    let holds = || {
        Server::folders()
            .into_iter()
            .find(|folder| folder.join("recording-0/only-here.csv").exists())
    };
    let folder = holds().expect("it is kept while the panel runs");
    assert_eq!(server.interrupt(), Some(0));
    assert!(!folder.exists());
}

/// Time from sending a file to its being read.
#[test]
#[ignore = "prints a measurement: cargo test --release -p sim-host --test panel -- --ignored --nocapture"]
fn measure_opening_a_recording() {
    let server = Server::start(&[]);
    let mut text = String::from("t,va,vb,vc,ia,ib,ic,speed,torque,temperature\n");
    for k in 0..50_000 {
        let t = f64::from(k) * 1e-4;
        let wave = |phase: f64, size: f64| size * (314.159 * t - 2.0944 * phase).cos();
        let row = [
            wave(0.0, 325.0),
            wave(1.0, 325.0),
            wave(2.0, 325.0),
            wave(0.2, 6.0),
            wave(1.2, 6.0),
            wave(2.2, 6.0),
            151.3,
            9.7,
            41.5,
        ];
        let cells: Vec<String> = row.iter().map(|x| format!("{x:.4}")).collect();
        text += &format!("{t:.4},{}\n", cells.join(","));
    }
    let begin = std::time::Instant::now();
    let sent = upload(
        &server.address,
        "recordings/0/file?name=long.csv",
        text.as_bytes(),
    )
    .json();
    let took = begin.elapsed();
    println!(
        "5 s at 10 kHz with 9 channels, {:.1} MB of CSV: open after {took:.2?}",
        text.len() as f64 / 1e6
    );
    assert_eq!(
        sent["recordings"][0]["summary"]["samples"], 50_000,
        "{sent}"
    );
    assert!(took < Duration::from_secs(2), "{took:?}");
}
