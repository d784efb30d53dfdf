//! Boards that are not who they should be, and bytes that no board sends: refused, counted, and nothing of the others is lost.

mod ports;

use std::io::Write;
use std::net::TcpListener;
use std::path::Path;
use std::time::{Duration, Instant};

use board::{Frame, MAX_FRAME_BYTES, Shown};
use fleet::{Entry, Store};
use gateway::config::Config;
use gateway::simulate::{Plan, Plant, listen};
use gateway::{Gateway, StartError};
use monitor::Report;

/// Boards of healthy motors.
fn plan(boards: u32) -> Plan {
    Plan {
        boards,
        listen: ports::free(),
        per_port: 200,
        seed: 9,
        faulty: 0,
        faults_within_s: 60,
        restart_s: None,
    }
}

fn try_start(folder: &Path, text: &str) -> Result<Gateway, StartError> {
    let read = Config::parse(text, &folder.join("plant.toml"), Config::no_outputs);
    let (config, ()) = read.expect("it is accepted");
    Gateway::start(&config, &[], |line| eprintln!("{line}"))
}

fn start(folder: &Path, text: &str) -> Gateway {
    try_start(folder, text).expect("it starts")
}

async fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let end = Instant::now() + Duration::from_secs(30);
    while !holds() {
        assert!(Instant::now() < end, "{what}");
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
}

/// Numbers of the seconds of a motor.
fn seconds(store: &Store, motor: &str) -> Vec<u32> {
    let all = store.since(0, 100_000).expect("it is read").into_iter();
    let own = all.filter(|entry| entry.motor.as_ref().is_some_and(|id| id.as_str() == motor));
    own.filter_map(|numbered| match numbered.entry {
        Entry::Second(second) => Some(second.number),
        _ => None,
    })
    .collect()
}

/// A gateway that somebody starts beside a running one, to try something, takes nothing from it.
#[tokio::test(flavor = "current_thread")]
async fn a_second_gateway_is_refused_and_the_first_goes_on() {
    let plan = plan(1);
    let mut plant = Plant::new(&plan, None).expect("a sound plan");
    listen(&plant, &plan).await.expect("a free port");
    let folder = tempfile::tempdir().expect("a folder");
    let text = plan.configuration("plant.db");
    let first = start(folder.path(), &text);
    let second = try_start(folder.path(), &text);
    let why = second.err().expect("it is refused").to_string();
    assert!(
        why.contains("plant.db") && why.contains("end it first"),
        "{why}"
    );
    let store = first.store();
    (0..20).for_each(|_| plant.tick(0, 1).expect("nothing is written"));
    until("the board's seconds", || {
        seconds(&store, "m00001").len() == 20
    })
    .await;
    first.end().await.expect("it is written");
    let third = start(folder.path(), &text);
    third.end().await.expect("it is written");
}

/// A second board answers at the address of a motor whose board is known by its serial number.
#[tokio::test(flavor = "current_thread")]
async fn a_board_under_a_forged_address_is_refused() {
    let plan = plan(2);
    let mut plant = Plant::new(&plan, None).expect("a sound plan");
    listen(&plant, &plan).await.expect("a free port");
    let folder = tempfile::tempdir().expect("a folder");
    let known = "serial = \"0123456789abcdef01234567\"\nunit = 1\n";
    let text = plan.configuration("plant.db").replace("unit = 1\n", known);
    let gateway = start(folder.path(), &text);
    let store = gateway.store();
    (0..20).for_each(|_| plant.tick(0, 1).expect("nothing is written"));
    until("the other board's seconds", || {
        seconds(&store, "m00002").len() == 20
    })
    .await;
    let states = store.motors().expect("they are read");
    let why = &states[0].link.as_ref().expect("it is told").why;
    assert!(why.contains("another board answers"), "{why}");
    assert!(seconds(&store, "m00001").is_empty());
    let counts = gateway.end().await.expect("it is written");
    assert!(counts.failures > 0 && counts.up == 1, "{counts:?}");
}

/// A megabyte without the end of a frame, then a frame that is too long, then a board.
#[tokio::test(flavor = "current_thread")]
async fn frames_without_an_end_are_dropped_and_counted() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("bound");
    std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("the gateway");
        for piece in [vec![7; 1 << 20], vec![0], [&[9; 300][..], &[0]].concat()] {
            stream.write_all(&piece).expect("it is read");
        }
        for sequence in 0..160 {
            let report = Report {
                sample_index: 200 * (u64::from(sequence) + 1),
                ..Report::default()
            };
            let frame = Frame::new(&report, &Shown::default(), sequence, 3_300);
            let bytes = frame.encode(&mut [0; MAX_FRAME_BYTES]).to_vec();
            stream.write_all(&bytes).expect("it is read");
        }
        std::thread::sleep(Duration::from_secs(30));
    });
    let folder = tempfile::tempdir().expect("a folder");
    let text = format!(
        "[store]\npath = \"plant.db\"\n[[link]]\nname = \"bench\"\nkind = \"frames-tcp\"\naddress = \"{address}\"\n[[motor]]\nname = \"m\"\nlink = \"bench\"\n"
    );
    let gateway = start(folder.path(), &text);
    let store = gateway.store();
    until("three seconds", || seconds(&store, "m") == [1, 2, 3]).await;
    let counts = gateway.end().await.expect("it is written");
    assert!(counts.damaged_frames > 2, "{counts:?}");
}
