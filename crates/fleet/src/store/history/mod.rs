//! From the queue into the history: seconds of one motor come together in blocks, and are added to its hours.

mod block;
mod pack;
mod point;
mod tally;
mod thin;
mod trend;

use std::collections::{BTreeMap, HashMap};

use rusqlite::{Connection, OptionalExtension, Row, Transaction, params};

pub use point::{Trend, TrendPoint, Values};
pub(super) use trend::{first_ms, trend};

use super::{StoreError, seconds};
use crate::entry::Second;
use block::{Block, HOUR_MS, Level};
use tally::Tally;

/// Seconds that are sealed at once: some 60 MB of memory, and a block of a minute at 10 000 motors.
const MOST_AT_ONCE: u64 = 600_000;

/// What becomes history, ready to be written.
struct Sealed {
    /// It begins after this id ...
    after: u64,
    /// ... and ends with this one.
    up_to: u64,
    blocks: Vec<(i64, Block)>,
    hours: BTreeMap<(i64, i64), Tally>,
}

/// A number of the table `meta`; 0: not there.
fn meta(connection: &Connection, key: &str) -> rusqlite::Result<i64> {
    let mut statement = connection.prepare_cached("SELECT value FROM meta WHERE key = ?1")?;
    Ok(statement
        .query_row([key], |row| row.get(0))
        .optional()?
        .unwrap_or(0))
}

/// Writes a number of the table `meta`.
fn set_meta(tx: &Transaction<'_>, key: &str, value: i64) -> rusqlite::Result<()> {
    let mut statement =
        tx.prepare_cached("INSERT OR REPLACE INTO meta(key, value) VALUES (?1, ?2)")?;
    statement.execute(params![key, value])?;
    Ok(())
}

/// Id up to which the queue is history.
fn sealed(connection: &Connection) -> rusqlite::Result<u64> {
    Ok(meta(connection, "sealed")? as u64)
}

/// Number of seconds that are not history yet, at most, and when the oldest of them was.
fn waiting(connection: &Connection) -> rusqlite::Result<(u64, Option<i64>)> {
    let sealed = sealed(connection)?;
    let oldest = "SELECT time_ms FROM queue WHERE id > ?1 ORDER BY id LIMIT 1";
    let oldest = connection
        .query_row(oldest, [sealed as i64], |row| row.get(0))
        .optional()?;
    let last: Option<i64> =
        connection.query_row("SELECT max(id) FROM queue", [], |row| row.get(0))?;
    Ok(((last.unwrap_or(0) as u64).saturating_sub(sealed), oldest))
}

/// Reads and packs what is next. Committed seconds never change, so nobody is kept from writing meanwhile.
fn prepare(connection: &Connection) -> Result<Option<Sealed>, StoreError> {
    let after = sealed(connection)?;
    let Some((up_to, by_motor)) = next_seconds(connection, after)? else {
        return Ok(None);
    };
    let (mut blocks, mut hours) = (Vec::new(), BTreeMap::new());
    for (motor, (first, mut seconds)) in by_motor {
        seconds.sort_by_key(|second| second.time_ms);
        let packed = block::of_seconds(&seconds, first).map_err(packing)?;
        blocks.extend(packed.into_iter().map(|block| (motor, block)));
        for second in &seconds {
            let hour = second.time_ms.div_euclid(HOUR_MS);
            hours
                .entry((motor, hour))
                .or_insert_with(Tally::default)
                .second(second);
        }
    }
    // In the order of the table: pages are written one after the other.
    blocks.sort_by_key(|(motor, block)| (*motor, block.from_ms));
    Ok(Some(Sealed {
        after,
        up_to,
        blocks,
        hours,
    }))
}

/// Packing fails only without memory.
fn packing(error: std::io::Error) -> StoreError {
    StoreError::Damaged {
        id: 0,
        reason: error.to_string(),
    }
}

/// Seconds of each motor with the id of its first.
type ByMotor = HashMap<i64, (i64, Vec<Second>)>;

fn next_seconds(connection: &Connection, after: u64) -> Result<Option<(u64, ByMotor)>, StoreError> {
    let text = format!(
        "SELECT id, motor, {} FROM queue WHERE id > ?1 ORDER BY id LIMIT ?2",
        seconds::COLUMNS
    );
    let mut statement = connection.prepare_cached(&text)?;
    let mut rows = statement.query(params![after as i64, MOST_AT_ONCE as i64])?;
    let (mut last, mut by_motor) = (after as i64, ByMotor::new());
    while let Some(row) = rows.next()? {
        last = row.get(0)?;
        let (_, seconds) = by_motor.entry(row.get(1)?).or_insert((last, Vec::new()));
        seconds.push(seconds::second_of(row, 2)?);
    }
    Ok((last as u64 > after).then_some((last as u64, by_motor)))
}

/// Writes it. `false`: somebody else sealed meanwhile.
fn write(tx: &Transaction<'_>, sealed_now: &Sealed) -> Result<bool, StoreError> {
    if sealed(tx)? != sealed_now.after {
        return Ok(false);
    }
    for (motor, block) in &sealed_now.blocks {
        put(tx, *motor, Level::Seconds, block)?;
    }
    for ((motor, hour), tally) in &sealed_now.hours {
        add_to_hour(tx, *motor, *hour, tally)?;
    }
    set_meta(tx, "sealed", sealed_now.up_to as i64)?;
    Ok(true)
}

/// Writes a block.
fn put(tx: &Transaction<'_>, motor: i64, level: Level, block: &Block) -> rusqlite::Result<()> {
    let text = "INSERT INTO block(motor, level, from_ms, first, to_ms, count, body) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)";
    let Block {
        from_ms,
        first,
        to_ms,
        count,
        body,
    } = block;
    let mut statement = tx.prepare_cached(text)?;
    statement.execute(params![
        motor,
        level as i64,
        from_ms,
        first,
        to_ms,
        *count as i64,
        body
    ])?;
    Ok(())
}

fn add_to_hour(
    tx: &Transaction<'_>,
    motor: i64,
    hour: i64,
    tally: &Tally,
) -> Result<(), StoreError> {
    let mut before = tx.prepare_cached("SELECT body FROM hour WHERE motor = ?1 AND hour = ?2")?;
    let before: Option<Vec<u8>> = before
        .query_row([motor, hour], |row| row.get(0))
        .optional()?;
    let mut all = before
        .as_deref()
        .and_then(block::hour_of_bytes)
        .unwrap_or_default();
    all.merge(tally);
    let mut statement =
        tx.prepare_cached("INSERT OR REPLACE INTO hour(motor, hour, body) VALUES (?1, ?2, ?3)")?;
    statement.execute(params![motor, hour, block::bytes_of_hour(&all)])?;
    Ok(())
}

/// A block from `from_ms, first, to_ms, count, body`.
fn block_of(row: &Row<'_>) -> rusqlite::Result<Block> {
    Ok(Block {
        from_ms: row.get(0)?,
        first: row.get(1)?,
        to_ms: row.get(2)?,
        count: row.get::<_, u32>(3)? as usize,
        body: row.get(4)?,
    })
}

/// Blocks of a motor that reach into a time, in order.
fn blocks(
    connection: &Connection,
    motor: i64,
    level: Level,
    from_ms: i64,
    to_ms: i64,
    mut work: impl FnMut(&Block) -> Result<(), StoreError>,
) -> Result<(), StoreError> {
    let text = "SELECT from_ms, first, to_ms, count, body FROM block
         WHERE motor = ?1 AND level = ?2 AND from_ms > ?3 AND from_ms < ?4 AND to_ms >= ?5 ORDER BY from_ms, first";
    let mut statement = connection.prepare_cached(text)?;
    let earliest = from_ms.saturating_sub(block::LONGEST_MS);
    let mut rows = statement.query(params![motor, level as i64, earliest, to_ms, from_ms])?;
    while let Some(row) = rows.next()? {
        work(&block_of(row)?)?;
    }
    Ok(())
}

/// Seconds of a motor from `from_ms` to before `to_ms` that were not thinned. As of one moment where `connection` is within a
/// transaction: a second that becomes history meanwhile would come twice or not at all.
pub(super) fn seconds_between(
    connection: &Connection,
    motor: i64,
    from_ms: i64,
    to_ms: i64,
    mut work: impl FnMut(&Second) -> Result<(), StoreError>,
) -> Result<(), StoreError> {
    let mut within = |second: &Second| match (from_ms..to_ms).contains(&second.time_ms) {
        true => work(second),
        false => Ok(()),
    };
    blocks(connection, motor, Level::Seconds, from_ms, to_ms, |block| {
        block::seconds_of(block)?.iter().try_for_each(&mut within)
    })?;
    waiting_seconds(connection, motor, within)
}

/// Seconds of a motor that are not history yet.
fn waiting_seconds(
    connection: &Connection,
    motor: i64,
    mut work: impl FnMut(&Second) -> Result<(), StoreError>,
) -> Result<(), StoreError> {
    let columns = seconds::COLUMNS;
    let text = format!("SELECT {columns} FROM queue WHERE id > ?1 AND motor = ?2 ORDER BY id");
    let mut statement = connection.prepare_cached(&text)?;
    let mut rows = statement.query([sealed(connection)? as i64, motor])?;
    while let Some(row) = rows.next()? {
        work(&seconds::second_of(row, 0)?)?;
    }
    Ok(())
}
