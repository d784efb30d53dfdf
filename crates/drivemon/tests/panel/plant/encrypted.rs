//! The page on a network: TLS with a real client, and what is refused without it.

use std::path::Path;
use std::process::Command;

use super::processes::Plant;
use crate::server::{Server, refused};

/// An authority of the plant's own, and a certificate of it for this computer.
fn certificates(folder: &Path) {
    let steps = [
        "req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -keyout ca.key -out ca.pem -days 2 -subj /CN=plant",
        "req -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -keyout page.key -out page.csr -subj /CN=page",
        "x509 -req -in page.csr -CA ca.pem -CAkey ca.key -CAcreateserial -days 2 -extfile names.txt -out page.pem",
    ];
    std::fs::write(folder.join("names.txt"), "subjectAltName=IP:127.0.0.1").expect("written");
    for step in steps {
        let done = Command::new("openssl")
            .args(step.split(' '))
            .current_dir(folder)
            .output()
            .expect("openssl is installed");
        let said = String::from_utf8_lossy(&done.stderr);
        assert!(done.status.success(), "openssl {step}: {said}");
    }
}

/// Exit code of curl, status and body.
fn curl(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let done = Command::new("curl")
        .args([
            "--silent",
            "--max-time",
            "20",
            "--write-out",
            "\n%{http_code}",
        ])
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("curl is installed");
    let text = String::from_utf8_lossy(&done.stdout).into_owned();
    let (body, status) = text.rsplit_once('\n').expect("a status");
    (done.status.code(), status.to_owned(), body.to_owned())
}

/// curl: the other end did not speak as it should; the certificate is not believed.
const NOTHING_CAME: [i32; 3] = [1, 52, 56];
const NOT_BELIEVED: i32 = 60;

#[test]
fn on_a_network_everything_is_encrypted_and_asks_for_a_token() {
    let plant = Plant::start(2, 0, 1);
    let folder = plant.file("");
    certificates(&folder);
    let token = plant.token("Prometheus", "see");
    let [configuration, certificate, key] =
        ["plant.toml", "page.pem", "page.key"].map(|name| plant.file(name).display().to_string());
    let on_a_network = [
        "--fleet",
        &configuration,
        "--host",
        "0.0.0.0",
        "--allow-network",
    ];
    let (code, said) = refused(&on_a_network);
    assert!(
        code == Some(2) && said.contains("--tls-cert"),
        "{code:?}: {said}"
    );
    let with_tls = ["--tls-cert", &certificate, "--tls-key", &key];
    let server = Server::start(&[&on_a_network[..], &with_tls].concat());
    assert!(server.url().starts_with("https://"), "{}", server.url());
    let url = format!("https://{}/metrics", server.address);
    let bearer = format!("Authorization: Bearer {token}");
    let believed = ["--cacert", "ca.pem"];
    let ask = |arguments: &[&str]| curl(&folder, arguments);
    let (code, ..) = ask(&[&url]);
    assert_eq!(code, Some(NOT_BELIEVED), "a stranger's certificate");
    let (_, status, _) = ask(&[&believed[..], &[&url]].concat());
    assert_eq!(status, "401");
    let (_, status, metrics) = ask(&[&believed[..], &["--header", &bearer, &url]].concat());
    assert_eq!(status, "200");
    assert!(metrics.contains("\ndrivemon_motors 2\n"), "{metrics}");
    let plain = format!("http://{}/metrics", server.address);
    let (code, status, _) = ask(&[&plain]);
    assert!(
        status == "000" && code.is_some_and(|code| NOTHING_CAME.contains(&code)),
        "{code:?} {status}"
    );
    let page = format!("https://{}/", server.address);
    let foreign = ["--header", "Origin: http://127.0.0.1", &page];
    let (_, status, _) = ask(&[&believed[..], &foreign].concat());
    assert_eq!(status, "403", "a page of another scheme");
    let mine = format!("Origin: https://{}", server.address);
    let (_, status, _) = ask(&[&believed[..], &["--header", &mine, &page]].concat());
    assert_eq!(status, "200");
}

#[test]
fn files_that_are_no_certificate_are_named_with_the_remedy() {
    let plant = Plant::start(1, 0, 1);
    certificates(&plant.file(""));
    let path = |name: &str| plant.file(name).display().to_string();
    let start = |certificate: &str, key: &str| {
        let plant = path("plant.toml");
        let (certificate, key) = (path(certificate), path(key));
        refused(&[
            "--fleet",
            &plant,
            "--tls-cert",
            &certificate,
            "--tls-key",
            &key,
        ])
    };
    for (certificate, key, words) in [
        ("none.pem", "page.key", "--tls-cert"),
        ("names.txt", "page.key", "holds no certificate in PEM"),
        ("page.pem", "names.txt", "--tls-key"),
        ("page.pem", "ca.key", "both must come from the same request"),
    ] {
        let (code, said) = start(certificate, key);
        assert_eq!(code, Some(2), "{said}");
        assert!(said.contains(words), "{said}");
    }
}
