//! HTTP by hand: a test must be able to send what no client library would.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Longest wait for an answer.
const PATIENCE: Duration = Duration::from_secs(90);

/// Status, headers and body of an answer.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub headers: Vec<(String, String)>,
    pub body: Vec<u8>,
}

impl Answer {
    /// A header by its lower-case name.
    pub fn header(&self, name: &str) -> Option<&str> {
        let found = self.headers.iter().find(|(known, _)| known == name);
        found.map(|(_, value)| value.as_str())
    }

    /// The body as text.
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    /// The body as JSON.
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.body)
            .unwrap_or_else(|error| panic!("{error}: {}", self.text()))
    }
}

/// Sends these very bytes and reads the answer to its end.
pub fn send(address: &str, request: &[u8]) -> Answer {
    let mut stream = TcpStream::connect(address).expect("it listens");
    stream.set_read_timeout(Some(PATIENCE)).expect("a time");
    // A server that refuses early may close before all was sent.
    let _ = stream.write_all(request);
    let mut reader = BufReader::new(stream);
    let (status, headers) = head(&mut reader);
    let body = body(&mut reader);
    Answer {
        status,
        headers,
        body,
    }
}

/// The body, or what came of it in time: a stream of events never ends.
fn body(reader: &mut impl Read) -> Vec<u8> {
    let end = Instant::now() + PATIENCE;
    let (mut body, mut piece) = (Vec::new(), [0; 1 << 16]);
    while Instant::now() < end {
        match reader.read(&mut piece) {
            Ok(0) | Err(_) => break,
            Ok(length) => body.extend_from_slice(&piece[..length]),
        }
    }
    body
}

/// Status and headers; the reader then stands at the body.
pub fn head(reader: &mut impl BufRead) -> (u16, Vec<(String, String)>) {
    let mut line = String::new();
    reader.read_line(&mut line).expect("a status line");
    let status = line.split(' ').nth(1).and_then(|code| code.parse().ok());
    let mut headers = Vec::new();
    loop {
        line.clear();
        let length = reader.read_line(&mut line).expect("headers");
        let Some((name, value)) = line.trim_end().split_once(':').filter(|_| length > 0) else {
            return (status.unwrap_or(0), headers);
        };
        headers.push((name.to_lowercase(), value.trim().to_owned()));
    }
}

/// A request with further header lines.
pub fn request(address: &str, method: &str, path: &str, headers: &[&str], body: &str) -> Answer {
    let mut lines = vec![
        format!("{method} {path} HTTP/1.1"),
        "Connection: close".into(),
    ];
    if !headers.iter().any(|header| header.starts_with("Host:")) {
        lines.push(format!("Host: {address}"));
    }
    lines.extend(headers.iter().map(|header| (*header).to_owned()));
    if !body.is_empty() {
        lines.push(format!("Content-Length: {}", body.len()));
    }
    send(
        address,
        format!("{}\r\n\r\n{body}", lines.join("\r\n")).as_bytes(),
    )
}

/// Asks for a page as a browser would that was given the printed address.
pub fn get(address: &str, path: &str) -> Answer {
    request(address, "GET", path, &[], "")
}

/// Sends JSON as the page does.
pub fn post(address: &str, path: &str, body: &str) -> Answer {
    let origin = format!("Origin: http://{address}");
    request(
        address,
        "POST",
        path,
        &["Content-Type: application/json", &origin],
        body,
    )
}
