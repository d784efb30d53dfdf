//! The life cycle against what an operator expects, and random plants against a model that knows nothing of desks.

use std::collections::HashMap;

use proptest::prelude::*;

use super::action::{Action, ActionError};
use super::change::{Alarm, AlarmCause, AlarmChange, AlarmState, Change, Severity, Who};
use super::desk::Desk;
use super::memory::Memory;
use super::rules::Rules;
use crate::entry::{BoardEvent, Entry, Gap, GapOf, Link, Recording, Second};
use crate::motor::MotorId;

fn id(name: &str) -> MotorId {
    name.parse().unwrap()
}

fn desk(rules: Rules) -> Desk {
    Desk::new(rules, Vec::new(), Memory::default())
}

/// No delays: each entry counts at once.
fn at_once() -> Rules {
    Rules {
        off_delay_ms: 0,
        link_delay_ms: 0,
        update_ms: 0,
        flood_alarms: 1000,
        ..Rules::default()
    }
}

const FAULT: u32 = 1 << 16;

fn second(time_ms: i64, lamps: u32, judged: u8) -> Entry {
    let number = (time_ms / 1000) as u32;
    let residuals = Some([0.01, -0.2, 0.0, f32::NAN]);
    let fault = if lamps == FAULT { 1 } else { 0 };
    Entry::Second(Second {
        start: 1,
        number,
        time_ms,
        lamps,
        judged,
        fault,
        residuals,
        ..Second::default()
    })
}

fn event(time_ms: i64, number: u32, cause: u16, values: [u32; 2]) -> Entry {
    Entry::Event(BoardEvent {
        number,
        time_ms,
        cause,
        times: 1,
        values,
    })
}

fn link(time_ms: i64, up: bool) -> Entry {
    Entry::Link(Link {
        up,
        time_ms,
        why: "no answer".into(),
    })
}

fn steps(changes: &[AlarmChange]) -> Vec<(Change, AlarmState)> {
    changes
        .iter()
        .map(|change| (change.change, change.alarm.state))
        .collect()
}

#[test]
fn a_fault_from_lamp_to_normal() {
    let (mut desk, motor) = (desk(Rules::default()), id("a"));
    let raised = desk.take(&motor, &second(1_000, FAULT, 4));
    assert_eq!(
        steps(&raised),
        [(Change::Raised, AlarmState::Unacknowledged)]
    );
    let alarm = &raised[0].alarm;
    assert_eq!(
        (alarm.cause, alarm.severity, alarm.fault),
        (AlarmCause::Fault, Severity::High, 1)
    );
    assert_eq!(
        (alarm.size, alarm.evidence.second),
        (Some(0.2), Some((1, 1)))
    );
    assert_eq!(raised[0].who, Who::Board);
    assert!(desk.take(&motor, &second(2_000, FAULT, 4)).is_empty());
    // Standing still proves nothing.
    assert!(desk.take(&motor, &second(3_000, 0, 0)).is_empty());
    assert!(desk.tick(500_000).is_empty());
    let known = desk
        .act(1, &Action::Acknowledge, "eva", "", 510_000)
        .unwrap();
    assert_eq!(
        steps(&known),
        [(Change::Acknowledged, AlarmState::Acknowledged)]
    );
    assert_eq!(known[0].who, Who::User("eva".into()));
    assert!(
        desk.act(1, &Action::Acknowledge, "max", "", 511_000)
            .unwrap()
            .is_empty()
    );
    // Dark while judged: gone after the delay, not before.
    assert!(desk.take(&motor, &second(520_000, 0, 4)).is_empty());
    assert!(desk.take(&motor, &second(579_000, 0, 4)).is_empty());
    let gone = desk.take(&motor, &second(580_000, 0, 4));
    assert_eq!(steps(&gone), [(Change::Returned, AlarmState::Normal)]);
    assert_eq!(desk.alarms().count(), 0);
    let again = desk.take(&motor, &second(600_000, FAULT, 4));
    assert_eq!(again[0].alarm.number, 2);
}

#[test]
fn an_alarm_that_returned_waits_for_somebody_unless_told_otherwise() {
    for (latch, state) in [
        (true, AlarmState::ReturnedUnacknowledged),
        (false, AlarmState::Normal),
    ] {
        let mut desk = desk(Rules { latch, ..at_once() });
        desk.take(&id("a"), &second(1_000, FAULT, 4));
        let gone = desk.take(&id("a"), &second(2_000, 0, 4));
        assert_eq!(steps(&gone), [(Change::Returned, state)]);
    }
}

#[test]
fn lamp_and_event_of_one_fault_are_one_alarm() {
    let (mut desk, motor) = (desk(at_once()), id("a"));
    desk.take(&motor, &second(10_000, FAULT, 4));
    let told = desk.take(&motor, &event(11_000, 77, 3, [1, 950]));
    assert_eq!(
        steps(&told),
        [(Change::Updated, AlarmState::Unacknowledged)]
    );
    assert_eq!(told[0].alarm.evidence.event, Some(77));
    // The event of going out is older than what seconds show.
    assert!(desk.take(&motor, &event(12_000, 78, 4, [0, 0])).is_empty());
    // Another likely fault, and a larger size: the same alarm.
    let Entry::Second(mut larger) = second(13_000, FAULT, 4) else {
        unreachable!()
    };
    (larger.fault, larger.residuals) = (2, Some([0.9, 0.0, 0.0, 0.0]));
    let told = desk.take(&motor, &Entry::Second(larger));
    assert_eq!(
        steps(&told),
        [(Change::Updated, AlarmState::Unacknowledged)]
    );
    assert_eq!(
        (
            told[0].alarm.number,
            told[0].alarm.fault,
            told[0].alarm.size
        ),
        (1, 2, Some(0.9))
    );
    // An event alone is an alarm too, and its own end ends it.
    let other = id("b");
    let told = desk.take(&other, &event(14_000, 5, 3, [12, 800]));
    assert_eq!((told[0].change, told[0].alarm.fault), (Change::Raised, 12));
    let gone = desk.take(&other, &event(15_000, 6, 4, [0, 0]));
    assert_eq!(
        steps(&gone),
        [(Change::Returned, AlarmState::ReturnedUnacknowledged)]
    );
}

#[test]
fn a_recording_goes_to_its_alarm() {
    let (mut desk, motor) = (desk(at_once()), id("a"));
    desk.take(&motor, &second(1_000, 1 << 10, 4));
    desk.take(&motor, &second(1_000, FAULT, 4));
    let recording = |alarm, file: &str| {
        let file = file.to_owned();
        Entry::Recording(Recording {
            time_ms: 2_000,
            from_ms: 0,
            to_ms: 1_000,
            file,
            bytes: 1,
            alarm,
            ..Recording::default()
        })
    };
    let told = desk.take(&motor, &recording(None, "one.parquet"));
    assert_eq!(
        (told[0].alarm.cause, told[0].change),
        (AlarmCause::Fault, Change::Updated)
    );
    assert_eq!(
        told[0].alarm.evidence.recording.as_deref(),
        Some("one.parquet")
    );
    assert_eq!(
        desk.take(&motor, &recording(Some(1), "two.parquet"))[0]
            .alarm
            .cause,
        AlarmCause::Sensor
    );
    assert!(desk.take(&motor, &recording(Some(77), "x")).is_empty());
    assert!(desk.take(&id("b"), &recording(None, "x")).is_empty());
}

#[test]
fn links_gaps_sensors_and_doubts() {
    let (mut desk, motor) = (
        desk(Rules {
            off_delay_ms: 0,
            ..Rules::default()
        }),
        id("a"),
    );
    // A link that is back within ten seconds is no alarm.
    assert!(desk.take(&motor, &link(0, false)).is_empty());
    assert!(desk.take(&motor, &link(9_000, true)).is_empty());
    assert!(desk.tick(60_000).is_empty());
    assert!(desk.take(&motor, &link(70_000, false)).is_empty());
    assert!(desk.tick(79_999).is_empty());
    let lost = desk.tick(80_000);
    assert_eq!(
        (lost[0].alarm.cause, &*lost[0].why),
        (AlarmCause::LinkLost, "no answer")
    );
    let gap = Gap {
        what: GapOf::Seconds { start: 1 },
        first: 11,
        last: 15,
        time_ms: 90_000,
    };
    let told = desk.take(&motor, &Entry::Gap(gap));
    assert_eq!(
        (told[0].alarm.cause, told[0].alarm.size),
        (AlarmCause::Gap, Some(5.0))
    );
    let sensor_on = second(91_000, 1 << 10, 0);
    let told = desk.take(&motor, &sensor_on);
    let causes: Vec<_> = told.iter().map(|c| (c.alarm.cause, c.change)).collect();
    assert_eq!(
        causes,
        [
            (AlarmCause::Sensor, Change::Raised),
            (AlarmCause::Gap, Change::Returned)
        ]
    );
    // Blinking is no alarm: a channel clips.
    assert!(desk.take(&id("b"), &second(91_000, 2 << 10, 0)).is_empty());
    let told = desk.take(&motor, &event(92_000, 4, 7, [2, 3]));
    assert_eq!(
        (told[0].alarm.cause, told[0].change),
        (AlarmCause::Doubt, Change::Raised)
    );
    let told = desk.take(&motor, &event(93_000, 5, 2, [0, 0]));
    assert_eq!(
        (told[0].alarm.cause, told[0].change),
        (AlarmCause::Doubt, Change::Returned)
    );
}

#[test]
fn a_shelf_keeps_what_happens_and_ends() {
    let (mut desk, motor) = (desk(at_once()), id("a"));
    desk.take(&motor, &second(1_000, FAULT, 4));
    let shelve = |until_ms| Action::Shelve { until_ms };
    assert_eq!(
        desk.act(1, &shelve(5_000), "eva", " ", 2_000),
        Err(ActionError::NoReason)
    );
    let error = desk
        .act(1, &shelve(2_000), "eva", "works on it", 2_000)
        .unwrap_err();
    assert!(error.to_string().contains("168 hours"), "{error}");
    assert_eq!(
        desk.act(9, &shelve(5_000), "eva", "x", 2_000),
        Err(ActionError::Unknown(9))
    );
    let shelved = desk
        .act(1, &shelve(50_000), "eva", "works on it", 2_000)
        .unwrap();
    assert_eq!(steps(&shelved), [(Change::Shelved, AlarmState::Shelved)]);
    let gone = desk.take(&motor, &second(3_000, 0, 4));
    assert_eq!(steps(&gone), [(Change::Returned, AlarmState::Shelved)]);
    let again = desk.take(&motor, &second(4_000, FAULT, 4));
    assert_eq!(steps(&again), [(Change::Raised, AlarmState::Shelved)]);
    assert_eq!((again[0].alarm.number, again[0].alarm.times), (1, 2));
    let ended = desk.tick(50_000);
    assert_eq!(
        steps(&ended),
        [(Change::Unshelved, AlarmState::Unacknowledged)]
    );
    assert_eq!(ended[0].who, Who::Gateway);
    let away = desk
        .act(1, &Action::Suppress, "eva", "out of service", 60_000)
        .unwrap();
    assert_eq!(steps(&away), [(Change::Suppressed, AlarmState::Suppressed)]);
    let back = desk.act(1, &Action::Unsuppress, "eva", "", 70_000).unwrap();
    assert_eq!(
        steps(&back),
        [(Change::Unsuppressed, AlarmState::Unacknowledged)]
    );
}

#[test]
fn a_flood_is_one_alarm_loses_none_and_hides_no_fault() {
    let mut desk = desk(Rules {
        flood_alarms: 10,
        ..at_once()
    });
    let motors: Vec<_> = (0..50).map(|k| id(&format!("m{k}"))).collect();
    let all: Vec<_> = motors
        .iter()
        .flat_map(|m| desk.take(m, &link(1_000, false)))
        .collect();
    let raised = |cause| {
        all.iter()
            .filter(move |c| c.change == Change::Raised && c.alarm.cause == cause)
    };
    assert_eq!(raised(AlarmCause::LinkLost).count(), 50);
    let aside = raised(AlarmCause::LinkLost).filter(|c| c.alarm.state == AlarmState::Suppressed);
    assert_eq!(aside.count(), 40);
    assert_eq!(raised(AlarmCause::Flood).count(), 1);
    let flood = desk
        .alarms()
        .find(|alarm| alarm.cause == AlarmCause::Flood)
        .unwrap();
    assert_eq!((flood.motor.as_ref(), flood.size), (None, Some(40.0)));
    // Fifty lost links, and a fault stands for itself.
    let fault = desk.take(&motors[3], &second(2_000, FAULT, 4));
    assert_eq!(
        steps(&fault),
        [(Change::Raised, AlarmState::Unacknowledged)]
    );
    assert!(desk.tick(600_000).is_empty());
    let over = desk.tick(601_001);
    let back = over.iter().filter(|c| c.change == Change::Unsuppressed);
    assert_eq!(
        back.map(|c| c.alarm.state)
            .filter(|s| *s == AlarmState::Unacknowledged)
            .count(),
        40
    );
    let last = over.last().unwrap();
    assert_eq!(
        (last.alarm.cause, last.change),
        (AlarmCause::Flood, Change::Returned)
    );
    let open = desk
        .alarms()
        .filter(|a| a.state == AlarmState::Unacknowledged)
        .count();
    assert_eq!(open, 51, "every one of them waits for somebody");
}

/// What can happen in a plant of three motors.
#[derive(Clone, Debug)]
enum Step {
    Second(usize, bool, bool),
    Link(usize, bool),
    Tick,
    Acknowledge(u64),
    Shelve(u64, i64),
    Unshelve(u64),
    Restart,
}

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        4 => (0_usize..3, any::<bool>(), any::<bool>()).prop_map(|(m, on, judged)| Step::Second(m, on, judged)),
        2 => (0_usize..3, any::<bool>()).prop_map(|(m, up)| Step::Link(m, up)),
        2 => Just(Step::Tick),
        2 => (1_u64..12).prop_map(Step::Acknowledge),
        1 => (1_u64..12, 1_i64..20_000).prop_map(|(n, ms)| Step::Shelve(n, ms)),
        1 => (1_u64..12).prop_map(Step::Unshelve),
        1 => Just(Step::Restart),
    ]
}

fn run(desk: &mut Desk, motors: &[MotorId], step: &Step, now: i64) -> Vec<AlarmChange> {
    let act =
        |desk: &mut Desk, n, action| desk.act(n, &action, "eva", "why", now).unwrap_or_default();
    match step {
        Step::Second(m, on, judged) => desk.take(
            &motors[*m],
            &second(now, if *on { FAULT } else { 0 }, u8::from(*judged)),
        ),
        Step::Link(m, up) => desk.take(&motors[*m], &link(now, *up)),
        Step::Tick => desk.tick(now),
        Step::Acknowledge(n) => act(desk, *n, Action::Acknowledge),
        Step::Shelve(n, ms) => act(desk, *n, Action::Shelve { until_ms: now + ms }),
        Step::Unshelve(n) => act(desk, *n, Action::Unshelve),
        Step::Restart => Vec::new(),
    }
}

/// A desk from what a store would hold: alarms and memory as text.
fn restarted(desk: &Desk, stored: &HashMap<u64, String>, rules: &Rules) -> Desk {
    let memory = serde_json::to_string(desk.memory()).unwrap();
    let alarms = stored
        .values()
        .map(|text| serde_json::from_str::<Alarm>(text).unwrap())
        .collect();
    Desk::new(
        rules.clone(),
        alarms,
        serde_json::from_str(&memory).unwrap(),
    )
}

proptest! {
    /// The truth of each condition is kept apart, by the words of the rules alone: FAULT is there from a lit lamp until a
    /// dark one of a judged motor, a link as it was last told.
    #[test]
    fn no_path_loses_an_alarm(steps in proptest::collection::vec(step(), 1..120)) {
        let (rules, motors) = (at_once(), ["a", "b", "c"].map(id));
        let mut desk = desk(rules.clone());
        let mut truth: HashMap<(MotorId, AlarmCause), bool> = HashMap::new();
        // Of each number: is it there, did somebody acknowledge since it last rose.
        let mut seen: HashMap<u64, (bool, bool)> = HashMap::new();
        for (step, k) in steps.iter().zip(1..) {
            match step {
                Step::Second(m, on, judged) if *on || *judged => {
                    truth.insert((motors[*m].clone(), AlarmCause::Fault), *on);
                }
                Step::Link(m, up) => {
                    truth.insert((motors[*m].clone(), AlarmCause::LinkLost), !up);
                }
                _ => {}
            }
            for change in run(&mut desk, &motors, step, k * 1_000) {
                let known = seen.entry(change.alarm.number).or_insert((false, false));
                match change.change {
                    Change::Raised => *known = (true, false),
                    Change::Returned => known.0 = false,
                    Change::Acknowledged => known.1 = true,
                    _ => {}
                }
                let over = change.alarm.state == AlarmState::Normal;
                prop_assert!(!over || *known == (false, true), "{change:?}");
            }
            for ((motor, cause), on) in &truth {
                let is = |a: &&Alarm| a.motor.as_ref() == Some(motor) && a.cause == *cause;
                let found: Vec<_> = desk.alarms().filter(is).collect();
                prop_assert!(found.len() <= 1);
                prop_assert_eq!(found.first().is_some_and(|a| a.present), *on);
            }
            let waiting = seen.iter().filter(|(_, (there, known))| *there || !known).count();
            prop_assert_eq!(desk.alarms().filter(|a| a.shelved_until_ms.is_none() || a.present || !a.acknowledged).count(), waiting);
        }
    }

    #[test]
    fn a_restart_at_any_moment_goes_on_the_same(
        steps in proptest::collection::vec(step(), 1..120),
        off_delay_ms in 0_i64..8_000,
        link_delay_ms in 0_i64..8_000,
        flood_alarms in 1_usize..5,
        latch: bool,
    ) {
        let rules = Rules { off_delay_ms, link_delay_ms, flood_alarms, flood_window_ms: 20_000, latch, ..Rules::default() };
        let motors = ["a", "b", "c"].map(id);
        let (mut one, mut other) = (desk(rules.clone()), desk(rules.clone()));
        let mut stored: HashMap<u64, String> = HashMap::new();
        for (step, k) in steps.iter().zip(1..) {
            if let Step::Restart = step {
                other = restarted(&other, &stored, &rules);
            }
            let (changes, same) = (run(&mut one, &motors, step, k * 1_000), run(&mut other, &motors, step, k * 1_000));
            // NaN is no equal of itself: compared as text.
            prop_assert_eq!(format!("{changes:?}"), format!("{same:?}"));
            for change in &same {
                stored.insert(change.alarm.number, serde_json::to_string(&change.alarm).unwrap());
            }
        }
    }

    #[test]
    fn twice_is_once(steps in proptest::collection::vec(step(), 1..60), number in 1_u64..12) {
        let motors = ["a", "b", "c"].map(id);
        let mut desk = desk(at_once());
        for (step, k) in steps.iter().zip(1..) {
            run(&mut desk, &motors, step, k * 1_000);
        }
        for action in [Action::Acknowledge, Action::Shelve { until_ms: 70_000 }, Action::Unshelve] {
            let now = 61_000;
            if desk.act(number, &action, "eva", "why", now).is_ok() {
                let again = desk.act(number, &action, "max", "why", now).unwrap_or_default();
                prop_assert!(again.is_empty(), "{action:?}: {again:?}");
            }
        }
    }
}
