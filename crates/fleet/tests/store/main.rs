//! The store through its public face, on real files.

mod history;

use std::path::{Path, PathBuf};

use fleet::{
    BoardEvent, Entry, Gap, GapOf, Limits, Link, MotorId, MotorInfo, Second, Store, StoreError,
};
use tempfile::TempDir;

/// 2026-09-21 00:00 UTC.
const DAY: i64 = 1_789_948_800_000;
/// A day, ms.
const DAY_MS: i64 = 86_400_000;
const HOUR: i64 = 3_600_000;

fn id(name: &str) -> MotorId {
    name.parse().unwrap()
}

fn plant(limits: &Limits, motors: &[&str]) -> (TempDir, PathBuf, Store) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plant.db");
    let store = Store::open(&path, limits).unwrap();
    declare(&store, motors);
    (folder, path, store)
}

fn declare(store: &Store, motors: &[&str]) {
    let motors: Vec<_> = motors.iter().map(|name| MotorInfo::new(id(name))).collect();
    store.declare(&motors).unwrap();
}

/// A second whose values follow from its number, so that what comes back is known.
fn second(start: u32, number: u32) -> Second {
    let x = number as f32;
    Second {
        start,
        number,
        time_ms: DAY + i64::from(number - 1) * 1000,
        lamps: 1,
        windows: 4,
        judged: 3,
        not_judged: 2,
        fault: 0,
        residuals: Some([0.001, -0.002, 0.25, f32::NAN]),
        voltage_v: Some(230.0 + (number % 10) as f32),
        current_a: None,
        frequency_hz: Some(50.0),
        speed_rpm: Some(x),
    }
}

fn seconds(motor: &str, numbers: impl Iterator<Item = u32>) -> Vec<(MotorId, Entry)> {
    numbers
        .map(|number| (id(motor), Entry::Second(second(1, number))))
        .collect()
}

fn event(number: u32) -> Entry {
    Entry::Event(BoardEvent {
        number,
        time_ms: DAY,
        cause: 3,
        times: 1,
        values: [1, 900],
    })
}

fn all(store: &Store) -> Vec<Entry> {
    store
        .since(0, 1_000_000)
        .unwrap()
        .into_iter()
        .map(|found| found.entry)
        .collect()
}

#[test]
fn what_is_stored_comes_back_in_order_and_once() {
    let (_folder, path, store) = plant(&Limits::default(), &["a", "b"]);
    let batch = [
        (id("a"), Entry::Second(second(7, 1))),
        (id("b"), event(12)),
        (
            id("a"),
            Entry::Link(Link {
                up: false,
                time_ms: DAY,
                why: "no answer".into(),
            }),
        ),
        (id("a"), Entry::Second(second(7, 2))),
    ];
    let done = store.append(&batch).unwrap();
    assert_eq!((done.stored, done.already, done.gaps), (4, 0, 0));
    let done = store.append(&batch).unwrap();
    assert_eq!((done.stored, done.already, done.gaps), (0, 4, 0));
    drop(store);

    let store = Store::open(&path, &Limits::default()).unwrap();
    let found = store.since(0, 100).unwrap();
    let same = |(found, (motor, entry)): (&fleet::Numbered, &(MotorId, Entry))| {
        assert_eq!(found.motor.as_ref(), Some(motor));
        match (&found.entry, entry) {
            // NaN is no equal of itself.
            (Entry::Second(found), Entry::Second(put)) => {
                let residuals = |s: &Second| s.residuals.map(|r| r.map(f32::to_bits));
                assert_eq!(residuals(found), residuals(put));
                let without = |s: &Second| Second {
                    residuals: None,
                    ..s.clone()
                };
                assert_eq!(without(found), without(put));
            }
            (found, put) => assert_eq!(found, put),
        }
    };
    assert_eq!(found.len(), batch.len());
    found.iter().zip(&batch).for_each(same);
    assert_eq!(store.last_second(&id("a")).unwrap(), Some((7, 2)));
    assert_eq!(store.last_event(&id("b")).unwrap(), 12);
    // In pieces it is the same.
    let first = store.since(0, 3).unwrap();
    let rest = store.since(first[2].id, 3).unwrap();
    assert_eq!((first.len(), rest.len()), (3, 1));
    assert_eq!(store.append(&batch).unwrap().already, 4);
}

#[test]
fn a_hole_is_told_by_the_store_where_nobody_else_did() {
    let (_folder, _path, store) = plant(&Limits::default(), &["a"]);
    let told = Gap {
        what: GapOf::Seconds { start: 1 },
        first: 21,
        last: 25,
        time_ms: DAY,
    };
    store.append(&seconds("a", [500, 501].into_iter())).unwrap();
    // What was before the first second was never promised; what is missing since is.
    let later = [
        (id("a"), Entry::Second(second(1, 504))),
        (id("a"), event(5)),
        (id("a"), event(9)),
    ];
    assert_eq!(store.append(&later).unwrap().gaps, 2);
    let restarted = Second {
        start: 10,
        number: 3,
        ..second(1, 1)
    };
    assert_eq!(
        store
            .append(&[(id("a"), Entry::Second(restarted))])
            .unwrap()
            .gaps,
        1
    );
    let gaps: Vec<_> = all(&store)
        .into_iter()
        .filter_map(|entry| match entry {
            Entry::Gap(gap) => Some((gap.what, gap.first, gap.last)),
            _ => None,
        })
        .collect();
    let expected = [
        (GapOf::Seconds { start: 1 }, 502, 503),
        (GapOf::Events, 6, 8),
        (GapOf::Seconds { start: 10 }, 1, 2),
    ];
    assert_eq!(gaps, expected);

    declare(&store, &["a", "b"]);
    store.append(&seconds("b", 1..=20)).unwrap();
    assert_eq!(
        store
            .append(&[(id("b"), Entry::Gap(told.clone()))])
            .unwrap()
            .stored,
        1
    );
    let done = store.append(&seconds("b", 26..=27)).unwrap();
    assert_eq!((done.stored, done.gaps), (2, 0));
    // Told twice it is one; and what was called missing is not taken later as if it were new.
    assert_eq!(
        store
            .append(&[(id("b"), Entry::Gap(told))])
            .unwrap()
            .already,
        1
    );
    assert_eq!(store.append(&seconds("b", 21..=25)).unwrap().already, 5);
}

#[test]
fn another_board_begins_anew() {
    let (_folder, _path, store) = plant(&Limits::default(), &["a"]);
    let board = |serial: &str| {
        (
            id("a"),
            Entry::Board {
                serial: serial.into(),
                time_ms: DAY,
            },
        )
    };
    store
        .append(&[board("one"), (id("a"), event(300))])
        .unwrap();
    assert_eq!(
        store
            .append(&[board("one"), (id("a"), event(300))])
            .unwrap()
            .already,
        2
    );
    store.append(&[board("two")]).unwrap();
    assert_eq!(store.last_event(&id("a")).unwrap(), 0);
    // Event 300 of the other board is another event.
    let done = store
        .append(&[(id("a"), event(1)), (id("a"), event(300))])
        .unwrap();
    assert_eq!((done.stored, done.gaps), (2, 1));
}

#[test]
fn a_batch_is_stored_as_a_whole_or_not_at_all() {
    let (_folder, _path, store) = plant(&Limits::default(), &["a"]);
    let batch = [(id("a"), event(1)), (id("stranger"), event(1))];
    assert!(matches!(
        store.append(&batch),
        Err(StoreError::UnknownMotor(_))
    ));
    assert_eq!(store.last_event(&id("a")).unwrap(), 0);
    assert!(all(&store).is_empty());
    assert_eq!(store.append(&batch[..1]).unwrap().stored, 1);
}

#[test]
fn the_last_who_opens_writes_and_others_read() {
    let (_folder, path, first) = plant(&Limits::default(), &["a"]);
    let second = Store::open(&path, &Limits::default()).unwrap();
    second.append(&[(id("a"), event(1))]).unwrap();
    assert!(matches!(
        first.append(&[(id("a"), event(2))]),
        Err(StoreError::OtherWriter)
    ));
    assert_eq!(all(&first).len(), 1);
}

#[test]
fn files_that_are_no_store_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |path: &Path| {
        Store::open(path, &Limits::default())
            .err()
            .unwrap()
            .to_string()
    };
    let text = folder.path().join("notes.txt");
    std::fs::write(
        &text,
        "a text that is longer than nothing, and no database at all",
    )
    .unwrap();
    assert!(
        refused(&text).contains("not a database"),
        "{}",
        refused(&text)
    );
    let foreign = folder.path().join("foreign.db");
    let connection = rusqlite::Connection::open(&foreign).unwrap();
    connection
        .execute_batch("CREATE TABLE t(x); INSERT INTO t VALUES (1);")
        .unwrap();
    drop(connection);
    assert!(
        refused(&foreign).contains("another program"),
        "{}",
        refused(&foreign)
    );
    let newer = folder.path().join("newer.db");
    drop(Store::open(&newer, &Limits::default()).unwrap());
    let connection = rusqlite::Connection::open(&newer).unwrap();
    connection
        .execute("INSERT INTO migration VALUES (99, 'tomorrow')", [])
        .unwrap();
    drop(connection);
    assert!(refused(&newer).contains("schema 99"), "{}", refused(&newer));
    assert!(
        refused(folder.path()).contains("unable to open"),
        "{}",
        refused(folder.path())
    );
    let limits = Limits {
        minutes_days: 1,
        ..Limits::default()
    };
    assert!(
        Store::open(&newer, &limits)
            .err()
            .unwrap()
            .to_string()
            .contains("minutes_days = 1")
    );
}

#[test]
fn an_output_goes_on_where_it_delivered() {
    let (_folder, path, store) = plant(&Limits::default(), &["a"]);
    store.append(&[(id("a"), event(1))]).unwrap();
    store.declare_sinks(&["mqtt"]).unwrap();
    store
        .append(&[(id("a"), event(2)), (id("a"), event(3))])
        .unwrap();
    let cursor = store.cursor("mqtt").unwrap();
    let found = store.since(cursor, 10).unwrap();
    assert_eq!(
        found.len(),
        2,
        "a new output begins with what comes after it"
    );
    store.set_cursor("mqtt", found[0].id).unwrap();
    store.set_cursor("mqtt", cursor).unwrap();
    drop(store);
    let store = Store::open(&path, &Limits::default()).unwrap();
    store.declare_sinks(&["mqtt"]).unwrap();
    assert_eq!(
        store
            .since(store.cursor("mqtt").unwrap(), 10)
            .unwrap()
            .len(),
        1
    );
}

#[test]
fn the_present_state_of_each_motor() {
    let (_folder, _path, store) = plant(&Limits::default(), &["b", "a", "gone"]);
    store.append(&seconds("a", 1..=3)).unwrap();
    store.append(&[(id("b"), event(4))]).unwrap();
    store
        .append(&[(
            id("a"),
            Entry::Link(Link {
                up: true,
                time_ms: DAY,
                why: String::new(),
            }),
        )])
        .unwrap();
    declare(&store, &["a", "b"]);
    let motors = store.motors().unwrap();
    let names: Vec<_> = motors.iter().map(|m| m.info.id.as_str()).collect();
    assert_eq!(names, ["a", "b"]);
    assert_eq!(motors[0].last.as_ref().map(|s| s.number), Some(3));
    assert_eq!(motors[0].link.as_ref().map(|link| link.up), Some(true));
    assert_eq!((motors[1].last.clone(), motors[1].last_event), (None, 4));
}

#[test]
fn the_queue_waits_for_the_slowest_output_and_no_longer() {
    let (_folder, _path, store) = plant(&Limits::default(), &["a"]);
    store.declare_sinks(&["slow", "fast"]).unwrap();
    store.append(&seconds("a", 1..=100)).unwrap();
    store.set_cursor("fast", 100).unwrap();
    store.seal().unwrap();
    store.maintain(DAY).unwrap();
    assert_eq!(store.since(0, 1000).unwrap().len(), 100);
    store.set_cursor("slow", 60).unwrap();
    store.maintain(DAY).unwrap();
    let left: Vec<_> = store
        .since(0, 1000)
        .unwrap()
        .iter()
        .map(|found| found.id)
        .collect();
    assert_eq!(left, (61..=100).collect::<Vec<_>>());
    assert_eq!(
        store.trend(&id("a"), DAY, DAY + HOUR, 1).unwrap().points[0].seconds,
        100
    );
}

#[test]
fn ids_are_never_given_twice_although_the_newest_rows_are_gone() {
    let (_folder, path, store) = plant(&Limits::default(), &["a"]);
    store.append(&seconds("a", 1..=100)).unwrap();
    store.seal().unwrap();
    store.maintain(DAY).unwrap();
    assert!(store.since(0, 10).unwrap().is_empty());
    drop(store);
    let store = Store::open(&path, &Limits::default()).unwrap();
    store.append(&seconds("a", 101..=101)).unwrap();
    assert_eq!(store.since(0, 10).unwrap()[0].id, 101);
}

fn recording(second: u32, samples: &[u8], missing: Option<&str>) -> Entry {
    Entry::Recording(fleet::Recording {
        time_ms: DAY,
        from_ms: DAY,
        to_ms: DAY,
        key: fleet::RecordingKey::Second { start: 7, second },
        missing: missing.map(str::to_owned),
        samples: samples.to_vec(),
        ..fleet::Recording::default()
    })
}

/// Samples are stored once; they take the place of a reason, and nothing takes theirs.
#[test]
fn a_recording_is_stored_once_and_dropped_with_its_days() {
    let (_folder, _path, store) = plant(&Limits::default(), &["a"]);
    let put = |entry: Entry| store.append(&[(id("a"), entry)]).unwrap().stored;
    assert_eq!(put(recording(5, &[], Some("no power"))), 1);
    assert_eq!(put(recording(5, &[], Some("no power"))), 0);
    assert_eq!(put(recording(5, &[1, 2], None)), 1);
    assert_eq!(put(recording(5, &[3], None)), 0);
    assert_eq!(put(recording(5, &[], Some("no power"))), 0);
    let name = "a.0.7.5";
    let instants = || store.recording(name).unwrap().unwrap().instants;
    assert_eq!(instants(), Some(vec![1, 2]));
    let names: Vec<_> = all(&store)
        .into_iter()
        .filter_map(|entry| match entry {
            Entry::Recording(recording) => Some(recording.file),
            _ => None,
        })
        .collect();
    assert_eq!(names, [name, name]);
    store.maintain(DAY + 400 * DAY_MS).unwrap();
    assert_eq!(instants(), Some(vec![1, 2]));
    store.maintain(DAY + 401 * DAY_MS).unwrap();
    assert_eq!(instants(), None);
    let told = all(&store).into_iter().any(|entry| {
        matches!(entry, Entry::Thinned(thinned) if thinned.to == fleet::ThinnedTo::RecordingsDropped && thinned.count == 1)
    });
    assert!(told);
}
