//! The workbench over HTTP: from two recordings to a better motor file, and everything that is refused.

use std::io::{Read, Write};
use std::net::TcpStream;
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
    let id = &sent.json()["recordings"][slot]["id"];
    let path = format!("recordings/{slot}/sidecar?name={name}.toml&id={id}");
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
    let text: String = std::iter::once("laufnr;kanalx;kanaly;kanalz\n".to_owned())
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
        "column": {"t": "laufnr", "ia": "kanalx", "ib": "kanaly", "ic": "kanalz"}, "unit": {"ia": "mA", "ib": "mA", "ic": "mA"},
        "delimiter": ";", "decimal_comma": true,
    });
    let mapping = format!(
        "/api/workbench/recordings/0/mapping?id={}",
        sent["recordings"][0]["id"]
    );
    let read = post(address, &mapping, &columns.to_string()).json();
    let read = &read["recordings"][0];
    assert_eq!(read["problem"], Value::Null);
    assert_eq!(
        read["preview"]["columns"],
        json!(["laufnr", "kanalx", "kanaly", "kanalz"])
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
        &mapping,
        r#"{"column": {"ia": "I9"}, "delimiter": ";"}"#,
    )
    .json();
    let problem = wrong["recordings"][0]["problem"]
        .as_str()
        .expect("a problem");
    assert!(problem.contains("I9"), "{problem}");
}

#[test]
fn uploaded_files_go_with_the_panel_however_it_is_ended() {
    for signal in ["INT", "TERM"] {
        let server = Server::start(&[]);
        let name = format!("only-here-{signal}.csv");
        let path = format!("recordings/0/file?name={name}");
        let sent = upload(&server.address, &path, b"t,ia\n");
        assert_eq!(sent.status, 200, "{}", sent.text());
        let folder = Server::folders().into_iter().find(|folder| {
            let places = std::fs::read_dir(folder).into_iter().flatten().flatten();
            places
                .into_iter()
                .any(|place| place.path().join(&name).exists())
        });
        let folder = folder.expect("it is kept while the panel runs");
        assert_eq!(server.ended_by(signal), Some(0), "{signal}");
        assert!(!folder.exists(), "{signal}");
    }
}

const TINY: &[u8] = b"t,ia,ib,ic\n0,1,-0.5,-0.5\n0.001,1,-0.5,-0.5\n0.002,1,-0.5,-0.5\n";

#[test]
fn a_refused_upload_leaves_what_lay_there() {
    let server = Server::start(&[]);
    let address = server.address.as_str();
    assert_eq!(
        upload(address, "recordings/0/file?name=kept.csv", TINY).status,
        200
    );
    too_large(address);
    // A page that goes away in the middle of its file.
    let mut broken = TcpStream::connect(address).expect("it listens");
    broken
        .write_all(&[upload_head(address, 1000).as_bytes(), b"t,ia"].concat())
        .expect("sent");
    drop(broken);
    let kept = || state(address)["recordings"][0].clone();
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(kept()["name"], "kept.csv");
    let id = kept()["id"].clone();
    let mapping = format!("/api/workbench/recordings/0/mapping?id={id}");
    // It can still be read.
    assert_eq!(
        post(address, &mapping, r#"{"sample_rate_hz": 1000}"#).status,
        200
    );
    let removed = post(address, "/api/workbench/recordings/0/remove?id=999", "{}");
    assert_eq!(removed.status, 409);
    assert_eq!(kept()["name"], "kept.csv");
}

fn upload_head(address: &str, bytes: usize) -> String {
    format!(
        "POST /api/workbench/recordings/0/file?name=slow.csv HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\n\
         Connection: close\r\nContent-Type: application/octet-stream\r\nContent-Length: {bytes}\r\n\r\n"
    )
}

#[test]
fn two_pages_do_not_take_each_others_place() {
    let server = Server::start(&[]);
    let address = server.address.as_str();
    // The first one is slow: half of its file is there when the second one loads its own.
    let mut slow = TcpStream::connect(address).expect("it listens");
    slow.write_all(&[upload_head(address, TINY.len()).as_bytes(), &TINY[..20]].concat())
        .expect("sent");
    std::thread::sleep(Duration::from_millis(300));
    let quick = upload(
        address,
        "recordings/0/file?name=quick.csv&sidecar_follows=true",
        TINY,
    );
    assert_eq!(quick.status, 200);
    slow.write_all(&TINY[20..]).expect("sent");
    let mut answer = String::new();
    slow.read_to_string(&mut answer).expect("an answer");
    assert!(
        answer.starts_with("HTTP/1.1 409") && answer.contains("another page"),
        "{answer}"
    );
    assert_eq!(state(address)["recordings"][0]["name"], "quick.csv");
    // A sidecar says which recording it belongs to.
    let foreign = upload(address, "recordings/0/sidecar?name=slow.toml&id=77", b"");
    assert_eq!(foreign.status, 409, "{}", foreign.text());
    let id = &quick.json()["recordings"][0]["id"];
    let own = upload(
        address,
        &format!("recordings/0/sidecar?name=quick.toml&id={id}"),
        b"",
    );
    assert_eq!(own.status, 200, "{}", own.text());
}

/// Sixty million rows of three cells in a few hundred kilobytes.
fn bomb() -> Vec<u8> {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    packed.write_all(b"t,ia,ib,ic\n").expect("in memory");
    let rows = b"0,1,2,3\n".repeat(1 << 17);
    (0..400).for_each(|_| packed.write_all(&rows).expect("in memory"));
    packed.finish().expect("in memory")
}

#[test]
fn what_unpacks_without_bounds_is_refused_while_it_is_read() {
    let server = Server::start(&[]);
    let packed = bomb();
    assert!(packed.len() < 2_000_000, "{}", packed.len());
    let sent: Vec<_> = (0..2)
        .map(|slot| {
            let (address, packed) = (server.address.clone(), packed.clone());
            std::thread::spawn(move || {
                upload(
                    &address,
                    &format!("recordings/{slot}/file?name=bomb.csv.gz"),
                    &packed,
                )
                .json()
            })
        })
        .collect();
    for (slot, sent) in sent.into_iter().enumerate() {
        let problem = sent.join().expect("an answer")["recordings"][slot]["problem"].clone();
        assert!(
            problem
                .as_str()
                .is_some_and(|words| words.contains("50000000 numbers")),
            "{problem}"
        );
    }
    if let Some(bytes) = server.largest_memory() {
        println!("largest memory: {} MB", bytes / 1_000_000);
        assert!(bytes < 1_500_000_000, "{bytes}");
    }
}

/// Time from sending a file to its being read.
#[test]
#[ignore = "prints a measurement: cargo test --release -p drivemon --test panel -- --ignored --nocapture"]
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

/// What `drivemon check` says of the same plate and recording.
fn told_by_the_command(plate: &Value) -> Value {
    let flags = plate.as_object().expect("a plate").iter();
    let flags = flags.flat_map(|(key, text)| {
        let text = text.as_str().expect("a text").to_owned();
        [format!("--{}", key.replace('_', "-")), text]
    });
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .current_dir(root())
        .args(["check", &format!("{PEER}/recording.csv.gz"), "--json", "-"])
        .args(flags)
        .output()
        .expect("it runs");
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    answer["recordings"][0]["told"].clone()
}

/// A check over HTTP: what is missing is named, and the answer is the command's own.
#[test]
fn a_check_needs_a_plate_and_waveforms() {
    let server = Server::start(&[]);
    let address = server.address.as_str();
    let question = json!({"kind": "check", "healthy": "none"}).to_string();
    let ask = || post(address, "/api/workbench/jobs", &question);
    let without = ask();
    assert_eq!(without.status, 422);
    assert!(without.text().contains("nameplate"), "{}", without.text());
    let plate = |plate: Value| post(address, "/api/workbench/check/plate", &plate.to_string());
    let refused = plate(json!({"power_kw": "2.2 kW", "voltage_volt": "400"}));
    assert_eq!(refused.status, 422);
    assert_eq!(refused.json()["problems"][0]["key"], "power_kw");
    let numbers = json!({"name": "Pump 3", "power_kw": "2.2", "voltage_volt": "400", "frequency_hz": "50", "speed_rpm": "1438", "current_amp": "4.78"});
    let taken = plate(numbers.clone());
    assert_eq!(taken.status, 200, "{}", taken.text());
    assert_eq!(taken.json()["check"]["by_plate"], true);
    assert_eq!(taken.json()["motor"]["file"], "pump-3.toml");
    assert!(ask().text().contains("load a recording first"));
    let table = project("tests/data/imc_18k5_load_test/load_test.csv");
    assert_eq!(
        upload(address, "recordings/0/file?name=table.csv", &table).status,
        200
    );
    assert!(ask().text().contains("load table"));
    assert_eq!(get(address, "/api/workbench/check/report.html").status, 404);
    let id = state(address)["recordings"][0]["id"].clone();
    let gone = post(
        address,
        &format!("/api/workbench/recordings/0/remove?id={id}"),
        "{}",
    );
    assert_eq!(gone.status, 200);
    load(address, 0, "recording");
    let shown = asked(address, "check", "");
    assert_eq!(shown["result"]["known_by"], "known by its plate alone");
    assert_eq!(
        shown["result"]["recordings"][0]["told"],
        told_by_the_command(&numbers)
    );
    let state_of = &shown["result"]["recordings"][0]["told"]["state"];
    assert!(
        state_of.is_string()
            && shown["html"]
                .as_str()
                .is_some_and(|html| html.contains("What to do"))
    );
    let report = get(address, "/api/workbench/check/report.html");
    assert_eq!(report.status, 200);
    assert!(report.text().contains(state_of.as_str().expect("words")));
    // Another motor file is another motor: its first check begins anew.
    let motor = project(&format!("{PEER}/motor.toml"));
    let other = upload(address, "motor/file?name=motor.toml", &motor);
    assert_eq!(other.json()["check"], Value::Null);
}
