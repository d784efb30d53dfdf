//! Whom the server refuses, tried over a real socket.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use crate::http::{get, post, request, send};
use crate::server::{Server, refused};

const JSON: &str = "Content-Type: application/json";

#[test]
fn strangers_are_refused_and_the_own_page_is_served() {
    let server = Server::start(&[]);
    let address = server.address.as_str();
    own_page(address);
    foreign_hosts(address);
    foreign_origins(address);
    forms_of_other_sites(address);
    paths_out_of_the_table(address);
    bodies_without_bounds(address);
}

fn own_page(address: &str) {
    let page = get(address, "/");
    assert_eq!(page.status, 200);
    let policy = page.header("content-security-policy").expect("a policy");
    assert!(policy.contains("default-src 'none'") && policy.contains("script-src 'self'"));
    assert!(
        !policy.contains("unsafe") && !policy.contains('*'),
        "{policy}"
    );
    assert_eq!(page.header("x-content-type-options"), Some("nosniff"));
    assert_eq!(page.header("access-control-allow-origin"), None);
    // What the policy forbids is not there either.
    let text = page.text();
    assert!(!text.contains("<script>") && !text.contains("style=\"") && !text.contains("onclick"));
    for name in ["localhost", "[::1]"] {
        let port = address.rsplit(':').next().expect("a port");
        let host = format!("Host: {name}:{port}");
        assert_eq!(
            request(address, "GET", "/", &[&host], "").status,
            200,
            "{host}"
        );
    }
    let done = post(address, "/api/pause", "{\"paused\": false}");
    assert_eq!(done.status, 204, "{}", done.text());
}

fn foreign_hosts(address: &str) {
    let port = address.rsplit(':').next().expect("a port");
    let rebound = format!("Host: evil.example:{port}");
    let user = format!("Host: {address}@evil.example:{port}");
    let lan = format!("Host: 192.168.1.7:{port}");
    for host in [
        "Host: evil.example",
        &rebound,
        &user,
        &lan,
        "Host: localhost",
        "Host:",
    ] {
        for path in ["/", "/api/status", "/api/stream", "/nowhere"] {
            let answer = request(address, "GET", path, &[host], "");
            // An empty name is refused by the protocol already.
            assert!(
                matches!(answer.status, 400 | 421),
                "{host} {path}: {}",
                answer.status
            );
            assert!(!answer.text().contains("Assumed 300 W"), "{host} {path}");
        }
    }
    let without = send(address, b"GET / HTTP/1.1\r\nConnection: close\r\n\r\n");
    assert!(matches!(without.status, 400 | 421), "{}", without.status);
    let twice = format!("Host: {address}\r\nHost: evil.example");
    assert!(matches!(
        request(address, "GET", "/", &[&twice], "").status,
        400 | 421
    ));
    let absolute = request(
        address,
        "GET",
        &format!("http://evil.example:{port}/"),
        &[],
        "",
    );
    assert_eq!(absolute.status, 421);
}

fn foreign_origins(address: &str) {
    let port = address.rsplit(':').next().expect("a port");
    let rebound = format!("Origin: http://evil.example:{port}");
    let beside = "Origin: http://127.0.0.1:1".to_owned();
    let secure = format!("Origin: https://{address}");
    for origin in [
        "Origin: http://evil.example",
        "Origin: null",
        &rebound,
        &beside,
        &secure,
    ] {
        for (method, path) in [
            ("GET", "/api/stream"),
            ("GET", "/"),
            ("POST", "/api/pause"),
            ("OPTIONS", "/api/pause"),
        ] {
            let answer = request(address, method, path, &[origin, JSON], "{\"paused\": true}");
            assert_eq!(answer.status, 403, "{origin} {method} {path}");
            assert_eq!(answer.header("access-control-allow-origin"), None);
        }
    }
    let crossing = request(
        address,
        "POST",
        "/api/pause",
        &["Sec-Fetch-Site: cross-site", JSON],
        "{\"paused\": true}",
    );
    assert_eq!(crossing.status, 403);
    assert_eq!(get(address, "/api/status").json()["paused"], false);
}

/// What a form can send to another site without asking.
fn forms_of_other_sites(address: &str) {
    let plain = [
        "Content-Type: text/plain",
        "Content-Type: application/x-www-form-urlencoded",
        "Content-Type: multipart/form-data; boundary=x",
        "X: y",
    ];
    for kind in plain {
        let answer = request(address, "POST", "/api/pause", &[kind], "{\"paused\": true}");
        assert_eq!(answer.status, 415, "{kind}");
    }
}

fn paths_out_of_the_table(address: &str) {
    let paths = [
        "/../Cargo.toml",
        "/panel/../../../Cargo.toml",
        "/panel/%2e%2e/%2e%2e/Cargo.toml",
        "/panel/..%2f..%2fCargo.toml",
        "//etc/passwd",
        "/panel//etc/passwd",
        "/panel/..\\..\\Cargo.toml",
        "/panel/main.js%00.html",
        "/file:///etc/passwd",
        "/assets/panel/main.js",
        "/panel/messages.d.ts",
        "/panel/package.json",
        "/panel/",
        "/api/events/0/recording.csv/../../../../etc/passwd",
        "/api/export/windows.%2e%2e",
        "/api/events/99999/recording.csv",
        "/api/export/windows.exe",
    ];
    for path in paths {
        let answer = get(address, path);
        assert!(
            matches!(answer.status, 400 | 404),
            "{path}: {}",
            answer.status
        );
        assert!(
            !answer.text().contains("root:") && !answer.text().contains("[package]"),
            "{path}"
        );
    }
}

fn bodies_without_bounds(address: &str) {
    let huge = format!("{{\"faults\": [{}]}}", "0,".repeat(1 << 20));
    let answer = post(address, "/api/faults", &huge);
    assert_eq!(answer.status, 413, "{}", answer.text());
    let one = "{\"name\": \"Rs\", \"change_percent\": 1},".repeat(100);
    let many = format!("{{\"faults\": [{}]}}", one.trim_end_matches(','));
    assert_eq!(post(address, "/api/faults", &many).status, 422);
    let nonsense = [
        "",
        "{",
        "[]",
        "{\"speed\": \"x\"}",
        "{\"speed\": 1e99}",
        "{\"speed\": 0}",
        "{\"speed\": -1}",
        "{\"speed\": null}",
    ];
    for body in nonsense {
        let answer = post(address, "/api/speed", body);
        assert!(
            matches!(answer.status, 400 | 415 | 422),
            "{body}: {}",
            answer.status
        );
    }
    assert_eq!(get(address, "/api/status").json()["speed"], 1.0);
}

#[test]
fn an_address_that_others_reach_must_be_meant() {
    let (code, said) = refused(&["--host", "0.0.0.0", "--port", "0"]);
    assert_eq!(code, Some(2), "{said}");
    assert!(
        said.contains("--allow-network") && said.contains("token"),
        "{said}"
    );
    let server = open_server();
    let (port, cookie) = (server.port(), cookie_of(&server));
    let status = |host: &str| {
        let headers = [format!("Host: {host}:{port}"), format!("Cookie: {cookie}")];
        let headers = headers.each_ref().map(String::as_str);
        request(&server.address, "GET", "/", &headers, "").status
    };
    assert_eq!(status("bench.example"), 200);
    assert_eq!(status("192.168.1.7"), 200);
    assert_eq!(status("evil.example"), 421);
}

fn open_server() -> Server {
    Server::start(&[
        "--host",
        "0.0.0.0",
        "--allow-network",
        "--allow-host",
        "bench.example",
    ])
}

/// Name and value of the cookie that the printed link is exchanged for.
fn cookie_of(server: &Server) -> String {
    let url = server.url();
    let (_, query) = url.split_once('?').expect("a token in the link");
    let page = get(&server.address, &format!("/?{query}"));
    assert_eq!(page.status, 200, "{}", page.text());
    let cookie = page.header("set-cookie").expect("a cookie").to_owned();
    assert!(
        cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"),
        "{cookie}"
    );
    cookie.split(';').next().expect("a value").to_owned()
}

#[test]
fn on_a_network_nothing_is_shown_without_the_token() {
    let server = open_server();
    let address = server.address.as_str();
    let url = server.url();
    let (_, token) = url.split_once("token=").expect("a token");
    assert_eq!(token.len(), 32, "128 bits");
    let wrong = format!(
        "{}{}",
        &token[..31],
        if token.ends_with('0') { '1' } else { '0' }
    );
    let cookie = cookie_of(&server);
    let forged = cookie.replace(token, &wrong);
    for path in [
        "/",
        "/api/status",
        "/api/stream",
        "/panel/main.js",
        "/api/workbench/state",
        "/api/workbench/check/form",
        "/api/workbench/check/report.html",
        "/nowhere",
    ] {
        for shown in [
            "X: y".to_owned(),
            format!("Cookie: {forged}"),
            format!("Cookie: other={token}"),
        ] {
            let answer = request(address, "GET", path, &[&shown], "");
            assert_eq!(answer.status, 401, "{path} {shown}");
            assert!(!answer.text().contains("drivemon panel</title>"));
            assert_eq!(answer.header("set-cookie"), None);
        }
    }
    assert_eq!(get(address, &format!("/?token={wrong}")).status, 401);
    // The token opens the page and nothing else.
    assert_eq!(
        get(address, &format!("/api/status?token={token}")).status,
        401
    );
    let cookies = format!("Cookie: a=b; {cookie}");
    assert_eq!(
        request(address, "GET", "/api/status", &[&cookies], "").status,
        200
    );
    let pause = |cookie: &str| {
        request(
            address,
            "POST",
            "/api/pause",
            &[JSON, cookie],
            "{\"paused\": true}",
        )
        .status
    };
    assert_eq!((pause("X: y"), pause(&cookies)), (401, 204));
}

#[test]
fn who_says_nothing_keeps_nobody_out() {
    let server = Server::with_files(128);
    let address = server.address.as_str();
    let connect = || TcpStream::connect(address).expect("it listens");
    let mut silent: Vec<TcpStream> = (0..300).map(|_| connect()).collect();
    for stream in silent.iter_mut().skip(150) {
        // Half a request; the server may have closed it already.
        let _ = stream.write_all(b"GET / HTTP/1.1\r\nHost: ");
    }
    let begin = Instant::now();
    assert_eq!(get(address, "/").status, 200);
    assert!(
        begin.elapsed() < Duration::from_secs(3),
        "{:?}",
        begin.elapsed()
    );
    drop(silent);
    // Alone it has ten seconds for its request.
    let mut half = connect();
    half.write_all(b"GET / HTTP/1.1\r\nHost: ").expect("sent");
    half.set_read_timeout(Some(Duration::from_secs(30)))
        .expect("a time");
    let begin = Instant::now();
    // It may be told 408 first.
    let _ = half.read_to_end(&mut Vec::new());
    assert!(
        (5..20).contains(&begin.elapsed().as_secs()),
        "{:?}",
        begin.elapsed()
    );
}
