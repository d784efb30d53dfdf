//! A motor's history for a chart: at most so many points, each with least, mean and largest value.

use rusqlite::Connection;

use super::block::{self, HOUR_MS, Level};
use super::point::Trend;
use super::tally::Tally;
use crate::entry::Second;
use crate::store::StoreError;

/// From this length of a point on, ms, hours take the place of seconds and minutes: a million seconds would be read for it.
const HOURS_FROM_MS: u64 = 900_000;

/// Most points of one trend: more than any screen has columns.
const MOST: usize = 20_000;

/// Sorts what happened into points of equal length.
struct Points {
    from_ms: i64,
    step_ms: i64,
    tallies: Vec<Tally>,
}

impl Points {
    fn new(from_ms: i64, to_ms: i64, points: usize) -> Self {
        let points = points.clamp(1, MOST);
        let span = to_ms.saturating_sub(from_ms).max(1).unsigned_abs();
        // Whole seconds: a point that is shorter would be empty every other time.
        let mut step = span.div_ceil(points as u64).div_ceil(1000) * 1000;
        if step >= HOURS_FROM_MS {
            step = step.max(HOUR_MS.unsigned_abs());
        }
        let count = span.div_ceil(step) as usize;
        let step_ms = step as i64;
        Self {
            from_ms,
            step_ms,
            tallies: vec![Tally::default(); count],
        }
    }

    fn at(&mut self, time_ms: i64) -> Option<&mut Tally> {
        let place = time_ms.checked_sub(self.from_ms)?.div_euclid(self.step_ms);
        self.tallies.get_mut(usize::try_from(place).ok()?)
    }

    fn trend(&self) -> Trend {
        let step_ms = self.step_ms;
        let begins = (0..).map(|k| self.from_ms + k * step_ms);
        let full = begins
            .zip(&self.tallies)
            .filter(|(_, tally)| tally.seconds > 0);
        let points = full
            .map(|(begin, tally)| tally.point(begin, begin + step_ms))
            .collect();
        Trend { step_ms, points }
    }
}

impl Points {
    fn second(&mut self, second: &Second) {
        if let Some(tally) = self.at(second.time_ms) {
            tally.second(second);
        }
    }

    fn merge(&mut self, time_ms: i64, other: &Tally) {
        if let Some(tally) = self.at(time_ms) {
            tally.merge(other);
        }
    }

    fn end_ms(&self) -> i64 {
        self.from_ms + self.step_ms * self.tallies.len() as i64
    }

    /// Takes hours that begin before a time. The first is taken whole where the trend begins within it.
    fn hours(
        &mut self,
        connection: &Connection,
        motor: i64,
        before_ms: i64,
    ) -> Result<(), StoreError> {
        let text = "SELECT hour, body FROM hour WHERE motor = ?1 AND hour >= ?2 AND hour < ?3";
        let mut statement = connection.prepare_cached(text)?;
        let (first, end) = (
            self.from_ms.div_euclid(HOUR_MS),
            (self.end_ms().min(before_ms) - 1).div_euclid(HOUR_MS) + 1,
        );
        let mut rows = statement.query([motor, first, end])?;
        while let Some(row) = rows.next()? {
            let hour: i64 = row.get(0)?;
            let body: Vec<u8> = row.get(1)?;
            let reason = "an hour of the history is damaged".to_owned();
            let tally = block::hour_of_bytes(&body);
            let tally = tally.ok_or(StoreError::Damaged {
                id: hour as u64,
                reason,
            })?;
            self.merge((hour * HOUR_MS).max(self.from_ms), &tally);
        }
        Ok(())
    }

    fn blocks(&mut self, connection: &Connection, motor: i64) -> Result<(), StoreError> {
        let (from_ms, to_ms) = (self.from_ms, self.end_ms());
        super::blocks(connection, motor, Level::Minutes, from_ms, to_ms, |block| {
            for minute in block::minutes_of(block)? {
                self.merge(minute.from_ms, &minute.tally);
            }
            Ok(())
        })?;
        super::blocks(connection, motor, Level::Seconds, from_ms, to_ms, |block| {
            block::seconds_of(block)?
                .iter()
                .for_each(|second| self.second(second));
            Ok(())
        })
    }
}

/// The trend of a motor from `from_ms` to before `to_ms`. Where seconds and minutes are gone, hours stand for them.
pub(in crate::store) fn trend(
    connection: &Connection,
    motor: i64,
    from_ms: i64,
    to_ms: i64,
    points: usize,
) -> Result<Trend, StoreError> {
    let mut points = Points::new(from_ms, to_ms, points);
    // As of one moment: a second that becomes history meanwhile would count twice or not at all.
    let tx = connection.unchecked_transaction()?;
    let gone_ms = super::meta(&tx, "hours_done")?;
    if points.step_ms >= HOUR_MS {
        points.hours(&tx, motor, i64::MAX)?;
    } else {
        points.hours(&tx, motor, gone_ms)?;
        points.blocks(&tx, motor)?;
    }
    super::waiting_seconds(&tx, motor, |second| {
        points.second(second);
        Ok(())
    })?;
    Ok(points.trend())
}

/// When the oldest second that is still told of a motor was, Unix ms: to the second where seconds are kept, to the minute or the hour
/// where they have been thinned.
pub(in crate::store) fn first_ms(
    connection: &Connection,
    motor: i64,
) -> Result<Option<i64>, StoreError> {
    let tx = connection.unchecked_transaction()?;
    let one = |text: &str| -> rusqlite::Result<Option<i64>> {
        tx.prepare_cached(text)?
            .query_row([motor], |row| row.get(0))
    };
    let hour = one("SELECT min(hour) FROM hour WHERE motor = ?1")?.map(|hour| hour * HOUR_MS);
    let seconds = one("SELECT min(from_ms) FROM block WHERE motor = ?1 AND level = 0")?;
    let minutes = one("SELECT min(from_ms) FROM block WHERE motor = ?1 AND level = 1")?;
    let sharper = seconds.into_iter().chain(minutes).min();
    // What is sharper stands within the oldest hour, or the oldest hour is all that is left of its time.
    let within = |from_ms: &i64| hour.is_none_or(|hour| *from_ms < hour + HOUR_MS);
    let mut first = sharper.filter(within).or(hour);
    super::waiting_seconds(&tx, motor, |second| {
        first = Some(first.map_or(second.time_ms, |first| first.min(second.time_ms)));
        Ok(())
    })?;
    Ok(first)
}
