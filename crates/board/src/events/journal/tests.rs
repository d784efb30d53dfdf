//! When something becomes an event.

use super::*;
use crate::learn::Refusal;

/// What is written when the journal is asked every second until `until_s`.
fn written(journal: &mut Journal, from_s: u32, until_s: u32) -> Vec<(u32, EventCause, u16)> {
    let mut events = Vec::new();
    for now_s in from_s..=until_s {
        while let Some(event) = journal.due(now_s) {
            journal.settle(event.cause, now_s);
            events.push((now_s, event.cause, event.times));
        }
    }
    events
}

#[test]
fn a_change_is_one_event_and_its_end_another() {
    let mut journal = Journal::default();
    let lit = Situation {
        fault: true,
        likely: (4, 930),
        ..Situation::default()
    };
    journal.look(&Situation::default());
    assert!(!journal.is_waiting());
    journal.look(&lit);
    journal.look(&lit);
    let event = journal.due(7).expect("an event");
    assert_eq!((event.cause, event.uptime_s), (EventCause::FaultOn, 7));
    assert_eq!((event.values, event.times), ([4, 930], 1));
    journal.settle(event.cause, 7);
    assert!(!journal.is_waiting());
    journal.look(&Situation::default());
    assert_eq!(written(&mut journal, 8, 8), [(8, EventCause::FaultOff, 1)]);
}

#[test]
fn a_lamp_that_flickers_is_written_once_a_minute_and_counted() {
    let mut journal = Journal::default();
    let lit = Situation {
        sensor: true,
        ..Situation::default()
    };
    let mut events = Vec::new();
    for now_s in 0..150 {
        journal.look(&lit);
        journal.look(&Situation::default());
        events.extend(written(&mut journal, now_s, now_s));
    }
    let on: Vec<_> = events
        .iter()
        .filter(|(_, cause, _)| *cause == EventCause::SensorOn)
        .map(|(at, _, times)| (*at, *times))
        .collect();
    assert_eq!(on, [(0, 1), (60, 60), (120, 60)]);
    // Nothing is forgotten: what came since is written when the minute is over.
    let last = written(&mut journal, 150, 200);
    assert!(last.contains(&(180, EventCause::SensorOn, 29)), "{last:?}");
}

#[test]
fn what_waits_longest_comes_first() {
    let mut journal = Journal::default();
    journal.note(EventCause::SamplesMissing, [1, 0]);
    assert!(journal.due(3).is_some());
    journal.note(EventCause::Start, [1, 0]);
    let causes: Vec<_> = written(&mut journal, 4, 4)
        .into_iter()
        .map(|(_, cause, _)| cause)
        .collect();
    assert_eq!(causes, [EventCause::SamplesMissing, EventCause::Start]);
}

#[test]
fn doubts_of_one_minute_are_collected() {
    let mut journal = Journal::default();
    for doubts in [0b1, 0b11, 0b10, 0b110] {
        journal.look(&Situation {
            doubts,
            ..Situation::default()
        });
    }
    let event = journal.due(0).expect("an event");
    assert_eq!((event.values, event.times), ([0b111, 0b110], 3));
}

#[test]
fn learning_tells_its_outcome() {
    let mut journal = Journal::default();
    let learning = |learning| Situation {
        learning,
        calibration: 0xABCD,
        ..Situation::default()
    };
    journal.look(&learning(LearnState::Learning));
    journal.look(&learning(LearnState::Stored));
    journal.look(&learning(LearnState::Refused(Refusal::Offset)));
    let values = |journal: &mut Journal| {
        let event = journal.due(0).expect("an event");
        journal.settle(event.cause, 0);
        (event.cause, event.values)
    };
    assert_eq!(values(&mut journal), (EventCause::LearnBegun, [0, 0]));
    assert_eq!(values(&mut journal), (EventCause::Learnt, [0xABCD, 0]));
    assert_eq!(values(&mut journal), (EventCause::LearnRefused, [21, 0]));
}
