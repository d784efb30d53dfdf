//! Keeping within limits: the oldest seconds become minutes, minutes become hours, before any event, alarm or gap is dropped.

use std::collections::BTreeMap;

use rusqlite::{Connection, OptionalExtension, Transaction, params};

use super::block::{self, DAY_MS, HOUR_MS, Level, MINUTE_MS, Minute};
use super::tally::Tally;
use super::{meta, set_meta};
use crate::entry::{Entry, Thinned, ThinnedTo};
use crate::store::{Limits, Store, StoreError, lock, recordings};

/// Seconds wait at most so long before they become history.
const SEAL_AFTER_MS: i64 = 600_000;

/// Rows that one transaction deletes: a batch that comes meanwhile waits for some ten milliseconds.
const DELETED_AT_ONCE: i64 = 50_000;

/// Motors whose blocks one transaction thins.
const MOTORS_AT_ONCE: usize = 50;

/// A full store is thinned to this share of its limit, so that it is not full again at once.
const FULL_TO: f64 = 0.9;

/// What a step of thinning does, and up to when.
#[derive(Clone, Copy)]
struct Step {
    to: ThinnedTo,
    before_ms: i64,
}

impl Store {
    /// Keeps the store within its limits: seconds that are complete become history, what is too old or too much is thinned, and
    /// that is stored as an entry. Call it every few seconds, from one thread; batches are stored meanwhile.
    ///
    /// # Errors
    /// Reading or writing failed; what was done is kept.
    pub fn maintain(&self, now_ms: i64) -> Result<(), StoreError> {
        let (waiting, oldest_ms) = self.reading(|c| Ok(super::waiting(c)?))?;
        let late = oldest_ms.is_some_and(|oldest| now_ms - oldest >= SEAL_AFTER_MS);
        if late || waiting >= super::MOST_AT_ONCE {
            self.seal()?;
        }
        self.trim(now_ms)?;
        self.thin_by_age(now_ms)?;
        self.thin_by_size(now_ms)
    }

    /// Makes every stored second history now, also where its minute is not over.
    ///
    /// # Errors
    /// Reading or writing failed.
    pub fn seal(&self) -> Result<(), StoreError> {
        while let Some(sealed) = self.reading(super::prepare)? {
            let mut writer = lock(&self.writer);
            if !writer.change(|tx, _, _| super::write(tx, &sealed))? {
                break;
            }
        }
        Ok(())
    }

    /// Bytes of the database that are in use.
    ///
    /// # Errors
    /// Reading failed.
    pub fn bytes(&self) -> Result<u64, StoreError> {
        self.reading(|connection| {
            let text = "SELECT (page_count - freelist_count) * page_size
                 FROM pragma_page_count, pragma_freelist_count, pragma_page_size";
            Ok(connection.query_row(text, [], |row| row.get::<_, i64>(0))? as u64)
        })
    }

    /// Takes out of the queue what is history and was delivered to every output, or is more than the limit.
    fn trim(&self, now_ms: i64) -> Result<(), StoreError> {
        let (first, last, free) = self.reading(|c| Ok(queue_span(c)?))?;
        if first > 0 && first <= free {
            self.delete_queue(free)?;
        }
        let waiting = last.saturating_sub(first.max(free));
        let most = self.limits.queue_seconds as i64;
        if waiting <= most {
            return Ok(());
        }
        self.cut_queue(waiting - most * 9 / 10, "queue_seconds", now_ms)?;
        Ok(())
    }

    /// Cuts so many of the oldest seconds from the queue, as far as they are history, and says so; how many were cut.
    fn cut_queue(&self, count: i64, why: &str, now_ms: i64) -> Result<u64, StoreError> {
        self.seal()?;
        let up_to = self.reading(|c| {
            let first = "SELECT coalesce(min(id), 0) FROM queue";
            let first: i64 = c.query_row(first, [], |row| row.get(0))?;
            Ok((first + count).min(super::sealed(c)? as i64))
        })?;
        let count = self.delete_queue(up_to)?;
        self.say(
            Step {
                to: ThinnedTo::QueueCut,
                before_ms: 0,
            },
            count,
            why,
            now_ms,
        )?;
        Ok(count)
    }

    fn delete_queue(&self, up_to: i64) -> Result<u64, StoreError> {
        let text = "DELETE FROM queue WHERE id IN (SELECT id FROM queue WHERE id <= ?1 ORDER BY id LIMIT ?2)";
        let mut all = 0;
        loop {
            let deleted = lock(&self.writer).change(|tx, _, next| {
                // Ids are given once, also where the newest rows are gone.
                set_meta(tx, "last", next as i64 - 1)?;
                Ok(tx.execute(text, params![up_to, DELETED_AT_ONCE])?)
            })?;
            all += deleted as u64;
            if deleted < DELETED_AT_ONCE as usize {
                return Ok(all);
            }
        }
    }

    fn thin_by_age(&self, now_ms: i64) -> Result<(), StoreError> {
        let Limits {
            seconds_days,
            minutes_days,
            hours_days,
            recordings_days,
            ..
        } = self.limits;
        let before = |days: u32| (now_ms - i64::from(days) * DAY_MS).div_euclid(DAY_MS) * DAY_MS;
        let steps = [
            (ThinnedTo::Minutes, seconds_days, "seconds_days"),
            (ThinnedTo::Hours, minutes_days, "minutes_days"),
            (ThinnedTo::HoursDropped, hours_days, "hours_days"),
            (
                ThinnedTo::RecordingsDropped,
                recordings_days,
                "recordings_days",
            ),
        ];
        for (to, days, why) in steps {
            let step = Step {
                to,
                before_ms: before(days),
            };
            let done = self.reading(|c| Ok(meta(c, done_key(to))?))?;
            if done < step.before_ms {
                self.thin(step, why, now_ms)?;
            }
        }
        Ok(())
    }

    fn thin_by_size(&self, now_ms: i64) -> Result<(), StoreError> {
        if self.bytes()? <= self.limits.bytes {
            return Ok(());
        }
        let target = (self.limits.bytes as f64 * FULL_TO) as u64;
        while self.bytes()? > target {
            if let Some(step) = self.reading(|c| next_step(c, now_ms))? {
                self.thin(step, "bytes", now_ms)?;
                continue;
            }
            // No history is left that may go.
            let cut = self.cut_queue(DELETED_AT_ONCE * 10, "bytes", now_ms)?;
            if cut == 0 && self.drop_entries(now_ms)? == 0 {
                break;
            }
        }
        Ok(())
    }

    /// Thins all motors, some in each transaction. What was begun before a crash is counted and said with the rest.
    fn thin(&self, step: Step, why: &str, now_ms: i64) -> Result<(), StoreError> {
        let motors: Vec<i64> = self.reading(|c| {
            let mut statement = c.prepare_cached("SELECT key FROM motor ORDER BY key")?;
            Ok(statement
                .query_map([], |row| row.get(0))?
                .collect::<Result<_, _>>()?)
        })?;
        for motors in motors.chunks(MOTORS_AT_ONCE) {
            lock(&self.writer).change(|tx, _, _| {
                let counts = motors.iter().map(|motor| thin_motor(tx, *motor, step));
                let count = counts.sum::<Result<u64, _>>()?;
                let key = count_key(step.to);
                Ok(set_meta(tx, key, meta(tx, key)? + count as i64)?)
            })?;
        }
        let count = self.reading(|c| Ok(meta(c, count_key(step.to))?))? as u64;
        self.say(step, count, why, now_ms)
    }

    /// Stores what was thinned, and that it is done.
    fn say(&self, step: Step, count: u64, why: &str, now_ms: i64) -> Result<(), StoreError> {
        let Step { to, before_ms } = step;
        let why = why.to_owned();
        let entry = Entry::Thinned(Thinned {
            to,
            before_ms,
            count,
            time_ms: now_ms,
            why,
        });
        let entries = (count > 0).then_some((None, &entry));
        lock(&self.writer).append(entries.into_iter(), |tx| {
            set_meta(tx, count_key(to), 0)?;
            Ok(set_meta(
                tx,
                done_key(to),
                before_ms.max(meta(tx, done_key(to))?),
            )?)
        })?;
        Ok(())
    }

    /// Drops the oldest tenth of entries and the alarms that are normal since then; how many.
    fn drop_entries(&self, now_ms: i64) -> Result<u64, StoreError> {
        let (count, before_ms) = lock(&self.writer).change(|tx, _, _| oldest_entries(tx))?;
        self.say(
            Step {
                to: ThinnedTo::EntriesDropped,
                before_ms,
            },
            count,
            "bytes",
            now_ms,
        )?;
        Ok(count)
    }
}

fn oldest_entries(tx: &Transaction<'_>) -> Result<(u64, i64), StoreError> {
    let text = "SELECT id, time_ms FROM entry ORDER BY id LIMIT 1 OFFSET (SELECT count(*) / 10 FROM entry)";
    let found = tx
        .query_row(text, [], |row| Ok((row.get(0)?, row.get(1)?)))
        .optional()?;
    let (id, time_ms): (i64, i64) = found.unwrap_or_default();
    let count = tx.execute("DELETE FROM entry WHERE id < ?1", [id])?;
    let old = "DELETE FROM alarm WHERE state = 'normal' AND changed_ms < ?1";
    tx.execute(old, [time_ms])?;
    Ok((count as u64, time_ms))
}

/// Key of the time up to which a kind of thinning is done.
fn done_key(to: ThinnedTo) -> &'static str {
    match to {
        ThinnedTo::Minutes => "minutes_done",
        ThinnedTo::Hours => "hours_done",
        ThinnedTo::HoursDropped => "hours_dropped_done",
        ThinnedTo::RecordingsDropped => "recordings_dropped_done",
        ThinnedTo::QueueCut => "queue_cut_done",
        ThinnedTo::EntriesDropped => "entries_dropped_done",
    }
}

/// Key of the count of a thinning that is under way.
fn count_key(to: ThinnedTo) -> &'static str {
    match to {
        ThinnedTo::Minutes => "minutes_count",
        ThinnedTo::Hours => "hours_count",
        ThinnedTo::HoursDropped => "hours_dropped_count",
        ThinnedTo::RecordingsDropped => "recordings_dropped_count",
        ThinnedTo::QueueCut => "queue_cut_count",
        ThinnedTo::EntriesDropped => "entries_dropped_count",
    }
}

/// First and last id of the queue, and the id up to which nobody needs it.
fn queue_span(connection: &Connection) -> rusqlite::Result<(i64, i64, i64)> {
    let text = "SELECT coalesce(min(id), 0), coalesce(max(id), 0), (SELECT min(cursor) FROM sink) FROM queue";
    let (first, last, slowest): (i64, i64, Option<i64>) =
        connection.query_row(text, [], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))?;
    let sealed = super::sealed(connection)? as i64;
    Ok((first, last, slowest.unwrap_or(sealed).min(sealed)))
}

/// What a full store thins next: its oldest day of seconds, of minutes, its oldest 30 days of hours. Each level keeps its last
/// hour.
fn next_step(connection: &Connection, now_ms: i64) -> Result<Option<Step>, StoreError> {
    let oldest = |text: &str| connection.query_row(text, [], |row| row.get::<_, Option<i64>>(0));
    // The least of each motor is one step in the table's tree.
    let of_level = |level: Level| {
        oldest(&format!(
            "SELECT min((SELECT from_ms FROM block WHERE motor = key AND level = {} ORDER BY from_ms LIMIT 1)) FROM motor",
            level as i64
        ))
    };
    let newest_ms = (now_ms - HOUR_MS).div_euclid(HOUR_MS) * HOUR_MS;
    let end =
        |from_ms: i64, days: i64| ((from_ms.div_euclid(DAY_MS) + days) * DAY_MS).min(newest_ms);
    let hours =
        "SELECT min((SELECT hour FROM hour WHERE motor = key ORDER BY hour LIMIT 1)) FROM motor";
    let levels = [
        (ThinnedTo::Minutes, of_level(Level::Seconds)?, 1),
        (ThinnedTo::Hours, of_level(Level::Minutes)?, 1),
        (
            ThinnedTo::HoursDropped,
            oldest(hours)?.map(|hour| hour * HOUR_MS),
            30,
        ),
        (
            ThinnedTo::RecordingsDropped,
            oldest("SELECT min(time_ms) FROM recording WHERE body IS NOT NULL")?,
            30,
        ),
    ];
    Ok(levels.into_iter().find_map(|(to, oldest_ms, days)| {
        let from_ms = oldest_ms?;
        let before_ms = end(from_ms, days);
        (before_ms > from_ms).then_some(Step { to, before_ms })
    }))
}

/// Thins one motor; the number of blocks or hours that are gone.
fn thin_motor(tx: &Transaction<'_>, motor: i64, step: Step) -> Result<u64, StoreError> {
    let count = match step.to {
        ThinnedTo::Minutes => seconds_to_minutes(tx, motor, step.before_ms)?,
        ThinnedTo::Hours => drop_blocks(tx, motor, Level::Minutes, step.before_ms)?,
        ThinnedTo::HoursDropped => {
            let hour = step.before_ms.div_euclid(HOUR_MS);
            tx.execute(
                "DELETE FROM hour WHERE motor = ?1 AND hour < ?2",
                [motor, hour],
            )?
        }
        ThinnedTo::RecordingsDropped => recordings::drop_before(tx, motor, step.before_ms)?,
        ThinnedTo::QueueCut | ThinnedTo::EntriesDropped => 0,
    };
    Ok(count as u64)
}

fn drop_blocks(
    tx: &Transaction<'_>,
    motor: i64,
    level: Level,
    before_ms: i64,
) -> rusqlite::Result<usize> {
    let text = "DELETE FROM block WHERE motor = ?1 AND level = ?2 AND from_ms < ?3";
    tx.prepare_cached(text)?
        .execute(params![motor, level as i64, before_ms])
}

/// Blocks of seconds that began before a time become minutes, as a whole.
fn seconds_to_minutes(
    tx: &Transaction<'_>,
    motor: i64,
    before_ms: i64,
) -> Result<usize, StoreError> {
    let mut minutes: BTreeMap<i64, Tally> = BTreeMap::new();
    let mut first = i64::MAX;
    super::blocks(tx, motor, Level::Seconds, i64::MIN, before_ms, |block| {
        first = first.min(block.first);
        for second in block::seconds_of(block)? {
            minutes
                .entry(second.time_ms.div_euclid(MINUTE_MS))
                .or_default()
                .second(&second);
        }
        Ok(())
    })?;
    let minutes = minutes.into_iter().map(|(minute, tally)| Minute {
        from_ms: minute * MINUTE_MS,
        tally,
    });
    let minutes: Vec<_> = minutes.collect();
    // Whole hours: where minutes are dropped later, hours go on exactly there.
    for hour in
        minutes.chunk_by(|a, b| a.from_ms.div_euclid(HOUR_MS) == b.from_ms.div_euclid(HOUR_MS))
    {
        put_minutes(tx, motor, hour, first)?;
    }
    Ok(drop_blocks(tx, motor, Level::Seconds, before_ms)?)
}

fn put_minutes(
    tx: &Transaction<'_>,
    motor: i64,
    minutes: &[Minute],
    first: i64,
) -> Result<(), StoreError> {
    if let Some(block) = block::of_minutes(minutes, first).map_err(super::packing)? {
        super::put(tx, motor, Level::Minutes, &block)?;
    }
    Ok(())
}
