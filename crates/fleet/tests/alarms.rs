//! Alarms on a real store: acknowledged by a named person, over a restart.

use fleet::alarm::{
    Action, AlarmCause, AlarmFilter, AlarmState, Change, Rules, Severity, Watch, WatchError, Who,
};
use fleet::{Entry, Limits, Link, MotorId, MotorInfo, Second, Store};

const NOW: i64 = 1_789_948_800_000;

fn id(name: &str) -> MotorId {
    name.parse().unwrap()
}

fn second(number: u32, lamps: u32) -> Entry {
    let time_ms = NOW + i64::from(number) * 1000;
    let residuals = Some([f32::NAN, 0.3, 0.1, 0.0]);
    Entry::Second(Second {
        start: 1,
        number,
        time_ms,
        lamps,
        judged: 4,
        windows: 4,
        fault: 2,
        residuals,
        ..Second::default()
    })
}

fn open(path: &std::path::Path) -> Store {
    let store = Store::open(path, &Limits::default()).unwrap();
    store
        .declare(&[MotorInfo::new(id("a")), MotorInfo::new(id("b"))])
        .unwrap();
    store
}

#[test]
fn a_fault_is_acknowledged_by_name_and_survives_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plant.db");
    let (store, watch) = (open(&path), Watch::new(Rules::default()));
    store
        .append(&[(id("a"), second(1, 0)), (id("b"), second(1, 1 << 16))])
        .unwrap();
    let raised = watch.work(&store, NOW + 1_000).unwrap();
    assert_eq!(raised.len(), 1);
    assert!(watch.work(&store, NOW + 2_000).unwrap().is_empty());
    let motors = store.motors().unwrap();
    assert_eq!((motors[0].open_alarms, motors[0].worst), (0, None));
    assert_eq!(
        (motors[1].open_alarms, motors[1].worst),
        (1, Some(Severity::High))
    );
    let number = raised[0].alarm.number;
    let refused = watch.act(&store, 99, &Action::Acknowledge, "eva", "", NOW);
    assert!(matches!(refused, Err(WatchError::Action(_))));
    watch
        .act(
            &store,
            number,
            &Action::Acknowledge,
            "eva",
            "bearing ordered",
            NOW + 3_000,
        )
        .unwrap();
    drop((store, watch));

    let (store, watch) = (open(&path), Watch::new(Rules::default()));
    assert!(watch.work(&store, NOW + 4_000).unwrap().is_empty());
    let found = store.alarms(&AlarmFilter::default()).unwrap();
    assert_eq!(found.len(), 1);
    let alarm = &found[0];
    assert_eq!(
        (alarm.state, alarm.cause, alarm.fault),
        (AlarmState::Acknowledged, AlarmCause::Fault, 2)
    );
    assert_eq!(alarm.size, Some(0.3));
    let changes: Vec<_> = store
        .since(0, 100)
        .unwrap()
        .into_iter()
        .filter_map(|n| match n.entry {
            Entry::Alarm(change) => Some((change.change, change.who, change.why)),
            _ => None,
        })
        .collect();
    let eva = Who::User("eva".into());
    assert_eq!(changes.len(), 2);
    assert_eq!(
        changes[1],
        (Change::Acknowledged, eva, "bearing ordered".to_owned())
    );

    store
        .append(&[(id("b"), second(2, 0)), (id("b"), second(70, 0))])
        .unwrap();
    watch.work(&store, NOW + 70_000).unwrap();
    let normal = AlarmFilter {
        states: vec![AlarmState::Normal],
        ..AlarmFilter::default()
    };
    assert_eq!(store.alarms(&normal).unwrap().len(), 1);
    let motors = store.motors().unwrap();
    assert_eq!(
        (motors[1].open_alarms, motors[1].worst),
        (1, Some(Severity::Low))
    );
    let other = AlarmFilter {
        motor: Some(id("a")),
        ..AlarmFilter::default()
    };
    // The seconds 3 to 69 are missing: the store said so, and that is an alarm of b.
    assert!(store.alarms(&other).unwrap().is_empty());
    let gap = AlarmFilter {
        motor: Some(id("b")),
        from_ms: Some(NOW + 69_000),
        ..AlarmFilter::default()
    };
    let causes: Vec<_> = store
        .alarms(&gap)
        .unwrap()
        .iter()
        .map(|a| a.cause)
        .collect();
    assert!(causes.contains(&AlarmCause::Gap), "{causes:?}");
}

#[test]
fn a_delay_runs_on_over_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plant.db");
    let (store, watch) = (open(&path), Watch::new(Rules::default()));
    let down = Link {
        up: false,
        time_ms: NOW,
        why: "no answer".into(),
    };
    store.append(&[(id("a"), Entry::Link(down))]).unwrap();
    assert!(watch.work(&store, NOW + 5_000).unwrap().is_empty());
    drop((store, watch));
    let (store, watch) = (open(&path), Watch::new(Rules::default()));
    assert!(watch.work(&store, NOW + 9_000).unwrap().is_empty());
    let raised = watch.work(&store, NOW + 10_000).unwrap();
    assert_eq!(raised.len(), 1);
    assert_eq!(raised[0].alarm.cause, AlarmCause::LinkLost);
}

#[test]
fn a_store_that_fails_changes_no_alarm() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plant.db");
    let (first, watch) = (open(&path), Watch::new(Rules::default()));
    first.append(&[(id("a"), second(1, 1 << 16))]).unwrap();
    // Another program took the store over: nothing of this watch is stored, so nothing of it happened.
    let second_store = open(&path);
    assert!(watch.work(&first, NOW).is_err());
    let raised = watch.work(&second_store, NOW + 1_000).unwrap();
    assert_eq!((raised.len(), raised[0].alarm.number), (1, 1));
}
