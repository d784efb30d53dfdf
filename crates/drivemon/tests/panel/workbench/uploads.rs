//! Uploads that break off, meet each other or are too large, and how long they are kept.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use super::{state, upload};
use crate::http::{post, send};
use crate::server::Server;

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

/// The bound is said before anything is read.
pub(super) fn too_large(address: &str) {
    let head = format!(
        "POST /api/workbench/recordings/0/file?name=big.csv HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\
         Content-Type: application/octet-stream\r\nContent-Length: {}\r\n\r\nt,ia\n",
        300 << 20
    );
    let answer = send(address, head.as_bytes());
    assert_eq!(answer.status, 413);
    assert!(answer.text().contains("256 MiB"), "{}", answer.text());
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
