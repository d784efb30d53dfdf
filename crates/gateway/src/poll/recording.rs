//! The samples around an alarm: fetched from the board in pieces, stored, and released so that the next alarm has some too.

use board::{CAPTURE_BYTES, CAPTURE_HEAD_BYTES, CaptureHead, CaptureState};
use fleet::alarm::AlarmFilter;
use fleet::{Entry, Recording, RecordingKey, now_ms};
use tokio::sync::oneshot;

use super::context::Context;
use super::motor::Watched;
use super::tally::Post;
use super::trouble::Trouble;
use super::wanted::{APART_S, UnderWay, Wanted};
use crate::bus::{Bus, BusError};
use crate::wire::question::{self, Head};

/// Pieces of one visit: others on the link wait meanwhile.
const PIECES: usize = 8;
/// Half a recording, ms.
const HALF_MS: i64 = 128;

const TOO_OLD: &str = "the program of its board gives out no recordings over Modbus; flash it with the program of this version";
const OTHER_LAYOUT: &str = "its board gives out recordings of another layout; use the gateway of the version with which the board was flashed";
const LOST_POWER: &str =
    "its board started again before the recording was fetched; it lies in memory";
const GIVEN_UP: &str = "it was given up at the board before it was fetched: its button was pressed, or a master acknowledged";
const HELD_ANOTHER: &str =
    "its board still held the recording of an earlier alarm, which nobody had fetched yet";

/// Fetches what there is, a few pieces at a visit.
pub(super) async fn take_recording(
    bus: &mut Bus,
    motor: &mut Watched,
    head: &Head,
    context: &Context,
) -> Result<(), Trouble> {
    if !motor.recordings.is_settled() {
        recall(motor, head, context);
    }
    let idle = motor.recordings.wanted.is_empty() && motor.recordings.is_settled();
    if idle && motor.recordings.under_way.is_none() {
        return Ok(());
    }
    let answer = match bus.ask(motor.unit, &question::capture_head()).await {
        Err(error) if error.is_busy() => return Ok(()),
        Err(error) if error.is_unknown() => return give_up(motor, TOO_OLD, context).await,
        answer => answer?,
    };
    let bytes = question::file_of(&answer).and_then(|bytes| bytes.try_into().ok());
    let bytes: [u8; CAPTURE_HEAD_BYTES] = bytes.ok_or(BusError::Damaged(motor.unit))?;
    let Some(capture) = CaptureHead::from_bytes(&bytes) else {
        return give_up(motor, OTHER_LAYOUT, context).await;
    };
    match capture.state {
        CaptureState::Taking => Ok(()),
        CaptureState::Armed => nothing_there(motor, head, context).await,
        CaptureState::Complete => take_complete(bus, motor, head, capture, context).await,
    }
}

fn recall(motor: &mut Watched, head: &Head, context: &Context) {
    let filter = AlarmFilter {
        motor: Some(motor.id.clone()),
        ..AlarmFilter::default()
    };
    // A store that cannot be read now is asked at the next visit.
    let alarms = context.store.alarms(&filter).unwrap_or_default();
    motor.recordings.recall(&alarms, head.start);
}

/// A board without recordings: each alarm gets the reason.
async fn give_up(motor: &mut Watched, why: &str, context: &Context) -> Result<(), Trouble> {
    motor.recordings.under_way = None;
    for wanted in std::mem::take(&mut motor.recordings.wanted) {
        tell_missing(motor, wanted, why, context).await?;
    }
    motor.recordings.settled += 1;
    Ok(())
}

/// The board waits for its next alarm: what was wanted is stored already, or will never come.
async fn nothing_there(motor: &mut Watched, head: &Head, context: &Context) -> Result<(), Trouble> {
    let recordings = &mut motor.recordings;
    recordings.under_way = None;
    recordings.settled += 1;
    if recordings.settled == 1 {
        // An alarm may be about to get what is stored already.
        recordings.wanted.clear();
        return Ok(());
    }
    let released = recordings.released;
    for wanted in std::mem::take(&mut recordings.wanted) {
        let why = match wanted.start == head.start {
            true if wanted.is_before(released) => HELD_ANOTHER,
            true => GIVEN_UP,
            false => LOST_POWER,
        };
        tell_missing(motor, wanted, why, context).await?;
    }
    Ok(())
}

async fn take_complete(
    bus: &mut Bus,
    motor: &mut Watched,
    head: &Head,
    capture: CaptureHead,
    context: &Context,
) -> Result<(), Trouble> {
    let key = key_of(&capture);
    let stored = context.store.recording_of(&motor.id, key);
    let stored = stored.map_err(|error| Trouble::Other(error.to_string()))?;
    if stored.is_none_or(|samples| samples.instants.is_none()) {
        let Some(instants) = take_pieces(bus, motor, capture).await? else {
            return Ok(());
        };
        store(motor, capture, instants, context).await?;
    }
    motor.recordings.under_way = None;
    let alarm = capture.alarm;
    let recordings = &mut motor.recordings;
    recordings
        .wanted
        .retain(|wanted| !wanted.is(alarm.start, alarm.second));
    recordings.released = Some((head.start, head.last_second));
    // What else is wanted gets its reason when nothing is there any more. Where this fails the board is asked again: what is stored is then released only.
    motor.recordings.settled = 0;
    bus.ask(motor.unit, &question::release_capture()).await?;
    motor.recordings.settled += 1;
    Ok(())
}

/// The instants, once all of them are there.
async fn take_pieces(
    bus: &mut Bus,
    motor: &mut Watched,
    capture: CaptureHead,
) -> Result<Option<Vec<u8>>, BusError> {
    let begun = motor.recordings.under_way.take();
    let mut under_way = begun
        .filter(|under_way| under_way.head == capture)
        .unwrap_or_else(|| UnderWay {
            head: capture,
            instants: Vec::with_capacity(CAPTURE_BYTES),
        });
    const WHOLE: usize = CAPTURE_BYTES - CAPTURE_HEAD_BYTES;
    for _ in 0..PIECES {
        if under_way.instants.len() >= WHOLE {
            break;
        }
        let question = question::capture_piece(CAPTURE_HEAD_BYTES + under_way.instants.len());
        let answer = match bus.ask(motor.unit, &question).await {
            // It was given up meanwhile: the next visit sees that.
            Err(error) if error.is_busy() => return Ok(None),
            answer => answer?,
        };
        let piece = question::file_of(&answer).ok_or(BusError::Damaged(motor.unit))?;
        under_way.instants.extend_from_slice(piece);
    }
    if under_way.instants.len() < WHOLE {
        motor.recordings.under_way = Some(under_way);
        return Ok(None);
    }
    Ok(Some(under_way.instants))
}

fn key_of(capture: &CaptureHead) -> RecordingKey {
    RecordingKey::Second {
        start: capture.alarm.start,
        second: capture.alarm.second,
    }
}

async fn store(
    motor: &Watched,
    capture: CaptureHead,
    samples: Vec<u8>,
    context: &Context,
) -> Result<(), Trouble> {
    let alarm = capture.alarm;
    let mut wanted = motor.recordings.wanted.iter();
    let wanted = wanted.find(|wanted| wanted.is(alarm.start, alarm.second));
    let by_clock = || {
        let this_run = motor.run == Some(alarm.start);
        this_run.then(|| motor.clock.time_ms(alarm.second))?
    };
    // The time that the alarm has, also where the clock was set since.
    let time_ms = wanted.map(|wanted| wanted.time_ms).or_else(by_clock);
    let time_ms = time_ms.unwrap_or_else(now_ms);
    let recording = Recording {
        time_ms: now_ms(),
        from_ms: time_ms - HALF_MS,
        to_ms: time_ms + HALF_MS,
        key: key_of(&capture),
        bytes: samples.len() as u64,
        motor: capture.alarm.motor,
        samples,
        ..Recording::default()
    };
    post(motor, recording, context).await
}

/// Tells why an alarm has no recording, unless it has one.
async fn tell_missing(
    motor: &Watched,
    wanted: Wanted,
    why: &str,
    context: &Context,
) -> Result<(), Trouble> {
    let (start, own) = (wanted.start, wanted.second.unwrap_or(0));
    for second in own.saturating_sub(APART_S)..=own.saturating_add(APART_S) {
        let key = RecordingKey::Second { start, second };
        let known = context.store.recording_of(&motor.id, key);
        let known = known.map_err(|error| Trouble::Other(error.to_string()))?;
        if known.is_some() {
            return Ok(());
        }
    }
    let recording = Recording {
        time_ms: now_ms(),
        from_ms: wanted.time_ms,
        to_ms: wanted.time_ms,
        key: RecordingKey::Second { start, second: own },
        missing: Some(why.to_owned()),
        ..Recording::default()
    };
    post(motor, recording, context).await
}

/// Stores a recording; on return it is on the disk.
async fn post(motor: &Watched, recording: Recording, context: &Context) -> Result<(), Trouble> {
    let (durable, is_durable) = oneshot::channel();
    let post = Post {
        motor: motor.id.clone(),
        entries: vec![Entry::Recording(recording)],
        durable: Some(durable),
    };
    context.posts.send(post).await.map_err(|_| Trouble::Ended)?;
    is_durable.await.map_err(|_| Trouble::Ended)
}
