//! How an entry of the store becomes values of metrics.

use board::EventCause;
use fleet::alarm::{Alarm, AlarmChange, Who};
use fleet::{BoardEvent, Entry, Gap, GapOf, Link, MotorInfo, Recording, Second, Thinned};
use motor::FaultId;
use serde::Serialize;

use super::metrics::Group;
use super::value::Value;

/// Values of a group at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Update {
    /// Of which metrics.
    pub group: Group,
    /// When, Unix ms.
    pub time_ms: i64,
    /// A value of each metric of the group, in their order; `None`: there is none.
    pub values: Vec<Option<Value>>,
}

/// Names of enumerations as the store and the JSON answers write them.
fn word(value: impl Serialize) -> Option<Value> {
    match serde_json::to_value(value) {
        Ok(serde_json::Value::String(text)) => Some(Value::Text(text)),
        _ => None,
    }
}

fn text(value: &str) -> Option<Value> {
    Some(Value::Text(value.to_owned()))
}

fn small(value: impl Into<u16>) -> Option<Value> {
    Some(Value::Small(value.into()))
}

fn large(value: impl Into<u64>) -> Option<Value> {
    Some(Value::Large(value.into()))
}

fn time(ms: i64) -> Option<Value> {
    u64::try_from(ms).ok().map(Value::Large)
}

fn number(value: Option<f32>) -> Option<Value> {
    value.and_then(Value::number)
}

/// The update of an entry.
pub fn of_entry(entry: &Entry) -> Update {
    let (group, values) = match entry {
        Entry::Second(second) => (Group::Second, second_values(second)),
        Entry::Event(event) => (Group::Event, event_values(event)),
        Entry::Gap(gap) => (Group::Gap, gap_values(gap)),
        Entry::Link(link) => (Group::Link, link_values(link)),
        Entry::Alarm(change) => (Group::Alarm, change_values(change)),
        Entry::Recording(recording) => (Group::Recording, recording_values(recording)),
        Entry::Board { serial, .. } => (Group::Board, vec![text(serial)]),
        Entry::Thinned(thinned) => (Group::Thinned, thinned_values(thinned)),
    };
    Update {
        group,
        time_ms: entry.time_ms(),
        values,
    }
}

/// What a birth says of a motor beside its state.
pub fn info_values(info: &MotorInfo) -> Vec<Option<Value>> {
    vec![
        text(&info.title),
        text(&info.nameplate),
        text(&info.place),
        text(&info.link),
        info.motor_file.as_deref().and_then(text),
    ]
}

/// Values of [`Group::Second`].
pub fn second_values(second: &Second) -> Vec<Option<Value>> {
    let mut values = vec![large(second.start), large(second.number)];
    values.extend((0..board::LAMPS as u32).map(|lamp| small(second.lamp(lamp))));
    values.extend(
        [
            second.windows,
            second.judged,
            second.not_judged,
            second.fault,
        ]
        .map(small),
    );
    let residuals = second.residuals.unwrap_or([f32::NAN; 4]);
    values.extend(residuals.map(Value::number));
    values.extend(
        [
            second.voltage_v,
            second.current_a,
            second.frequency_hz,
            second.speed_rpm,
        ]
        .map(number),
    );
    values
}

fn event_values(event: &BoardEvent) -> Vec<Option<Value>> {
    let words = EventCause::by_number(event.cause).map(EventCause::label);
    vec![
        large(event.number),
        small(event.cause),
        words.and_then(text),
        small(event.times),
        large(event.values[0]),
        large(event.values[1]),
    ]
}

fn gap_values(gap: &Gap) -> Vec<Option<Value>> {
    let (of, start) = match gap.what {
        GapOf::Seconds { start } => ("seconds", Some(start)),
        GapOf::Events => ("events", None),
        GapOf::Frames => ("frames", None),
    };
    vec![
        text(of),
        start.and_then(large),
        large(gap.first),
        large(gap.last),
    ]
}

/// Values of [`Group::Link`].
pub fn link_values(link: &Link) -> Vec<Option<Value>> {
    vec![Some(Value::Boolean(link.up)), text(&link.why)]
}

fn change_values(change: &AlarmChange) -> Vec<Option<Value>> {
    let mut values = alarm_values(&change.alarm);
    let who = match &change.who {
        Who::Board => text("board"),
        Who::Gateway => text("gateway"),
        Who::User(name) => text(name),
    };
    values[1] = word(change.change);
    values[11] = who;
    values[12] = text(&change.why);
    values
}

/// Values of [`Group::Alarm`] of an alarm of which the last change is not at hand: what, who and why are no values.
pub fn alarm_values(alarm: &Alarm) -> Vec<Option<Value>> {
    let fault = FaultId::ALL
        .into_iter()
        .find(|fault| fault.number() == u16::from(alarm.fault));
    vec![
        large(alarm.number),
        None,
        word(alarm.state),
        word(alarm.cause),
        word(alarm.severity),
        Some(Value::Boolean(alarm.present)),
        fault.map(FaultId::name).and_then(text),
        number(alarm.size),
        large(alarm.times),
        time(alarm.raised_ms),
        None,
        None,
        text(&alarm.evidence.words),
    ]
}

fn recording_values(recording: &Recording) -> Vec<Option<Value>> {
    vec![
        text(&recording.file).filter(|_| recording.missing.is_none()),
        large(recording.bytes),
        time(recording.from_ms),
        time(recording.to_ms),
        recording.missing.as_deref().and_then(text),
    ]
}

fn thinned_values(thinned: &Thinned) -> Vec<Option<Value>> {
    vec![
        word(thinned.to),
        time(thinned.before_ms),
        large(thinned.count),
        text(&thinned.why),
    ]
}
