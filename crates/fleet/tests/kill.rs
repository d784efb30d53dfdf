//! `kill -9` at random moments: what was acknowledged is there, once.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use fleet::alarm::{Change, Rules, Watch};
use fleet::{BoardEvent, Entry, Limits, MotorId, MotorInfo, Second, Store};
use rand::{Rng, SeedableRng};

/// Names the store to the child.
const STORE: &str = "FLEET_KILLED_STORE";
const MOTORS: usize = 8;
const BEGIN: i64 = 1_789_948_800_000;
/// FAULT is lit for so many seconds, then dark for as many.
const HALF: u32 = 20;

fn motors() -> Vec<MotorId> {
    (0..MOTORS)
        .map(|k| format!("m{k}").parse().unwrap())
        .collect()
}

/// The delays are off, so that each flank of the lamp is a change of the alarm.
fn rules() -> Rules {
    Rules {
        off_delay_ms: 0,
        flood_alarms: 1000,
        ..Rules::default()
    }
}

fn lit(number: u32) -> bool {
    (number / HALF) % 2 == 1
}

fn second(number: u32) -> Entry {
    let lamps = if lit(number) { 1 << 16 } else { 0 };
    let time_ms = BEGIN + i64::from(number) * 1000;
    let speed_rpm = Some(number as f32);
    Entry::Second(Second {
        start: 1,
        number,
        time_ms,
        lamps,
        judged: 1,
        windows: 1,
        speed_rpm,
        ..Second::default()
    })
}

fn event(number: u32) -> Entry {
    Entry::Event(BoardEvent {
        number,
        time_ms: BEGIN,
        cause: 12,
        times: 1,
        values: [number, 0],
    })
}

fn open(path: &Path) -> Store {
    let store = Store::open(path, &Limits::default()).unwrap();
    let infos: Vec<_> = motors().into_iter().map(MotorInfo::new).collect();
    store.declare(&infos).unwrap();
    store.declare_sinks(&["output"]).unwrap();
    store
}

/// What comes after what is durable: five seconds and an event of each motor.
fn next(store: &Store) -> (u32, Vec<(MotorId, Entry)>) {
    let mut batch = Vec::new();
    for motor in motors() {
        let (from, event_before) = (last(store, &motor), store.last_event(&motor).unwrap());
        batch.extend((from + 1..=from + 5).map(|number| (motor.clone(), second(number))));
        batch.push((motor, event(event_before + 1)));
    }
    (last(store, &motors()[0]) + 5, batch)
}

/// Newest second that is durable.
fn last(store: &Store, motor: &MotorId) -> u32 {
    store
        .last_second(motor)
        .unwrap()
        .map_or(0, |(_, number)| number)
}

/// Without a harness: the same program is the test, and the process that it kills.
fn main() {
    match std::env::var_os(STORE) {
        Some(path) => store_for_ever(Path::new(&path)),
        None => a_process_that_is_killed_twenty_times_loses_nothing_and_stores_nothing_twice(),
    }
}

/// The process that is killed. It says a number only when the number is durable.
fn store_for_ever(path: &Path) -> ! {
    let (store, watch) = (open(path), Watch::new(rules()));
    let mut round = 0_u32;
    loop {
        let (number, batch) = next(&store);
        store.append(&batch).unwrap();
        println!("stored {number}");
        std::io::stdout().flush().unwrap();
        watch.work(&store, BEGIN).unwrap();
        let cursor = store.cursor("output").unwrap();
        if let Some(last) = store.since(cursor, 100).unwrap().last() {
            store.set_cursor("output", last.id).unwrap();
        }
        if round % 7 == 6 {
            store.seal().unwrap();
            store.maintain(BEGIN).unwrap();
        }
        round = round.wrapping_add(1);
    }
}

/// Lets the child run for a random while, kills it; the last number it said.
fn killed(mut child: Child, while_ms: u64) -> u32 {
    let lines = BufReader::new(child.stdout.take().unwrap())
        .lines()
        .map_while(Result::ok);
    let reader = std::thread::spawn(move || {
        let stored = lines.filter_map(|line| line.strip_prefix("stored ")?.parse::<u32>().ok());
        stored.last().unwrap_or(0)
    });
    std::thread::sleep(Duration::from_millis(while_ms));
    // SIGKILL.
    child.kill().unwrap();
    child.wait().unwrap();
    reader.join().unwrap()
}

fn a_process_that_is_killed_twenty_times_loses_nothing_and_stores_nothing_twice() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plant.db");
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(23);
    let mut said = 0;
    for _ in 0..20 {
        let child = Command::new(std::env::current_exe().unwrap())
            .env(STORE, &path)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        said = said.max(killed(child, rng.random_range(20..400)));
        if path.exists() {
            check(&open(&path), said);
        }
    }
    assert!(said > 100, "the processes stored hardly anything: {said}");
    // What the alarms had not read yet they read now.
    let store = open(&path);
    Watch::new(rules()).work(&store, BEGIN).unwrap();
    check_alarms(&store);
}

fn check(store: &Store, said: u32) {
    let numbered = store.since(0, usize::MAX >> 1).unwrap();
    assert!(numbered.windows(2).all(|two| two[0].id < two[1].id));
    for motor in motors() {
        let last = last(store, &motor);
        assert!(last >= said, "{said} was acknowledged, {last} is there");
        let end = BEGIN + i64::from(last + 1) * 1000;
        let trend = store.trend(&motor, BEGIN, end, last as usize + 1).unwrap();
        let found: Vec<_> = trend
            .points
            .iter()
            .map(|p| (p.from_ms, p.seconds))
            .collect();
        let each: Vec<_> = (1..=last)
            .map(|n| (BEGIN + i64::from(n) * 1000, 1))
            .collect();
        assert!(found == each, "seconds are lost or there twice");
        let events = numbered.iter().filter(|n| n.motor.as_ref() == Some(&motor));
        let events = events.filter_map(|n| match &n.entry {
            Entry::Event(event) => Some(event.number),
            _ => None,
        });
        let events: Vec<_> = events.collect();
        let expected: Vec<_> = (1..=store.last_event(&motor).unwrap()).collect();
        assert_eq!(events, expected);
    }
    assert!(!numbered.iter().any(|n| matches!(n.entry, Entry::Gap(_))));
}

/// Each flank of each lamp is one change.
fn check_alarms(store: &Store) {
    let numbered = store.since(0, usize::MAX >> 1).unwrap();
    for motor in motors() {
        let last = last(store, &motor);
        let changes = numbered.iter().filter(|n| n.motor.as_ref() == Some(&motor));
        let changes = changes.filter_map(|n| match &n.entry {
            Entry::Alarm(change) => Some((change.time_ms, change.change)),
            _ => None,
        });
        let flanks = (1..=last).filter(|n| lit(*n) != lit(*n - 1)).map(|n| {
            let change = if lit(n) {
                Change::Raised
            } else {
                Change::Returned
            };
            (BEGIN + i64::from(n) * 1000, change)
        });
        assert_eq!(changes.collect::<Vec<_>>(), flanks.collect::<Vec<_>>());
    }
}
