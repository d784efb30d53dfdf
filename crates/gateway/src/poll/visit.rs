//! One visit of a board: whatever it has that is not stored yet.

use board::{Event, Second};
use fleet::{BoardEvent, Entry, GapOf, now_ms};
use tokio::sync::oneshot;

use super::clock::Clock;
use super::context::Context;
use super::motor::{self, Wanted, Watched, gap};
use super::recording::take_recording;
use super::tally::Post;
use super::trouble::Trouble;
use super::wanted::Recordings;
use crate::bus::{Bus, BusError};
use crate::wire::question::{self, Head, Question};

/// Asks a board who it is and what its newest numbers are.
pub(crate) async fn knock(bus: &mut Bus, unit: u8) -> Result<Head, BusError> {
    let answer = bus.ask(unit, &question::head()).await?;
    question::head_of(&answer).ok_or(BusError::Damaged(unit))
}

/// Visits a board: events first, then seconds.
pub(super) async fn visit(
    bus: &mut Bus,
    motor: &mut Watched,
    context: &Context,
) -> Result<(), Trouble> {
    let head = knock(bus, motor.unit).await?;
    let now = now_ms();
    let identity = motor.identity_of(&head).map_err(Trouble::Other)?;
    if motor.identity.as_ref() != Some(&identity) {
        meet(motor, &head, identity, context).await?;
    }
    if let Some(why) = motor.contradiction(&head) {
        return Err(Trouble::Other(why));
    }
    motor.enter(head.start);
    motor.clock.observe(now, head.last_second);
    take_events(bus, motor, &head, context).await?;
    take_seconds(bus, motor, &head, context).await?;
    take_recording(bus, motor, &head, context).await
}

/// A board that is seen for the first time since the gateway began, or another one than before.
async fn meet(
    motor: &mut Watched,
    head: &Head,
    identity: String,
    context: &Context,
) -> Result<(), Trouble> {
    let known = motor.second.is_some() || motor.event > 0;
    let entry = Entry::Board {
        serial: identity.clone(),
        time_ms: now_ms(),
    };
    let (durable, is_durable) = oneshot::channel();
    let post = Post {
        motor: motor.id.clone(),
        entries: vec![entry],
        durable: Some(durable),
    };
    context.posts.send(post).await.map_err(|_| Trouble::Ended)?;
    is_durable.await.map_err(|_| Trouble::Ended)?;
    context.recall(motor);
    if known && motor.second.is_none() && motor.event == 0 {
        // What the new board went through elsewhere is not this motor's.
        motor.event = head.start.saturating_sub(1);
        (motor.run, motor.before) = (None, None);
        let told = format!("motor {}: another board, {identity}", motor.id);
        (context.say)(told);
    }
    motor.recordings = Recordings::of_stored(context.last.get(&motor.id));
    motor.identity = Some(identity);
    Ok(())
}

async fn take_events(
    bus: &mut Bus,
    motor: &mut Watched,
    head: &Head,
    context: &Context,
) -> Result<(), Trouble> {
    if head.last_event <= motor.event {
        return Ok(());
    }
    let answer = bus.ask(motor.unit, &question::uptime()).await?;
    let uptime = question::uptime_of(&answer).ok_or(BusError::Damaged(motor.unit))?;
    let begin_ms = now_ms() - 1_000 * i64::from(uptime);
    let wanted = motor::events(motor.event, head);
    let ask = |from, to| question::events(from, to);
    let fetched = fetch(bus, motor.unit, &wanted, ask, question::events_of).await;
    let numbered = match fetched {
        // A page of the log is being erased.
        Err(error) if error.is_busy() => return Ok(()),
        fetched => fetched?,
    };
    let found = numbered.into_iter().map(|(number, event)| {
        let event = event.filter(|event| event.number == number);
        (number, event)
    });
    let found: Vec<_> = found.collect();
    let runs = motor.passed_runs(head, found.iter().filter_map(|(_, event)| event.as_ref()));
    let first = motor.event == 0;
    let times = Times {
        head,
        begin_ms,
        before: motor.before,
    };
    let mut entries = wanted.gaps(now_ms());
    // Before the first contact nothing was promised: what a ring had forgotten by then is no gap.
    let found = found
        .into_iter()
        .skip_while(|(_, event)| first && event.is_none());
    entries.extend(with_gaps(found, GapOf::Events, |event| {
        Entry::Event(times.event(&event))
    }));
    // In one batch with the events: who has these never asks for them again.
    entries.extend(
        runs.iter()
            .map(|(what, first, last)| gap(*what, *first, *last, now_ms())),
    );
    motor.event = head.last_event;
    send(motor, entries, context).await
}

async fn take_seconds(
    bus: &mut Bus,
    motor: &mut Watched,
    head: &Head,
    context: &Context,
) -> Result<(), Trouble> {
    let wanted = motor::seconds(motor.second, head);
    let ask = |from, to| question::seconds(from, to);
    let numbered = fetch(bus, motor.unit, &wanted, ask, question::seconds_of).await?;
    let clock = motor.clock;
    let what = GapOf::Seconds { start: head.start };
    let found = numbered.into_iter().map(|(number, second)| {
        let same = |second: &Second| (second.start, second.number) == (head.start, number);
        (number, second.filter(same))
    });
    let mut entries = wanted.gaps(now_ms());
    entries.extend(with_gaps(found, what, |second| {
        let time_ms = clock.time_ms(second.number).unwrap_or_else(now_ms);
        Entry::Second(stored(&second, time_ms))
    }));
    if !entries.is_empty() || motor.second.is_none() {
        motor.second = (wanted.to > 0)
            .then_some((head.start, wanted.to))
            .or_else(|| motor.second.map(|(start, _)| (start, motor::UNKNOWN)));
    }
    for entry in &entries {
        if let Entry::Second(second) = entry {
            motor.recordings.look(second);
        }
    }
    send(motor, entries, context).await
}

async fn send(motor: &Watched, entries: Vec<Entry>, context: &Context) -> Result<(), Trouble> {
    if entries.is_empty() {
        return Ok(());
    }
    let post = Post {
        motor: motor.id.clone(),
        entries,
        durable: None,
    };
    context.posts.send(post).await.map_err(|_| Trouble::Ended)
}

/// What lies in the places of the numbers that are wanted, each with the number that was asked for.
async fn fetch<T>(
    bus: &mut Bus,
    unit: u8,
    wanted: &Wanted,
    ask: impl Fn(u32, u32) -> (Question, u32),
    read: impl Fn(&[u8]) -> Option<Vec<Option<T>>>,
) -> Result<Vec<(u32, Option<T>)>, BusError> {
    let mut found = Vec::new();
    let mut number = wanted.from;
    while number <= wanted.to {
        let (question, count) = ask(number, wanted.to);
        let answer = bus.ask(unit, &question).await?;
        let records = read(&answer).ok_or(BusError::Damaged(unit))?;
        found.extend((number..).zip(records));
        number = number.saturating_add(count);
    }
    Ok(found)
}

/// What was found as entries, and a gap for each stretch of numbers that is missing.
fn with_gaps<T>(
    found: impl Iterator<Item = (u32, Option<T>)>,
    what: GapOf,
    entry: impl Fn(T) -> Entry,
) -> Vec<Entry> {
    let time_ms = now_ms();
    let mut entries = Vec::new();
    let mut missing: Option<(u32, u32)> = None;
    for (number, record) in found {
        match record {
            None => missing = Some((missing.map_or(number, |(first, _)| first), number)),
            Some(record) => {
                let lost = missing.take();
                entries.extend(lost.map(|(first, last)| gap(what, first, last, time_ms)));
                entries.push(entry(record));
            }
        }
    }
    entries.extend(missing.map(|(first, last)| gap(what, first, last, time_ms)));
    entries
}

/// When events were, as far as that can be told.
struct Times<'a> {
    head: &'a Head,
    begin_ms: i64,
    before: Option<(u32, Clock)>,
}

impl Times<'_> {
    /// An event of this run has its time; one of the run before, where its seconds told when it was. Any other happened
    /// before this run began, and that is the time it gets.
    fn event(&self, event: &Event) -> BoardEvent {
        let earlier = self.before.filter(|(start, _)| event.number >= *start);
        let time_ms = match earlier.and_then(|(_, clock)| clock.time_ms(event.uptime_s)) {
            _ if event.number >= self.head.start => {
                self.begin_ms + 1_000 * i64::from(event.uptime_s)
            }
            Some(time_ms) => time_ms.min(self.begin_ms),
            None => self.begin_ms,
        };
        BoardEvent {
            number: event.number,
            time_ms,
            cause: event.cause as u16,
            times: event.times,
            values: event.values,
        }
    }
}

/// A second as it is stored.
pub(super) fn stored(second: &Second, time_ms: i64) -> fleet::Second {
    let known = |value: f32| value.is_finite().then_some(value);
    fleet::Second {
        start: second.start,
        number: second.number,
        time_ms,
        lamps: second.lamps,
        windows: second.windows,
        judged: second.judged,
        not_judged: second.not_judged,
        fault: second.fault,
        residuals: second.residuals,
        voltage_v: known(second.voltage_volt),
        current_a: known(second.current_amp),
        frequency_hz: known(second.supply_hz),
        speed_rpm: known(second.speed_rpm),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_numbers_become_one_gap_a_stretch() {
        let found = [
            (5, None),
            (6, Some(6)),
            (7, None),
            (8, None),
            (9, Some(9)),
            (10, None),
        ];
        let entries = with_gaps(found.into_iter(), GapOf::Events, |number| {
            Entry::Event(BoardEvent {
                number,
                ..BoardEvent::default()
            })
        });
        let told: Vec<_> = entries
            .iter()
            .map(|entry| match entry {
                Entry::Gap(gap) => (gap.first, gap.last, false),
                Entry::Event(event) => (event.number, event.number, true),
                _ => panic!("nothing else was asked for"),
            })
            .collect();
        let expected = [
            (5, 5, false),
            (6, 6, true),
            (7, 8, false),
            (9, 9, true),
            (10, 10, false),
        ];
        assert_eq!(told, expected);
    }
}
