//! A month and its models, counted from a real store.

use std::path::Path;

use fleet::alarm::{Alarm, AlarmCause, AlarmChange, AlarmState, Change, Evidence, Severity, Who};
use fleet::{BoardEvent, Entry, Limits, MotorId, MotorInfo, Reader, Second, Store};

use super::models::{Models, all};
use super::month::page_at;
use crate::fleet::plant::DueRule;

const DAY_MS: i64 = 86_400_000;
/// `date -ud 2026-10-05 +%s`
const MONDAY_MS: i64 = 1_791_158_400_000;

fn motor(name: &str) -> MotorId {
    name.parse().expect("a name")
}

fn motors() -> String {
    format!("{}/../../motors", env!("CARGO_MANIFEST_DIR"))
}

fn store(folder: &Path, entries: &[(MotorId, Entry)]) -> Reader {
    let path = folder.join("plant.db");
    let store = Store::open(&path, &Limits::default()).expect("a store");
    let info = |name: &str, file: Option<&str>| MotorInfo {
        motor_file: file.map(|file| format!("{}/{file}", motors())),
        ..MotorInfo::new(motor(name))
    };
    let infos = [
        info("calibrated", Some("peer-2k2-saturating-calibrated.toml")),
        info("missing", Some("none.toml")),
        info("plain", Some("peer-2k2.toml")),
        info("unnamed", None),
    ];
    store.declare(&infos).expect("declared");
    store.append(entries).expect("stored");
    Reader::open(&path).expect("a reader")
}

fn event(number: u32, time_ms: i64, cause: u16, value: u32) -> Entry {
    Entry::Event(BoardEvent {
        number,
        time_ms,
        cause,
        times: 1,
        values: [value, 0],
    })
}

fn models(reader: &Reader, now_ms: i64) -> Models {
    all(reader, &DueRule::default(), now_ms).expect("read")
}

#[test]
fn every_motor_tells_its_model_and_what_is_not_known() {
    let folder = tempfile::tempdir().expect("a folder");
    // Learnt a year ago, less a day.
    let learnt = event(1, MONDAY_MS, 9, 0xabcd);
    let configured = event(1, MONDAY_MS, 15, 0x1234);
    let entries = [(motor("unnamed"), learnt), (motor("plain"), configured)];
    let reader = store(folder.path(), &entries);
    let before = models(&reader, MONDAY_MS + 364 * DAY_MS);
    let of = |models: &Models, id: &str| {
        let found = models.models.iter().find(|model| model.id == id);
        found.expect("it is there").clone()
    };
    let calibrated = of(&before, "calibrated");
    assert_eq!(calibrated.effects, ["magnetizing-saturation"]);
    assert_eq!(
        (calibrated.calibrated, calibrated.calibrated_by),
        (Some(true), "file")
    );
    assert_eq!(
        calibrated.file_constants.map(|constants| constants.len()),
        Some(8)
    );
    let missing = of(&before, "missing");
    assert!(
        !missing.due && missing.why.contains("none.toml"),
        "{missing:?}"
    );
    let plain = of(&before, "plain");
    assert!(plain.due && plain.why.contains("00001234"), "{plain:?}");
    let unnamed = of(&before, "unnamed");
    assert_eq!(
        (unnamed.due, unnamed.learnt.as_deref()),
        (false, Some("0000abcd"))
    );
    assert_eq!(unnamed.calibrated_on.as_deref(), Some("2026-10-05"));
    let after = of(&models(&reader, MONDAY_MS + 366 * DAY_MS), "unnamed");
    assert!(after.due && after.why.contains("365 days"), "{after:?}");
}

fn change(change: Change, who: Who, time_ms: i64, why: &str) -> Entry {
    let alarm = Alarm {
        number: 1,
        motor: Some(motor("plain")),
        cause: AlarmCause::Sensor,
        state: AlarmState::Unacknowledged,
        present: true,
        acknowledged: false,
        suppressed: false,
        severity: Severity::Medium,
        fault: 0,
        size: None,
        evidence: Evidence::default(),
        raised_ms: time_ms,
        changed_ms: time_ms,
        times: 1,
        shelved_until_ms: None,
    };
    Entry::Alarm(AlarmChange {
        change,
        before: AlarmState::Normal,
        alarm,
        who,
        time_ms,
        why: why.to_owned(),
    })
}

#[test]
fn a_month_counts_its_alarms_their_people_and_what_is_stored() {
    let folder = tempfile::tempdir().expect("a folder");
    let second = |number: u32| {
        let second = Second {
            start: 1,
            number,
            time_ms: MONDAY_MS + 1000 * i64::from(number),
            windows: 50,
            judged: 40,
            ..Second::default()
        };
        (motor("plain"), Entry::Second(second))
    };
    let hour_ms = 3_600_000;
    let anna = || Who::User("Anna".to_owned());
    let mut entries: Vec<_> = (1..=600).map(second).collect();
    entries.extend(
        [
            change(Change::Raised, Who::Board, MONDAY_MS, ""),
            change(
                Change::Acknowledged,
                anna(),
                MONDAY_MS + hour_ms,
                "False alarm: a fuse",
            ),
            change(Change::Returned, Who::Board, MONDAY_MS + 3 * hour_ms, ""),
            change(
                Change::Raised,
                Who::Board,
                MONDAY_MS - 9 * DAY_MS,
                "the month before",
            ),
        ]
        .map(|entry| (motor("plain"), entry)),
    );
    let reader = store(folder.path(), &entries);
    let now_ms = MONDAY_MS + 5 * DAY_MS;
    let page = page_at(reader.path(), "2026-10", now_ms).expect("a page");
    let json = page
        .split("id=\"result\">")
        .nth(1)
        .and_then(|rest| rest.split("</script>").next());
    let month: serde_json::Value = serde_json::from_str(json.expect("a result")).expect("JSON");
    let alarms = month["alarms"].as_array().expect("a list");
    assert_eq!(alarms.len(), 1, "{month}");
    let alarm = &alarms[0];
    assert_eq!(alarm["raised"], "2026-10-05 00:00");
    assert_eq!(
        (&alarm["hours"], &alarm["acknowledged_by"]),
        (&3.0.into(), &"Anna".into())
    );
    assert_eq!(
        (&alarm["acknowledged_after_hours"], &alarm["marked_false"]),
        (&1.0.into(), &true.into())
    );
    let plain = month["motors"]
        .as_array()
        .expect("a list")
        .iter()
        .find(|one| one["id"] == "plain");
    let plain = plain.expect("it is there");
    assert_eq!(
        (&plain["alarms"], &plain["judged_percent"]),
        (&1.into(), &80.0.into())
    );
    // Of the five days that had passed since its first second.
    let stored = plain["availability_percent"].as_f64().expect("a number");
    assert!(
        (stored - 100.0 * 600.0 / (5.0 * 86_400.0 - 1.0)).abs() < 1e-6,
        "{stored}"
    );
    // The others never had a second: they take nothing from the mean.
    assert_eq!(month["availability_percent"].as_f64(), Some(stored));
    let before = month["motors"].as_array().expect("a list").iter();
    let unseen = before.filter(|one| one["availability_percent"].is_null());
    assert_eq!(unseen.count(), 3);
    assert_eq!(month["causes"][0]["marked_false"], 1);
    let refused = page_at(reader.path(), "October", now_ms);
    assert!(refused.is_err_and(|why| why.contains("write one as 2026-10")));
}
