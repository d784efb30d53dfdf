//! From what is stored to what the API answers.

use board::EventCause;
use fleet::alarm::{AlarmCause, AlarmChange, AlarmState, Change, Severity, Who};
use fleet::people::Trail;
use fleet::{Entry, GapOf, Numbered, Second, ThinnedTo, Values};

use super::answers::{Alarm, AuditLine, Band, Event, Latest, Trend};
use super::words::likely;

/// Lamps of the panel door.
const LAMPS: u32 = 9;

pub(super) fn latest(second: &Second) -> Latest {
    let mut lamps = [0; LAMPS as usize];
    for (place, lamp) in (0..LAMPS).zip(&mut lamps) {
        *lamp = second.lamp(place);
    }
    Latest {
        time_ms: second.time_ms,
        lamps,
        residuals_percent: percents(second.residuals.map_or([None; 4], |r| r.map(Some))),
        voltage_v: second.voltage_v,
        current_a: second.current_a,
        frequency_hz: second.frequency_hz,
        speed_rpm: second.speed_rpm,
    }
}

/// Shares as percent; what is not finite is not known.
fn percents(shares: [Option<f32>; 4]) -> [Option<f32>; 4] {
    shares.map(|share| {
        share
            .filter(|share| share.is_finite())
            .map(|share| 100.0 * share)
    })
}

pub(super) fn state(state: AlarmState) -> &'static str {
    match state {
        AlarmState::Normal => "normal",
        AlarmState::Unacknowledged => "unacknowledged",
        AlarmState::Acknowledged => "acknowledged",
        AlarmState::ReturnedUnacknowledged => "returned_unacknowledged",
        AlarmState::Shelved => "shelved",
        AlarmState::Suppressed => "suppressed",
    }
}

pub(super) fn severity(severity: Severity) -> &'static str {
    match severity {
        Severity::Low => "low",
        Severity::Medium => "medium",
        Severity::High => "high",
    }
}

/// What an alarm is about.
pub(super) fn about(alarm: &fleet::alarm::Alarm) -> String {
    match alarm.cause {
        AlarmCause::Fault => format!("fault: {}", likely(alarm.fault)),
        AlarmCause::Sensor => "an instrument is faulty".to_owned(),
        AlarmCause::Doubt => "the board doubts itself".to_owned(),
        AlarmCause::LinkLost => "the board does not answer".to_owned(),
        AlarmCause::Gap => "data are missing".to_owned(),
        AlarmCause::Flood => "many alarms at once".to_owned(),
    }
}

pub(super) fn alarm(alarm: &fleet::alarm::Alarm) -> Alarm {
    let cause = match alarm.cause {
        AlarmCause::Fault => "fault",
        AlarmCause::Sensor => "sensor",
        AlarmCause::Doubt => "doubt",
        AlarmCause::LinkLost => "link_lost",
        AlarmCause::Gap => "gap",
        AlarmCause::Flood => "flood",
    };
    let size = alarm.size.filter(|_| alarm.cause == AlarmCause::Fault);
    Alarm {
        number: alarm.number,
        motor: alarm.motor.as_ref().map(ToString::to_string),
        cause,
        words: about(alarm),
        state: state(alarm.state),
        severity: severity(alarm.severity),
        present: alarm.present,
        size_percent: size.map(|size| 100.0 * size),
        evidence: alarm.evidence.words.clone(),
        residuals_percent: percents(alarm.evidence.residuals),
        recording: alarm.evidence.recording.clone(),
        no_recording: alarm.why_no_recording(),
        raised_ms: alarm.raised_ms,
        changed_ms: alarm.changed_ms,
        times: alarm.times,
        shelved_until_ms: alarm.shelved_until_ms,
    }
}

/// An entry of the store; `None` of a second.
pub(super) fn event(stored: &Numbered) -> Option<Event> {
    let (kind, words) = match &stored.entry {
        Entry::Second(_) => return None,
        Entry::Event(event) => ("board", of_board(event)),
        Entry::Gap(gap) => ("gap", of_gap(gap)),
        Entry::Link(link) if link.up => ("link", "the board answers".to_owned()),
        Entry::Link(link) => ("link", format!("the board does not answer: {}", link.why)),
        Entry::Alarm(change) => ("alarm", of_change(change)),
        Entry::Recording(recording) => ("recording", of_recording(recording)),
        Entry::Board { serial, .. } => ("exchange", format!("another board: {serial}")),
        Entry::Thinned(thinned) => ("history", of_thinned(thinned)),
    };
    let change = match &stored.entry {
        Entry::Alarm(change) => Some(change),
        _ => None,
    };
    let who = change.and_then(|change| match &change.who {
        Who::User(name) => Some(name.clone()),
        _ => None,
    });
    let why = change.filter(|_| who.is_some());
    let why = why.map(|change| change.why.clone());
    Some(Event {
        id: stored.id,
        motor: stored.motor.as_ref().map(ToString::to_string),
        time_ms: stored.entry.time_ms(),
        kind,
        words,
        who,
        why: why.filter(|why| !why.is_empty()),
    })
}

fn of_board(event: &fleet::BoardEvent) -> String {
    let Some(cause) = EventCause::by_number(event.cause) else {
        return format!("event of cause {}", event.cause);
    };
    let label = cause.label();
    let times = match event.times {
        0 | 1 => String::new(),
        times => format!(", {times} times"),
    };
    match cause {
        EventCause::FaultOn => {
            let fault = u8::try_from(event.values[0]).unwrap_or(0);
            format!("{label}: {}{times}", likely(fault))
        }
        _ => format!("{label}{times}"),
    }
}

fn of_gap(gap: &fleet::Gap) -> String {
    let what = match gap.what {
        GapOf::Seconds { .. } => "seconds",
        GapOf::Events => "events",
        GapOf::Frames => "frames",
    };
    format!("{what} {} to {} are missing", gap.first, gap.last)
}

fn of_change(change: &AlarmChange) -> String {
    let what = match change.change {
        Change::Raised => "rose",
        Change::Returned => "is over",
        Change::Updated => "changed",
        Change::Acknowledged => "acknowledged",
        Change::Shelved => "shelved",
        Change::Unshelved => "no longer shelved",
        Change::Suppressed => "suppressed",
        Change::Unsuppressed => "no longer suppressed",
    };
    format!(
        "alarm {} {what}: {}",
        change.alarm.number,
        about(&change.alarm)
    )
}

fn of_recording(recording: &fleet::Recording) -> String {
    match &recording.missing {
        Some(why) => format!("no recording: {why}"),
        None => format!("recording {}", recording.file),
    }
}

fn of_thinned(thinned: &fleet::Thinned) -> String {
    let what = match thinned.to {
        ThinnedTo::Minutes => "seconds became minutes",
        ThinnedTo::Hours => "minutes were dropped, hours are left",
        ThinnedTo::HoursDropped => "hours were dropped",
        ThinnedTo::RecordingsDropped => "recordings of alarms were dropped",
        ThinnedTo::QueueCut => "seconds left the queue of an output",
        ThinnedTo::EntriesDropped => "old events were dropped",
    };
    format!("{what}: {}", thinned.why)
}

pub(super) fn audit_line(line: Trail) -> AuditLine {
    let (done, outcome) = line.outcome.map(|o| (o.done, o.words)).unzip();
    AuditLine {
        id: line.id,
        time_ms: line.time_ms,
        who: line.who,
        what: line.what,
        alarm: line.alarm,
        why: line.why,
        done,
        outcome: outcome.unwrap_or_default(),
    }
}

pub(super) fn trend(trend: &fleet::Trend) -> Trend {
    let points = &trend.points;
    let band = |of: &dyn Fn(&fleet::TrendPoint) -> Option<Values>, factor: f32| {
        let mut band = Band::default();
        for values in points.iter().map(of) {
            band.min.push(values.map(|v| factor * v.min));
            band.mean.push(values.map(|v| factor * v.mean));
            band.max.push(values.map(|v| factor * v.max));
        }
        band
    };
    Trend {
        step_ms: trend.step_ms,
        time_ms: points.iter().map(|point| point.from_ms).collect(),
        lamps: points.iter().map(|point| point.lamps).collect(),
        seconds: points.iter().map(|point| point.seconds).collect(),
        residuals_percent: [0, 1, 2, 3].map(|k| band(&|point| point.residuals[k], 100.0)),
        voltage_v: band(&|point| point.voltage_v, 1.0),
        current_a: band(&|point| point.current_a, 1.0),
        frequency_hz: band(&|point| point.frequency_hz, 1.0),
        speed_rpm: band(&|point| point.speed_rpm, 1.0),
    }
}
