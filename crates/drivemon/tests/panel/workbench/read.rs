//! What a file holds is read, mapped and audited, or refused with place and remedy.

use std::io::Write;
use std::time::Duration;

use serde_json::{Value, json};

use super::upload;
use super::uploads::too_large;
use crate::http::post;
use crate::server::Server;

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
