//! What a motor's newest second says, in the words of the panel door.

use fleet::{MotorState, Second, lamp};
use motor::FaultId;
use schemars::JsonSchema;
use serde::Serialize;

/// What is known of a motor now, the most urgent first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// FAULT is lit.
    Fault,
    /// SENSOR is lit: an instrument.
    Sensor,
    /// LINE is lit while the motor runs: voltage out of range, or unbalance.
    Supply,
    /// LOAD is lit: more than the rated torque.
    Overload,
    /// Nothing came for so long that nothing is known.
    Stale,
    /// Nothing ever came.
    Never,
    /// The motor runs and is not judged now.
    NotJudged,
    /// No supply: switched off, or a fuse.
    Off,
    /// Judged, and every residual within its threshold.
    Healthy,
}

/// The condition of a motor at `now_ms`, and what it rests on in a few words.
pub(super) fn condition(state: &MotorState, now_ms: i64, stale_ms: i64) -> (Condition, String) {
    let Some(last) = &state.last else {
        let why = state.link.as_ref().filter(|link| !link.up);
        let why = why.map_or("nothing came yet", |link| &link.why);
        return (Condition::Never, why.to_owned());
    };
    if let Some(link) = state.link.as_ref().filter(|link| !link.up) {
        return (Condition::Stale, link.why.clone());
    }
    if now_ms.saturating_sub(last.time_ms) > stale_ms {
        return (Condition::Stale, "no data".to_owned());
    }
    of_second(last)
}

/// As the panel of one motor says it: docs/lamps.md.
fn of_second(second: &Second) -> (Condition, String) {
    let lit = |place| second.is_on(place);
    let not_judged = || replay::words::reason(second.not_judged).unwrap_or_default();
    if lit(lamp::FAULT) {
        return (Condition::Fault, likely(second.fault));
    }
    if lit(lamp::SENSOR) {
        return (Condition::Sensor, not_judged());
    }
    let off = second.lamp(lamp::RUN) == 0 && second.judged == 0;
    if off {
        return (Condition::Off, not_judged());
    }
    if lit(lamp::LINE) {
        return (Condition::Supply, not_judged());
    }
    if lit(lamp::LOAD) {
        return (Condition::Overload, "more than the rated torque".to_owned());
    }
    if second.judged == 0 {
        return (Condition::NotJudged, not_judged());
    }
    let beyond = (0..4).filter(|k| lit(lamp::RESIDUALS + k));
    let beyond: Vec<_> = beyond.map(|k| format!("r{}", k + 1)).collect();
    let words = match beyond.is_empty() {
        true => String::new(),
        false => format!("{} beyond the threshold", beyond.join(" ")),
    };
    (Condition::Healthy, words)
}

/// A likely fault with those that show the same residuals: the four lamps cannot tell them apart.
pub(super) fn likely(number: u8) -> String {
    let all = FaultId::ALL;
    let found = all.into_iter().find(|f| f.number() == u16::from(number));
    let Some(fault) = found.filter(|fault| *fault != FaultId::Unknown) else {
        return "cause not named by the board".to_owned();
    };
    let pattern = fault.published_pattern();
    let tied = |other: &FaultId| {
        *other == fault || pattern.is_some() && other.published_pattern() == pattern
    };
    let words: Vec<_> = all.into_iter().filter(tied).map(FaultId::words).collect();
    words.join(" or ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use fleet::{Link, MotorInfo};

    const NOW: i64 = 1_790_000_000_000;

    /// Lamps by place with their state.
    fn lamps(lit: &[(u32, u32)]) -> u32 {
        lit.iter()
            .fold(0, |all, (lamp, state)| all | state << (2 * lamp))
    }

    fn of(lamps: u32, judged: u8, not_judged: u8) -> Condition {
        let second = Second {
            lamps,
            judged,
            not_judged,
            windows: 50,
            ..Second::default()
        };
        of_second(&second).0
    }

    #[test]
    fn a_lamp_that_blinks_is_no_finding() {
        let run = (lamp::RUN, 1);
        assert_eq!(of(lamps(&[run]), 50, 0), Condition::Healthy);
        assert_eq!(of(lamps(&[run, (lamp::FAULT, 1)]), 50, 0), Condition::Fault);
        assert_eq!(
            of(lamps(&[run, (lamp::FAULT, 2)]), 50, 0),
            Condition::Healthy
        );
        assert_eq!(
            of(lamps(&[(lamp::RUN, 2), (lamp::LOAD, 2)]), 0, 10),
            Condition::NotJudged
        );
        assert_eq!(of(lamps(&[(lamp::LINE, 2)]), 0, 1), Condition::Off);
        assert_eq!(of(lamps(&[run, (lamp::LINE, 1)]), 50, 0), Condition::Supply);
        assert_eq!(
            of(lamps(&[(lamp::RUN, 2), (lamp::SENSOR, 1)]), 0, 9),
            Condition::Sensor
        );
        assert_eq!(
            of(lamps(&[run, (lamp::LOAD, 1)]), 50, 0),
            Condition::Overload
        );
    }

    #[test]
    fn old_data_are_stale_whatever_they_said() {
        let second = Second {
            time_ms: NOW - 9_000,
            lamps: 1,
            judged: 1,
            windows: 1,
            ..Second::default()
        };
        let mut state = MotorState {
            info: MotorInfo::new("a".parse().expect("a name")),
            last: Some(second),
            last_event: 0,
            link: None,
            open_alarms: 0,
            unacknowledged: 0,
            worst: None,
        };
        assert_eq!(condition(&state, NOW, 10_000).0, Condition::Healthy);
        let (stale, why) = condition(&state, NOW + 2_000, 10_000);
        assert_eq!((stale, why.as_str()), (Condition::Stale, "no data"));
        // A link that is down says so at once.
        state.link = Some(Link {
            up: false,
            time_ms: NOW,
            why: "no answer".to_owned(),
        });
        let (stale, why) = condition(&state, NOW, 10_000);
        assert_eq!((stale, why.as_str()), (Condition::Stale, "no answer"));
        state.last = None;
        assert_eq!(condition(&state, NOW, 10_000).0, Condition::Never);
    }

    #[test]
    fn faults_that_look_alike_are_named_together() {
        assert_eq!(likely(1), "stator resistance or rotor resistance");
        assert_eq!(likely(2), likely(1));
        assert_eq!(likely(13), "broken rotor bars");
        assert_eq!(likely(0), "cause not named by the board");
        assert_eq!(likely(200), likely(0));
    }
}
