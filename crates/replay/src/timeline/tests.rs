//! What a whole recording comes to where little of it was judged.

use super::*;
use monitor::RotorReading;

/// A replay of 1197 windows: four are the first cycles, `judged` were judged at rest, the rest were transient.
fn mostly_transient(judged: u64) -> Timeline {
    let share = |reason, windows| NotJudgedShare {
        reason: Unjudged::ByCore(reason),
        windows,
    };
    Timeline {
        windows: 1197,
        judged,
        not_judged: vec![
            share(NotJudged::Transient, 1193 - judged),
            share(NotJudged::Settling, 4),
        ],
        ..Timeline::default()
    }
}

fn judged_in_motion(judged: u64) -> MotionSummary {
    MotionSummary {
        judged,
        windows: 1000,
        ..MotionSummary::default()
    }
}

/// A fifth of 1193 windows is 239.
#[test]
fn less_than_a_fifth_of_the_running_motor_is_not_called_healthy() {
    let state = |at_rest: u64, in_motion: u64| {
        let timeline = mostly_transient(at_rest);
        timeline.state(VerdictState::Healthy, &judged_in_motion(in_motion))
    };
    assert_eq!(state(238, 0), VerdictState::NotJudged);
    assert_eq!(state(239, 0), VerdictState::Healthy);
    assert_eq!(state(113, 126), VerdictState::Healthy);
    let few = mostly_transient(113).too_few(&MotionSummary::default());
    assert_eq!(few, Some([113, 1193]));
    let fault = mostly_transient(1).state(VerdictState::Fault, &MotionSummary::default());
    assert_eq!(fault, VerdictState::Fault);
}

/// A minute without supply asks for nothing.
#[test]
fn a_motor_that_stands_is_not_running() {
    let mut timeline = mostly_transient(239);
    timeline.windows += 3000;
    timeline.not_judged.push(NotJudgedShare {
        reason: Unjudged::ByCore(NotJudged::NotLocked),
        windows: 3000,
    });
    assert_eq!(timeline.too_few(&MotionSummary::default()), None);
}

/// FAULT was raised at rest and no window there could be judged: what was judged in motion does not clear it.
#[test]
fn motion_clears_no_alarm_of_windows_at_rest() {
    let mut timeline = mostly_transient(0);
    let motion = judged_in_motion(900);
    let at_rest = timeline.verdict(&[]).state;
    assert_eq!(timeline.state(at_rest, &motion), VerdictState::Healthy);
    timeline.first_alarm_s = Some(1.0);
    let at_rest = timeline.verdict(&[]).state;
    assert_eq!(timeline.state(at_rest, &motion), VerdictState::NotJudged);
}

/// They shake every window, so that none is judged.
#[test]
fn broken_bars_are_a_fault_where_no_window_was_judged() {
    let mut timeline = mostly_transient(0);
    timeline.first_alarm_s = Some(1.0);
    assert_eq!(timeline.verdict(&[]).state, VerdictState::NotJudged);
    timeline.rotor.add(&RotorReading {
        is_broken: true,
        ..RotorReading::default()
    });
    assert_eq!(timeline.verdict(&[]).state, VerdictState::Fault);
}
