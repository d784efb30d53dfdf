//! The workbench over HTTP, by story; here, what they share.

mod better;
mod check;
mod read;
mod uploads;

use serde_json::{Value, json};

use crate::http::{Answer, get, post, send};
use crate::life::until;
use crate::server::root;

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
