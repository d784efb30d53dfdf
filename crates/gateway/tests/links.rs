//! Every kind of link, a board that was exchanged, and one that does not answer.

mod ports;

use std::collections::HashSet;
use std::io::Write;
use std::net::TcpListener;
use std::path::Path;
use std::time::{Duration, Instant};

use board::{Frame, MAX_FRAME_BYTES, Shown};
use fleet::{Entry, GapOf, Store};
use gateway::Gateway;
use gateway::config::Config;
use gateway::simulate::{Plan, Plant, answer_line, listen};
use monitor::Report;
use serialport::{SerialPort, TTYPort};

fn plan(boards: u32, seed: u64) -> Plan {
    Plan {
        boards,
        listen: ports::free(),
        per_port: 200,
        seed,
        faulty: 0,
        faults_within_s: 60,
        restart_s: None,
    }
}

fn start(folder: &Path, links_and_motors: &str) -> Gateway {
    let text =
        format!("[gateway]\nlost_after_s = 2\n[store]\npath = \"plant.db\"\n{links_and_motors}");
    let read = Config::parse(&text, &folder.join("plant.toml"), Config::no_outputs);
    let (config, ()) = read.expect("it is accepted");
    Gateway::start(&config, &[], |line| eprintln!("{line}")).expect("it starts")
}

async fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let end = Instant::now() + Duration::from_secs(30);
    while !holds() {
        assert!(Instant::now() < end, "{what}");
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
}

fn entries(store: &Store) -> Vec<Entry> {
    let all = store.since(0, 100_000).expect("it is read");
    all.into_iter().map(|numbered| numbered.entry).collect()
}

fn seconds(store: &Store) -> Vec<(String, u32)> {
    let all = store.since(0, 100_000).expect("it is read");
    let second = |numbered: fleet::Numbered| match numbered.entry {
        Entry::Second(second) => Some((numbered.motor?.to_string(), second.number)),
        _ => None,
    };
    all.into_iter().filter_map(second).collect()
}

#[tokio::test(flavor = "current_thread")]
async fn boards_share_a_serial_line() {
    let plan = plan(3, 5);
    let mut plant = Plant::new(&plan, None).expect("a sound plan");
    let (mut far, near) = TTYPort::pair().expect("a pair of ports");
    far.set_timeout(Duration::from_millis(5))
        .expect("a timeout");
    let port = near.name().expect("a name");
    let share = plant.shares()[0].clone();
    std::thread::spawn(move || answer_line(&share, &mut far));
    (0..40).for_each(|_| plant.tick(0, 1).expect("no record"));
    let mut text = format!(
        "[[link]]\nname = \"bus\"\nkind = \"modbus-rtu\"\nport = \"{port}\"\npoll_s = 0.2\ntimeout_s = 0.3\n"
    );
    // Nobody has address 4.
    for unit in 1..=4 {
        text += &format!("[[motor]]\nname = \"m{unit}\"\nlink = \"bus\"\nunit = {unit}\n");
    }
    // It stays open: the far end of a pair of which nobody holds the near one is gone.
    let held = std::fs::OpenOptions::new()
        .read(true)
        .write(true)
        .open(&port);
    drop(near);
    let folder = tempfile::tempdir().expect("a folder");
    let gateway = start(folder.path(), &text);
    let store = gateway.store();
    until("three boards", || seconds(&store).len() == 3 * 40).await;
    (0..10).for_each(|_| plant.tick(0, 1).expect("no record"));
    until("ten seconds more", || seconds(&store).len() == 3 * 50).await;
    until("the fourth is lost", || {
        let states = store.motors().expect("it is read");
        let up = |state: &fleet::MotorState| state.link.as_ref().map(|link| link.up);
        states.iter().map(up).collect::<Vec<_>>()
            == [Some(true), Some(true), Some(true), Some(false)]
    })
    .await;
    let once: HashSet<_> = seconds(&store).into_iter().collect();
    assert_eq!(once.len(), 150);
    drop(held);
    gateway.end().await.expect("it is written");
}

#[tokio::test(flavor = "current_thread")]
async fn a_board_that_was_exchanged_is_not_mixed_with_the_one_before() {
    let plan = plan(1, 5);
    let mut plant = Plant::new(&plan, None).expect("a sound plan");
    let mut other = Plant::new(
        &Plan {
            seed: 6,
            ..plan.clone()
        },
        None,
    )
    .expect("a sound plan");
    listen(&plant, &plan).await.expect("a free port");
    // The other one has been elsewhere before.
    (0..500).for_each(|_| other.tick(0, 1).expect("no record"));
    (0..30).for_each(|_| plant.tick(0, 1).expect("no record"));
    let folder = tempfile::tempdir().expect("a folder");
    let links = plan.configuration("x").replace("[store]\npath = \"x\"", "");
    let links = links.replace("\"modbus-tcp\"", "\"modbus-tcp\"\npoll_s = 0.2");
    let gateway = start(folder.path(), &links);
    let store = gateway.store();
    until("thirty seconds", || seconds(&store).len() == 30).await;
    plant.shares()[0].exchange(&other.shares()[0]);
    until("the ring of the other", || {
        seconds(&store).len() == 30 + 120
    })
    .await;
    gateway.end().await.expect("it is written");
    let numbers: Vec<u32> = seconds(&store)
        .into_iter()
        .map(|(_, number)| number)
        .collect();
    let expected: Vec<u32> = (1..=30).chain(381..=500).collect();
    assert_eq!(numbers, expected);
    let boards = entries(&store).into_iter().filter_map(|entry| match entry {
        Entry::Board { serial, .. } => Some(serial),
        _ => None,
    });
    let expected = ["53494d000000000500000001", "53494d000000000600000001"];
    assert_eq!(boards.collect::<Vec<_>>(), expected);
    // With the first one's serial number in the configuration the other is refused.
    let links = links + "serial = \"53494d000000000500000001\"\n";
    let gateway = start(folder.path(), &links);
    other.tick(0, 1).expect("no record");
    plant.tick(0, 1).expect("no record");
    let store = gateway.store();
    until("it is refused", || {
        let states = store.motors().expect("it is read");
        let link = states[0].link.as_ref().filter(|link| !link.up);
        link.is_some_and(|link| link.why.contains("another board answers at unit 1"))
    })
    .await;
    gateway.end().await.expect("it is written");
    assert_eq!(seconds(&store).len(), 150);
}

#[tokio::test(flavor = "current_thread")]
async fn frames_over_a_network_become_seconds() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("bound");
    std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("the gateway");
        for sequence in (0..500).filter(|k| !(120..130).contains(k)) {
            let report = Report {
                sample_index: 200 * (u64::from(sequence) + 1),
                ..Report::default()
            };
            let frame = Frame::new(&report, &Shown::default(), sequence, 3_300);
            stream
                .write_all(frame.encode(&mut [0; MAX_FRAME_BYTES]))
                .expect("it is read");
        }
        std::thread::sleep(Duration::from_secs(30));
    });
    let folder = tempfile::tempdir().expect("a folder");
    let text = format!(
        "[[link]]\nname = \"bench\"\nkind = \"frames-tcp\"\naddress = \"{address}\"\n[[motor]]\nname = \"m\"\nlink = \"bench\"\n"
    );
    let gateway = start(folder.path(), &text);
    let store = gateway.store();
    // The tenth second is under way.
    until("nine seconds", || seconds(&store).len() == 9).await;
    gateway.end().await.expect("it is written");
    let mut windows = Vec::new();
    let mut gaps = Vec::new();
    for entry in entries(&store) {
        match entry {
            Entry::Second(second) => windows.push((second.number, second.windows)),
            Entry::Gap(gap) => gaps.push((gap.what, gap.first, gap.last)),
            _ => {}
        }
    }
    assert_eq!(windows[..4], [(1, 50), (2, 50), (3, 40), (4, 50)]);
    assert_eq!(gaps, [(GapOf::Frames, 120, 129)]);
}
