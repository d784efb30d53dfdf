//! Blocks of history: some minutes of seconds, or an hour of minutes, of one motor.

use super::pack::{of_float, pack, to_float, unpack};
use super::tally::{QUANTITIES, Spread, Tally};
use crate::entry::Second;
use crate::store::StoreError;
use crate::store::seconds::{all_steps, residuals_of};

/// Level of a block in its table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Level {
    /// Seconds.
    Seconds = 0,
    /// Minutes.
    Minutes = 1,
}

/// Milliseconds of a minute.
pub(super) const MINUTE_MS: i64 = 60_000;
/// Milliseconds of an hour.
pub(super) const HOUR_MS: i64 = 3_600_000;
/// Milliseconds of a day.
pub(super) const DAY_MS: i64 = 86_400_000;

/// No block lasts longer: who looks for a time knows how far before it a block may begin.
pub(super) const LONGEST_MS: i64 = HOUR_MS;

/// Stands for a residual that is not known, as on the wire.
const NONE: i64 = i16::MIN as i64;

/// A block.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Block {
    /// Time of its first row, Unix ms.
    pub from_ms: i64,
    /// Tells blocks apart that begin at the same time.
    pub first: i64,
    /// Time of its last row, Unix ms.
    pub to_ms: i64,
    /// Rows.
    pub count: usize,
    /// The rows, packed.
    pub body: Vec<u8>,
}

/// A minute that was thinned.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Minute {
    /// Begin, Unix ms.
    pub from_ms: i64,
    /// What it holds.
    pub tally: Tally,
}

fn unreadable(first: i64) -> StoreError {
    let reason = "a block of history is damaged".to_owned();
    StoreError::Damaged {
        id: first as u64,
        reason,
    }
}

fn row_of_second(second: &Second) -> [i64; 16] {
    let [r1, r2, r3, r4] = all_steps(second).map(|r| r.map_or(NONE, i64::from));
    let float = |x: Option<f32>| of_float(x.unwrap_or(f32::NAN));
    [
        second.start.into(),
        second.number.into(),
        second.time_ms,
        second.lamps.into(),
        second.windows.into(),
        second.judged.into(),
        second.not_judged.into(),
        second.fault.into(),
        r1,
        r2,
        r3,
        r4,
        float(second.voltage_v),
        float(second.current_a),
        float(second.frequency_hz),
        float(second.speed_rpm),
    ]
}

fn second_of_row(row: &[i64; 16]) -> Second {
    let [
        start,
        number,
        time_ms,
        lamps,
        windows,
        judged,
        not_judged,
        fault,
        rest @ ..,
    ] = *row;
    let [r1, r2, r3, r4, floats @ ..] = rest;
    let steps = [r1, r2, r3, r4].map(|r| (r != NONE).then_some(r as i16));
    let [voltage_v, current_a, frequency_hz, speed_rpm] =
        floats.map(|x| Some(to_float(x)).filter(|x| !x.is_nan()));
    Second {
        start: start as u32,
        number: number as u32,
        time_ms,
        lamps: lamps as u32,
        windows: windows as u8,
        judged: judged as u8,
        not_judged: not_judged as u8,
        fault: fault as u8,
        residuals: residuals_of(steps),
        voltage_v,
        current_a,
        frequency_hz,
        speed_rpm,
    }
}

/// Seconds of one motor, in the order of time, as blocks of at most an hour.
pub(super) fn of_seconds(seconds: &[Second], first: i64) -> std::io::Result<Vec<Block>> {
    let mut blocks = Vec::new();
    let mut rest = seconds;
    while let Some(begin) = rest.first() {
        let end = begin.time_ms + LONGEST_MS;
        let (now, later) = rest.split_at(rest.partition_point(|s| s.time_ms < end));
        let rows: Vec<_> = now.iter().map(row_of_second).collect();
        blocks.push(Block {
            from_ms: begin.time_ms,
            first: first + blocks.len() as i64,
            to_ms: now.last().map_or(begin.time_ms, |s| s.time_ms),
            count: now.len(),
            body: pack(&rows)?,
        });
        rest = later;
    }
    Ok(blocks)
}

/// The seconds of a block.
pub(super) fn seconds_of(block: &Block) -> Result<Vec<Second>, StoreError> {
    let rows = unpack(&block.body, block.count).ok_or_else(|| unreadable(block.first))?;
    Ok(rows.iter().map(second_of_row).collect())
}

/// Columns of a minute: time, four counts, and four of each quantity.
const MINUTE_WIDTH: usize = 5 + 4 * QUANTITIES;

fn row_of_minute(minute: &Minute) -> [i64; MINUTE_WIDTH] {
    let Minute { from_ms, tally } = minute;
    let mut row = [0; MINUTE_WIDTH];
    let counts = [tally.seconds, tally.windows, tally.judged, tally.lamps].map(i64::from);
    row[0] = from_ms / MINUTE_MS;
    row[1..5].copy_from_slice(&counts);
    for (columns, spread) in row[5..].chunks_exact_mut(4).zip(&tally.quantities) {
        let mean = (spread.sum / f64::from(spread.count.max(1))) as f32;
        let floats = [spread.min, mean, spread.max].map(of_float);
        columns[0] = spread.count.into();
        columns[1..].copy_from_slice(&floats);
    }
    row
}

fn minute_of_row(row: &[i64; MINUTE_WIDTH]) -> Minute {
    let mut tally = Tally {
        seconds: row[1] as u32,
        windows: row[2] as u32,
        judged: row[3] as u32,
        lamps: row[4] as u32,
        ..Tally::default()
    };
    for (columns, spread) in row[5..].chunks_exact(4).zip(&mut tally.quantities) {
        let count = columns[0] as u32;
        let sum = f64::from(to_float(columns[2])) * f64::from(count);
        *spread = Spread {
            count,
            min: to_float(columns[1]),
            sum,
            max: to_float(columns[3]),
        };
    }
    Minute {
        from_ms: row[0] * MINUTE_MS,
        tally,
    }
}

/// Minutes of one hour of one motor as a block.
pub(super) fn of_minutes(minutes: &[Minute], first: i64) -> std::io::Result<Option<Block>> {
    let (Some(begin), Some(end)) = (minutes.first(), minutes.last()) else {
        return Ok(None);
    };
    let rows: Vec<_> = minutes.iter().map(row_of_minute).collect();
    let (from_ms, to_ms, count) = (begin.from_ms, end.from_ms, minutes.len());
    Ok(Some(Block {
        from_ms,
        first,
        to_ms,
        count,
        body: pack(&rows)?,
    }))
}

/// The minutes of a block.
pub(super) fn minutes_of(block: &Block) -> Result<Vec<Minute>, StoreError> {
    let rows = unpack(&block.body, block.count).ok_or_else(|| unreadable(block.first))?;
    Ok(rows.iter().map(minute_of_row).collect())
}

/// Bytes of an hour: four counts, then of each quantity count, least, sum, largest.
const HOUR_BYTES: usize = 16 + 20 * QUANTITIES;

/// An hour as bytes, little-endian and exact: it is added to many times.
pub(super) fn bytes_of_hour(tally: &Tally) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HOUR_BYTES);
    for count in [tally.seconds, tally.windows, tally.judged, tally.lamps] {
        bytes.extend(count.to_le_bytes());
    }
    for spread in &tally.quantities {
        bytes.extend(spread.count.to_le_bytes());
        bytes.extend(spread.min.to_le_bytes());
        bytes.extend(spread.sum.to_le_bytes());
        bytes.extend(spread.max.to_le_bytes());
    }
    bytes
}

/// An hour from its bytes.
pub(super) fn hour_of_bytes(bytes: &[u8]) -> Option<Tally> {
    let (counts, quantities) = bytes.split_at_checked(16)?;
    let mut counts = counts
        .chunks_exact(4)
        .map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]]));
    let mut tally = Tally {
        seconds: counts.next()?,
        windows: counts.next()?,
        judged: counts.next()?,
        lamps: counts.next()?,
        ..Tally::default()
    };
    if quantities.len() != 20 * QUANTITIES {
        return None;
    }
    for (bytes, spread) in quantities.chunks_exact(20).zip(&mut tally.quantities) {
        *spread = Spread {
            count: u32::from_le_bytes(bytes[0..4].try_into().ok()?),
            min: f32::from_le_bytes(bytes[4..8].try_into().ok()?),
            sum: f64::from_le_bytes(bytes[8..16].try_into().ok()?),
            max: f32::from_le_bytes(bytes[16..20].try_into().ok()?),
        };
    }
    Some(tally)
}
