//! Users, their trail, and what a page is told.

use std::path::Path;

use fleet::alarm::{AlarmFilter, Rules, Watch};
use fleet::answer::{
    ActionRequest, AlarmAnswer, AlarmHistoryAnswer, Condition, MotorAnswer, TimelineAnswer,
    TrendAnswer, WallAnswer,
};
use fleet::users::{AuditLine, Role};
use fleet::{Entry, Limits, Link, MotorId, MotorInfo, Second, Store};

const NOW: i64 = 1_789_948_800_000;

fn id(name: &str) -> MotorId {
    name.parse().unwrap()
}

fn plant(path: &Path, motors: &[&str]) -> Store {
    let store = Store::open(path, &Limits::default()).unwrap();
    let motors: Vec<_> = motors.iter().map(|name| MotorInfo::new(id(name))).collect();
    store.declare(&motors).unwrap();
    store
}

fn second(time_ms: i64, lamps: u32, judged: u8) -> Entry {
    let residuals = Some([0.5, f32::NAN, -0.01, 0.0]);
    let number = ((time_ms - NOW) / 1000) as u32;
    Entry::Second(Second {
        start: 1,
        number,
        time_ms,
        lamps,
        judged,
        windows: 4,
        fault: 1,
        residuals,
        ..Second::default()
    })
}

#[test]
fn a_token_is_told_once_and_holds_until_its_user_ends() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plant.db");
    let store = plant(&path, &[]);
    let token = store.put_user("eva", Role::Acknowledge, NOW).unwrap();
    assert_eq!(
        store.user_of(&token).unwrap().map(|u| (u.name, u.role)),
        Some(("eva".into(), Role::Acknowledge))
    );
    assert_eq!(store.user_of("dmt_0").unwrap(), None);
    assert_eq!(store.user_of("").unwrap(), None);
    // A new token ends the one before.
    let newer = store.put_user("eva", Role::Configure, NOW + 1).unwrap();
    assert_eq!(store.user_of(&token).unwrap(), None);
    assert!(store.end_user("eva", NOW + 2).unwrap());
    assert!(!store.end_user("eva", NOW + 3).unwrap());
    assert_eq!(store.user_of(&newer).unwrap(), None);
    assert_eq!(store.users().unwrap()[0].ended_unix_ms, Some(NOW + 2));
    assert!(store.put_user("", Role::See, NOW).is_err());
    assert!(Role::See < Role::Acknowledge && Role::Acknowledge < Role::Configure);
    assert!(
        "admin"
            .parse::<Role>()
            .unwrap_err()
            .to_string()
            .contains("acknowledge")
    );
    drop(store);
    // Neither token is anywhere in the files.
    for file in std::fs::read_dir(folder.path()).unwrap() {
        let bytes = std::fs::read(file.unwrap().path()).unwrap();
        for token in [&token, &newer] {
            assert!(
                !bytes
                    .windows(token.len())
                    .any(|part| part == token.as_bytes())
            );
        }
    }
}

#[test]
fn the_trail_is_newest_first() {
    let folder = tempfile::tempdir().unwrap();
    let store = plant(&folder.path().join("plant.db"), &[]);
    for k in 0..5 {
        let line = AuditLine {
            time_unix_ms: NOW + k,
            action: format!("a{k}"),
            ..AuditLine::default()
        };
        store.audit(&line).unwrap();
    }
    let found = store.audit_trail(NOW + 1, NOW + 5, 3).unwrap();
    assert_eq!(
        found.iter().map(|line| &*line.action).collect::<Vec<_>>(),
        ["a4", "a3", "a2"]
    );
}

#[test]
fn the_wall_shows_the_worst_first_and_the_old_grey() {
    let folder = tempfile::tempdir().unwrap();
    let names = ["healthy", "fault", "rest", "silent", "lost", "known"];
    let store = plant(&folder.path().join("plant.db"), &names);
    let watch = Watch::new(Rules {
        link_delay_ms: 0,
        ..Rules::default()
    });
    let now = NOW + 100_000;
    let lost = Link {
        up: false,
        time_ms: now,
        why: "no answer".into(),
    };
    store
        .append(&[
            (id("healthy"), second(now, 1, 4)),
            (id("fault"), second(now, 1 | 1 << 16, 4)),
            (id("known"), second(now - 60_000, 1 | 1 << 16, 4)),
            (id("rest"), second(now, 2, 0)),
            (id("lost"), second(now - 60_000, 1, 4)),
            (id("lost"), Entry::Link(lost)),
        ])
        .unwrap();
    watch.work(&store, now).unwrap();
    let of_known = AlarmFilter {
        motor: Some(id("known")),
        ..AlarmFilter::default()
    };
    let number = store.alarms(&of_known).unwrap()[0].number;
    let request: ActionRequest =
        serde_json::from_str(r#"{"action":"acknowledge","why":"seen"}"#).unwrap();
    let (action, why, role) = request.parts();
    assert_eq!(role, Role::Acknowledge);
    watch.act(&store, number, &action, "eva", why, now).unwrap();

    let states = store.motors().unwrap();
    let wall = WallAnswer::new(&states, now + 1_000, 5_000);
    let shown: Vec<_> = wall
        .motors
        .iter()
        .map(|m| (&*m.id, m.condition, m.stale))
        .collect();
    let expected = [
        ("fault", Condition::Fault, false),
        ("known", Condition::Fault, true),
        ("lost", Condition::Attention, true),
        ("silent", Condition::NoData, true),
        ("rest", Condition::NotJudged, false),
        ("healthy", Condition::Healthy, false),
    ];
    assert_eq!(shown, expected);
    assert_eq!(
        (wall.counts.fault, wall.counts.healthy, wall.counts.no_data),
        (2, 1, 1)
    );
    let fault = &wall.motors[0];
    assert_eq!(fault.lamps, ["RUN", "FAULT"]);
    assert_eq!(
        (fault.likely_fault.as_deref(), fault.unacknowledged_alarms),
        (Some("Rs"), 1)
    );
    assert_eq!((fault.age_ms, wall.motors[3].age_ms), (Some(1_000), None));
    // A fault that is acknowledged is still a fault, behind those that are not.
    assert_eq!(wall.motors[1].unacknowledged_alarms, 0);

    let state = states.iter().find(|s| s.info.id == id("known")).unwrap();
    let answer = MotorAnswer::new(state, &store.alarms(&of_known).unwrap(), now, 5_000);
    let text = serde_json::to_string(&answer).unwrap();
    assert_eq!(serde_json::from_str::<MotorAnswer>(&text).unwrap(), answer);
    let last = answer.last.unwrap();
    assert_eq!(
        (last.residuals_percent[0], last.residuals_percent[1]),
        (Some(50.0), None)
    );
    let AlarmAnswer {
        size_percent,
        count,
        likely_fault,
        ..
    } = answer.alarms[0].clone();
    assert_eq!(
        (size_percent, count, likely_fault.as_deref()),
        (Some(50.0), None, Some("Rs"))
    );
    let history = AlarmHistoryAnswer::new(&store.alarm_changes(number).unwrap()).unwrap();
    let steps: Vec<_> = history
        .changes
        .iter()
        .map(|c| (&*c.by, c.user.as_deref(), &*c.why))
        .collect();
    assert_eq!(
        steps,
        [
            ("board", None, "lamp FAULT on"),
            ("user", Some("eva"), "seen")
        ]
    );
    assert!(AlarmHistoryAnswer::new(&store.alarm_changes(99).unwrap()).is_none());
    let timeline = store.timeline(Some(&id("lost")), 0, i64::MAX, 10).unwrap();
    let kinds: Vec<_> = timeline
        .iter()
        .map(|n| TimelineAnswer::new(n).kind)
        .collect();
    assert_eq!(kinds, ["alarm", "link"]);
    assert!(store.timeline(None, 0, i64::MAX, 10).unwrap().is_empty());
    let trend = store
        .trend(&id("rest"), now - 5_000, now + 5_000, 10)
        .unwrap();
    let trend = TrendAnswer::new(&id("rest"), &trend);
    assert_eq!(
        (trend.times_unix_ms.as_slice(), trend.step_s),
        ([now].as_slice(), 1.0)
    );
    assert_eq!(trend.residuals_percent[1].mean, [None]);
    assert_eq!(trend.judged_share, [Some(0.0)]);
}

#[test]
fn requests_with_keys_that_nobody_knows_are_refused() {
    let refused = |text: &str| {
        serde_json::from_str::<ActionRequest>(text)
            .unwrap_err()
            .to_string()
    };
    assert!(refused(r#"{"action":"acknowledge","until":5}"#).contains("until"));
    assert!(refused(r#"{"action":"shelve","until_unix_ms":5}"#).contains("why"));
    assert!(refused(r#"{"action":"delete"}"#).contains("delete"));
}

/// A file of the first schema, written by its own statements, becomes one of today.
#[test]
fn an_older_file_becomes_a_newer_one_and_keeps_its_alarms() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plant.db");
    let today = folder.path().join("today.db");
    let store = plant(&today, &["a"]);
    let watch = Watch::new(Rules::default());
    store
        .append(&[(id("a"), second(NOW + 1_000, 1 << 16, 4))])
        .unwrap();
    watch.work(&store, NOW + 1_000).unwrap();
    drop(store);
    let old = rusqlite::Connection::open(&path).unwrap();
    old.execute_batch(include_str!("../src/store/schema_1.sql"))
        .unwrap();
    old.execute_batch(
        "PRAGMA application_id = 0x646d464c; INSERT INTO migration VALUES (1, '2026-01-01');",
    )
    .unwrap();
    old.execute("ATTACH ?1 AS today", [today.to_str().unwrap()])
        .unwrap();
    for table in ["motor", "state", "queue", "entry", "alarm", "sink"] {
        old.execute_batch(&format!("INSERT INTO {table} SELECT * FROM today.{table}"))
            .unwrap();
    }
    old.execute("UPDATE entry SET number = NULL WHERE kind = 'alarm'", [])
        .unwrap();
    drop(old);
    let store = plant(&path, &["a"]);
    assert_eq!(store.alarm_changes(1).unwrap().len(), 1);
    assert!(
        Watch::new(Rules::default())
            .work(&store, NOW + 2_000)
            .unwrap()
            .is_empty()
    );
    store.put_user("eva", Role::See, NOW).unwrap();
}
