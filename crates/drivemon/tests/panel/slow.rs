//! A reader that does not read.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use socket2::{Domain, Socket, Type};

use crate::http::head;
use crate::server::Server;

/// How long the slow one sleeps: at 300 windows a second far more than the channel and small buffers hold.
const ASLEEP: Duration = Duration::from_secs(4);

/// Far more than was held back for it.
const MOST_EVENTS: usize = 3_000;

/// A page's connection whose receive buffer is small.
fn connect(address: &str) -> BufReader<TcpStream> {
    let socket = Socket::new(Domain::IPV4, Type::STREAM, None).expect("a socket");
    socket.set_recv_buffer_size(4096).expect("a small buffer");
    let address: std::net::SocketAddr = address.parse().expect("an address");
    socket.connect(&address.into()).expect("it listens");
    let mut stream = TcpStream::from(socket);
    stream
        .set_read_timeout(Some(Duration::from_secs(20)))
        .expect("a time");
    let request = format!("GET /api/stream HTTP/1.1\r\nHost: {address}\r\n\r\n");
    stream.write_all(request.as_bytes()).expect("sent");
    let mut reader = BufReader::new(stream);
    assert_eq!(head(&mut reader).0, 200);
    reader
}

/// Names of events and, for windows, their sequence numbers.
fn events(reader: impl BufRead) -> impl Iterator<Item = (String, String)> {
    let mut name = String::new();
    reader
        .lines()
        .map_while(Result::ok)
        .filter_map(move |line| {
            if let Some(event) = line.strip_prefix("event: ") {
                name = event.to_owned();
            }
            let data = line.strip_prefix("data: ")?;
            Some((name.clone(), data.to_owned()))
        })
}

fn sequence(data: &str) -> u64 {
    let message: serde_json::Value = serde_json::from_str(data).expect("JSON");
    message["sequence"].as_u64().expect("a number")
}

#[test]
fn a_slow_page_loses_windows_and_is_told_and_nobody_waits_for_it() {
    let server = Server::start(&["--speed", "5"]);
    let slow = connect(&server.address);
    let quick = connect(&server.address);
    let begin = Instant::now();
    let mut seen = Vec::new();
    for (name, data) in events(quick).take_while(|_| begin.elapsed() < ASLEEP) {
        assert_ne!(name, "lost", "the quick page reads at once");
        if name == "window" {
            seen.push(sequence(&data));
        }
    }
    // Nothing is missing for the quick one, and the source went on: at least at real time, even on a busy computer.
    assert!(
        seen.windows(2).all(|pair| pair[1] == pair[0] + 1),
        "{seen:?}"
    );
    assert!(seen.len() > 240, "{} windows in {ASLEEP:?}", seen.len());
    let lost = events(slow)
        .take(MOST_EVENTS)
        .find(|(name, _)| name == "lost");
    let lost: u64 = lost.expect("it is told").1.parse().expect("a number");
    assert!(lost > 0);
}
