//! What an entry of the store says about the conditions of alarms.

use super::change::{AlarmCause, Evidence, Severity, Who};
use crate::entry::{BoardEvent, Entry, Gap, GapOf, Link, Second};
use crate::lamp;

/// Causes of the board's events (`board::EventCause`).
mod cause {
    pub const START: u16 = 2;
    pub const FAULT_ON: u16 = 3;
    pub const FAULT_OFF: u16 = 4;
    pub const SENSOR_ON: u16 = 5;
    pub const SENSOR_OFF: u16 = 6;
    pub const DOUBT: u16 = 7;
}

/// What is known of a condition beside that it is there.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Details {
    pub severity: Severity,
    pub fault: u8,
    pub size: Option<f32>,
    pub evidence: Evidence,
    pub who: Who,
}

/// A condition that an entry tells.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Told {
    pub cause: AlarmCause,
    pub on: bool,
    pub details: Details,
    /// Seconds tell what is now, an event what was: it does not overrule seconds.
    pub by_event: bool,
}

impl Told {
    fn new(cause: AlarmCause, on: bool, who: Who, words: &str) -> Self {
        let severity = match cause {
            AlarmCause::Fault => Severity::High,
            AlarmCause::Sensor => Severity::Medium,
            _ => Severity::Low,
        };
        let evidence = Evidence {
            words: words.to_owned(),
            ..Evidence::default()
        };
        let details = Details {
            severity,
            fault: 0,
            size: None,
            evidence,
            who,
        };
        Self {
            cause,
            on,
            details,
            by_event: false,
        }
    }
}

/// All conditions that an entry tells. What an entry does not tell stays as it is.
pub(super) fn conditions(entry: &Entry) -> Vec<Told> {
    match entry {
        Entry::Second(second) => of_second(second),
        Entry::Event(event) => of_event(event),
        Entry::Link(link) => vec![of_link(link)],
        Entry::Gap(gap) => vec![of_gap(gap)],
        Entry::Alarm(_) | Entry::Recording(_) | Entry::Board { .. } | Entry::Thinned(_) => vec![],
    }
}

fn of_second(second: &Second) -> Vec<Told> {
    let gap_over = Told::new(AlarmCause::Gap, false, Who::Gateway, "seconds come again");
    let lamps = [
        (AlarmCause::Fault, lamp::FAULT, "FAULT"),
        (AlarmCause::Sensor, lamp::SENSOR, "SENSOR"),
    ];
    let told = lamps
        .into_iter()
        .filter_map(|(cause, place, name)| of_lamp(second, cause, place, name));
    told.chain([gap_over]).collect()
}

fn of_lamp(second: &Second, cause: AlarmCause, place: u32, name: &str) -> Option<Told> {
    let on = second.is_on(place);
    // A dark lamp of a motor that is not judged says nothing: it may stand still with its fault.
    if !on && second.judged == 0 {
        return None;
    }
    let state = if on {
        "on"
    } else {
        "dark while the motor is judged"
    };
    let mut told = Told::new(cause, on, Who::Board, &format!("lamp {name} {state}"));
    let details = &mut told.details;
    details.evidence.second = Some((second.start, second.number));
    // Text has no NaN: what is not finite is not known.
    let known = |residuals: [f32; 4]| residuals.map(|r| Some(r).filter(|r| r.is_finite()));
    details.evidence.residuals = second.residuals.map(known).unwrap_or_default();
    if cause == AlarmCause::Fault {
        details.fault = second.fault;
        details.size = second.residuals.and_then(largest);
    }
    Some(told)
}

fn largest(residuals: [f32; 4]) -> Option<f32> {
    residuals
        .into_iter()
        .map(f32::abs)
        .filter(|r| r.is_finite())
        .reduce(f32::max)
}

fn of_event(event: &BoardEvent) -> Vec<Told> {
    let [first, second] = event.values;
    let told = |cause, on, words: &str| {
        let mut told = Told::new(cause, on, Who::Board, words);
        told.details.evidence.event = Some(event.number);
        told.by_event = true;
        told
    };
    match event.cause {
        cause::FAULT_ON => {
            let words = match second {
                0 => "FAULT lit".to_owned(),
                second => format!("FAULT lit, probability {:.1} %", f64::from(second) / 10.0),
            };
            let mut fault = told(AlarmCause::Fault, true, &words);
            fault.details.fault = u8::try_from(first).unwrap_or(0);
            vec![fault]
        }
        cause::FAULT_OFF => vec![told(AlarmCause::Fault, false, "FAULT went out")],
        cause::SENSOR_ON => {
            let words = format!("SENSOR lit, reason {first}, doubts {second:#x}");
            vec![told(AlarmCause::Sensor, true, &words)]
        }
        cause::SENSOR_OFF => vec![told(AlarmCause::Sensor, false, "SENSOR went out")],
        cause::DOUBT => {
            let words = format!("the board doubts itself: bits {second:#x}, new {first:#x}");
            vec![told(AlarmCause::Doubt, second != 0, &words)]
        }
        // A start tests everything again: what is still doubted is told again.
        cause::START => vec![told(AlarmCause::Doubt, false, "the board started")],
        _ => vec![],
    }
}

fn of_link(link: &Link) -> Told {
    let words = if link.up {
        "the board answers"
    } else {
        &link.why
    };
    Told::new(AlarmCause::LinkLost, !link.up, Who::Gateway, words)
}

fn of_gap(gap: &Gap) -> Told {
    let Gap {
        what, first, last, ..
    } = gap;
    let what = match what {
        GapOf::Seconds { start } => format!("seconds of start {start}"),
        GapOf::Events => "events".to_owned(),
        GapOf::Frames => "frames".to_owned(),
    };
    let words = format!("{what}, {first} to {last}, are missing");
    let mut told = Told::new(AlarmCause::Gap, true, Who::Gateway, &words);
    let missing = i64::from(*last) - i64::from(*first) + 1;
    told.details.size = Some(missing.max(0) as f32);
    told
}
