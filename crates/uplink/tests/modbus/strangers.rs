//! Masters that are too many, too slow, or no masters: turned away and counted; the others are served all the while.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::time::{Duration, Instant};

use fleet::{Limits, MotorInfo, Store};
use tokio::sync::watch;
use uplink::modbus::{ModbusConfig, ModbusState, ModbusStatus, run};

struct Server {
    address: SocketAddr,
    status: ModbusStatus,
    stop: watch::Sender<bool>,
    thread: Option<std::thread::JoinHandle<()>>,
    _folder: tempfile::TempDir,
}

impl Server {
    fn start(connections: u32) -> Server {
        let folder = tempfile::tempdir().expect("a folder");
        let store =
            Store::open(&folder.path().join("plant.db"), &Limits::default()).expect("a new store");
        let motors = [MotorInfo::new("pump-1".parse().expect("a name"))];
        store.declare(&motors).expect("a writable folder");
        let free = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let address = free.local_addr().expect("it is bound");
        drop(free);
        let mut config = ModbusConfig::new(address);
        config.connections = connections;
        let (stop, stopped) = watch::channel(false);
        let status = ModbusStatus::default();
        let counted = status.clone();
        let thread = std::thread::spawn(move || {
            let runtime = tokio::runtime::Builder::new_multi_thread()
                .worker_threads(1)
                .enable_all()
                .build()
                .expect("a runtime");
            runtime
                .block_on(run(config, Arc::new(store), counted, stopped))
                .expect("a free port");
        });
        Server {
            address,
            status,
            stop,
            thread: Some(thread),
            _folder: folder,
        }
    }

    fn master(&self) -> TcpStream {
        let until = Instant::now() + Duration::from_secs(20);
        loop {
            match TcpStream::connect(self.address) {
                Ok(stream) => {
                    stream
                        .set_read_timeout(Some(Duration::from_secs(20)))
                        .expect("a timeout");
                    return stream;
                }
                Err(error) => assert!(Instant::now() < until, "{error}"),
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    fn wait(&self, what: &str, holds: impl Fn(ModbusState) -> bool) {
        let until = Instant::now() + Duration::from_secs(20);
        while !holds(self.status.get()) {
            assert!(Instant::now() < until, "{what}: {:?}", self.status.get());
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.stop.send(true);
        if let Some(thread) = self.thread.take() {
            let ended = thread.join();
            assert!(
                ended.is_ok() || std::thread::panicking(),
                "the server panicked"
            );
        }
    }
}

const MAP_VERSION: [u8; 12] = [0, 1, 0, 0, 0, 6, 1, 4, 0, 0, 0, 1];

fn is_served(stream: &mut TcpStream) {
    stream.write_all(&MAP_VERSION).expect("an open line");
    let mut answer = [0; 11];
    stream.read_exact(&mut answer).expect("an answer");
    assert_eq!(answer, [0, 1, 0, 0, 0, 5, 1, 4, 2, 0, 1]);
}

fn is_closed(stream: &mut TcpStream) {
    let mut rest = Vec::new();
    // A line with bytes that nobody read is reset.
    let _ = stream.read_to_end(&mut rest);
    assert!(rest.is_empty(), "{rest:?}");
}

#[test]
fn what_is_no_modbus_is_closed_and_counted() {
    let server = Server::start(8);
    let mut good = server.master();
    is_served(&mut good);
    for junk in [
        &b"GET / HTTP/1.1\r\n\r\n"[..],
        &[0, 1, 0, 0, 0xFF, 0xFF, 1, 4],
        &[0, 1, 0, 0, 0, 1, 1, 4],
        &[7; 600],
    ] {
        let mut stream = server.master();
        stream.write_all(junk).expect("an open line");
        is_closed(&mut stream);
    }
    server.wait("broken lines", |state| state.broken == 4);
    is_served(&mut good);
    server.wait("answers", |state| state.answered == 2);
}

#[test]
fn a_master_too_many_is_turned_away() {
    let server = Server::start(1);
    let mut good = server.master();
    is_served(&mut good);
    is_closed(&mut server.master());
    server.wait("a refusal", |state| state.refused_connections == 1);
    is_served(&mut good);
}

#[test]
fn half_a_request_is_waited_for_and_then_closed() {
    let server = Server::start(2);
    let mut slow = server.master();
    slow.write_all(&MAP_VERSION[..7]).expect("an open line");
    let mut good = server.master();
    is_served(&mut good);
    server.wait("a slow master", |state| state.slow == 1);
    is_closed(&mut slow);
    is_served(&mut good);
}

/// Many requests at once, in pieces that fit none of them.
#[test]
fn requests_may_come_in_any_pieces() {
    let server = Server::start(1);
    let mut stream = server.master();
    let requests = MAP_VERSION.repeat(50);
    for piece in requests.chunks(7) {
        stream.write_all(piece).expect("an open line");
    }
    let mut answers = vec![0; 11 * 50];
    stream.read_exact(&mut answers).expect("answers");
    assert!(
        answers
            .chunks(11)
            .all(|answer| answer == [0, 1, 0, 0, 0, 5, 1, 4, 2, 0, 1])
    );
}
