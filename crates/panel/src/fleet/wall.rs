//! The wall: every motor with its condition and its most urgent alarm, the worst first.

use std::collections::HashMap;

use fleet::alarm::{Alarm, AlarmState, Severity};
use fleet::{MotorId, MotorState};

use super::answers::{Counts, Tile, TileAlarm, Wall};
use super::convert;
use super::words::{Condition, condition};

/// Ranks of what an alarm alone asks for; those of conditions lie between.
mod rank {
    pub const HIGH_NEW: u32 = 0;
    pub const FAULT: u32 = 1;
    pub const HIGH_GONE: u32 = 2;
    pub const HIGH_SEEN: u32 = 3;
    pub const SET_ASIDE: u32 = 4;
    pub const MEDIUM_NEW: u32 = 5;
    pub const ATTENTION: u32 = 6;
    pub const MEDIUM_SEEN: u32 = 7;
    pub const LOW_NEW: u32 = 8;
    pub const STALE: u32 = 9;
    pub const LOW_SEEN: u32 = 10;
    pub const NEVER: u32 = 11;
    pub const NOT_JUDGED: u32 = 12;
    pub const OFF: u32 = 13;
    pub const HEALTHY: u32 = 14;
}

/// The wall at `now_ms`; `alarms` are those that are not normal.
pub(super) fn wall(motors: &[MotorState], alarms: &[Alarm], now_ms: i64, stale_ms: i64) -> Wall {
    let mut of_motor: HashMap<&MotorId, Vec<&Alarm>> = HashMap::new();
    for alarm in alarms {
        if let Some(motor) = &alarm.motor {
            of_motor.entry(motor).or_default().push(alarm);
        }
    }
    let tile = |state: &MotorState| {
        let alarms = of_motor.get(&state.info.id).map_or(&[][..], Vec::as_slice);
        tile(state, alarms, now_ms, stale_ms)
    };
    let mut motors: Vec<_> = motors.iter().map(tile).collect();
    motors.sort_by(|a, b| order(a).cmp(&order(b)));
    Wall {
        now_ms,
        counts: counts(&motors, alarms),
        motors,
    }
}

/// The worst first; of equals what rose last.
fn order(tile: &Tile) -> (u32, i64, &str) {
    let raised_ms = tile.alarm.as_ref().map_or(0, |alarm| alarm.raised_ms);
    (tile.rank, -raised_ms, &tile.id)
}

fn tile(state: &MotorState, alarms: &[&Alarm], now_ms: i64, stale_ms: i64) -> Tile {
    let (condition, words) = condition(state, now_ms, stale_ms);
    let worst = alarms.iter().min_by_key(|alarm| of_alarm(alarm));
    let by_alarm = worst.map_or(rank::HEALTHY, |alarm| of_alarm(alarm));
    // What people set aside does not come back to the top by its lamp.
    let by_lamp = match (condition, worst) {
        (Condition::Fault, Some(alarm)) if is_known(alarm) => rank::SET_ASIDE,
        _ => of_condition(condition),
    };
    Tile {
        id: state.info.id.to_string(),
        title: state.info.title.clone(),
        place: state.info.place.clone(),
        rank: by_alarm.min(by_lamp),
        condition,
        words,
        alarm: worst.map(|alarm| TileAlarm {
            number: alarm.number,
            state: convert::state(alarm.state),
            severity: convert::severity(alarm.severity),
            words: convert::about(alarm),
            raised_ms: alarm.raised_ms,
        }),
        open_alarms: state.open_alarms,
        last: state.last.as_ref().map(convert::latest),
    }
}

/// Acknowledged, shelved or suppressed.
fn is_known(alarm: &Alarm) -> bool {
    use AlarmState::{Acknowledged, Shelved, Suppressed};
    matches!(alarm.state, Acknowledged | Shelved | Suppressed)
}

fn of_condition(condition: Condition) -> u32 {
    match condition {
        Condition::Fault => rank::FAULT,
        Condition::Sensor | Condition::Supply | Condition::Overload => rank::ATTENTION,
        Condition::Stale => rank::STALE,
        Condition::Never => rank::NEVER,
        Condition::NotJudged => rank::NOT_JUDGED,
        Condition::Off => rank::OFF,
        Condition::Healthy => rank::HEALTHY,
    }
}

fn of_alarm(alarm: &Alarm) -> u32 {
    match (alarm.severity, alarm.state) {
        (_, AlarmState::Normal) => rank::HEALTHY,
        (_, AlarmState::Shelved | AlarmState::Suppressed) if alarm.severity == Severity::High => {
            rank::SET_ASIDE
        }
        (_, AlarmState::Shelved | AlarmState::Suppressed) => rank::NEVER,
        (Severity::High, AlarmState::Unacknowledged) => rank::HIGH_NEW,
        (Severity::High, AlarmState::ReturnedUnacknowledged) => rank::HIGH_GONE,
        (Severity::High, AlarmState::Acknowledged) => rank::HIGH_SEEN,
        (Severity::Medium, AlarmState::Acknowledged) => rank::MEDIUM_SEEN,
        (Severity::Medium, _) => rank::MEDIUM_NEW,
        (Severity::Low, AlarmState::Acknowledged) => rank::LOW_SEEN,
        (Severity::Low, _) => rank::LOW_NEW,
    }
}

fn counts(motors: &[Tile], alarms: &[Alarm]) -> Counts {
    let mut counts = Counts {
        motors: motors.len() as u32,
        ..Counts::default()
    };
    for tile in motors {
        *match tile.condition {
            Condition::Fault => &mut counts.fault,
            Condition::Sensor | Condition::Supply | Condition::Overload => &mut counts.attention,
            Condition::Stale | Condition::Never => &mut counts.stale,
            Condition::NotJudged => &mut counts.not_judged,
            Condition::Off => &mut counts.off,
            Condition::Healthy => &mut counts.healthy,
        } += 1;
    }
    for alarm in alarms {
        use AlarmState::{ReturnedUnacknowledged, Shelved, Suppressed, Unacknowledged};
        match alarm.state {
            Unacknowledged | ReturnedUnacknowledged => counts.unacknowledged += 1,
            Shelved | Suppressed => counts.set_aside += 1,
            _ => {}
        }
    }
    counts
}

/// Whether a person sees a difference. Numbers of a motor whose data are fresh change every second; the wall does not show them.
pub(super) fn differs(a: &Tile, b: &Tile) -> bool {
    let last_ms = |tile: &Tile| tile.last.as_ref().map(|last| last.time_ms);
    let old = matches!(a.condition, Condition::Stale);
    (a.rank, a.condition, a.open_alarms) != (b.rank, b.condition, b.open_alarms)
        || (&a.words, &a.alarm, &a.title, &a.place) != (&b.words, &b.alarm, &b.title, &b.place)
        || old && last_ms(a) != last_ms(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fleet::alarm::{AlarmCause, Evidence};
    use fleet::{MotorInfo, Second};

    const NOW: i64 = 1_790_000_000_000;
    const HEALTHY: u32 = 1;
    const FAULT: u32 = 1 | 1 << 16;

    fn motor(name: &str, lamps: u32, age_ms: i64) -> MotorState {
        let time_ms = NOW - age_ms;
        let second = Second {
            time_ms,
            lamps,
            windows: 50,
            judged: 50,
            fault: 1,
            ..Second::default()
        };
        MotorState {
            info: MotorInfo::new(name.parse().expect("a name")),
            last: Some(second),
            last_event: 0,
            link: None,
            open_alarms: 0,
            unacknowledged: 0,
            worst: None,
        }
    }

    fn alarm(number: u64, motor: &str, severity: Severity, state: AlarmState) -> Alarm {
        Alarm {
            number,
            motor: Some(motor.parse().expect("a name")),
            cause: AlarmCause::Fault,
            state,
            present: true,
            acknowledged: state == AlarmState::Acknowledged,
            suppressed: state == AlarmState::Suppressed,
            severity,
            fault: 1,
            size: Some(0.1),
            evidence: Evidence::default(),
            raised_ms: NOW - number as i64,
            changed_ms: NOW,
            times: 1,
            shelved_until_ms: None,
        }
    }

    #[test]
    fn the_worst_is_first_and_every_motor_counts_once() {
        use AlarmState::{Acknowledged, ReturnedUnacknowledged, Shelved, Unacknowledged};
        let motors = [
            motor("a-healthy", HEALTHY, 0),
            motor("b-old", HEALTHY, 60_000),
            motor("c-seen", FAULT, 0),
            motor("d-new", FAULT, 0),
            motor("e-gone", HEALTHY, 0),
            motor("f-sensor", 1 | 1 << 10, 0),
            motor("g-shelved", FAULT, 0),
            motor("h-old-fault", FAULT, 60_000),
            motor("i-lamp-only", FAULT, 0),
        ];
        let alarms = [
            alarm(1, "c-seen", Severity::High, Acknowledged),
            alarm(2, "d-new", Severity::High, Unacknowledged),
            alarm(3, "e-gone", Severity::High, ReturnedUnacknowledged),
            alarm(4, "f-sensor", Severity::Medium, Unacknowledged),
            alarm(5, "g-shelved", Severity::High, Shelved),
            alarm(6, "h-old-fault", Severity::High, Unacknowledged),
        ];
        let wall = wall(&motors, &alarms, NOW, 10_000);
        let order: Vec<_> = wall.motors.iter().map(|tile| tile.id.as_str()).collect();
        let expected = [
            "d-new",
            "h-old-fault",
            "i-lamp-only",
            "e-gone",
            "c-seen",
            "g-shelved",
            "f-sensor",
            "b-old",
            "a-healthy",
        ];
        assert_eq!(order, expected);
        let Counts {
            motors: all,
            fault,
            attention,
            stale,
            not_judged,
            off,
            healthy,
            unacknowledged,
            set_aside,
        } = wall.counts;
        assert_eq!((fault, attention, stale, healthy), (4, 1, 2, 2));
        assert_eq!(all, fault + attention + stale + not_judged + off + healthy);
        assert_eq!((unacknowledged, set_aside), (4, 1));
        // What is old is not shown as a fault of now, and its alarm stays.
        let old = &wall.motors[1];
        assert_eq!(old.condition, Condition::Stale);
        assert_eq!(old.alarm.as_ref().map(|alarm| alarm.number), Some(6));
    }

    #[test]
    fn new_numbers_of_a_healthy_motor_are_no_news() {
        let of = |lamps, age| {
            wall(&[motor("a", lamps, age)], &[], NOW, 10_000)
                .motors
                .remove(0)
        };
        assert!(!differs(&of(HEALTHY, 0), &of(HEALTHY, 1_000)));
        assert!(differs(&of(FAULT, 0), &of(HEALTHY, 0)));
        assert!(differs(&of(HEALTHY, 60_000), &of(HEALTHY, 0)));
    }
}
