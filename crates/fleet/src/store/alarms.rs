//! Alarms as they are now.

use std::collections::HashMap;

use rusqlite::{Connection, Transaction, params};

use super::StoreError;
use crate::alarm::change::{Alarm, AlarmFilter, AlarmState, Severity};

/// Alarms in one answer where nobody asks for less.
const MOST: usize = 1000;

/// Whether somebody has to look at it.
fn open(state: AlarmState) -> bool {
    use AlarmState::{Acknowledged, ReturnedUnacknowledged, Unacknowledged};
    matches!(
        state,
        Unacknowledged | Acknowledged | ReturnedUnacknowledged
    )
}

/// A state as the table holds it.
fn word(state: AlarmState) -> &'static str {
    match state {
        AlarmState::Normal => "normal",
        AlarmState::Unacknowledged => "unacknowledged",
        AlarmState::Acknowledged => "acknowledged",
        AlarmState::ReturnedUnacknowledged => "returned_unacknowledged",
        AlarmState::Shelved => "shelved",
        AlarmState::Suppressed => "suppressed",
    }
}

/// Writes an alarm as it is after a change. `motor` is 0 of the plant.
pub(super) fn put(tx: &Transaction<'_>, motor: i64, alarm: &Alarm) -> Result<(), StoreError> {
    let text = "INSERT OR REPLACE INTO alarm(number, motor, cause, state, severity, open, raised_ms, changed_ms, body)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)";
    let mut statement = tx.prepare_cached(text)?;
    statement.execute(params![
        alarm.number as i64,
        (motor != 0).then_some(motor),
        serde_json::to_value(alarm.cause)?.as_str(),
        word(alarm.state),
        alarm.severity as i64,
        open(alarm.state),
        alarm.raised_ms,
        alarm.changed_ms,
        serde_json::to_string(alarm)?,
    ])?;
    Ok(())
}

/// Alarms that a filter lets through: the worst first, then the newest.
pub(super) fn get(connection: &Connection, filter: &AlarmFilter) -> Result<Vec<Alarm>, StoreError> {
    let states: Vec<_> = filter.states.iter().map(|state| word(*state)).collect();
    let states = serde_json::to_string(&states)?;
    let text = "SELECT number, body FROM alarm WHERE (?1 IS NULL OR motor = (SELECT key FROM motor WHERE id = ?1))
         AND (?2 = '[]' OR state IN (SELECT value FROM json_each(?2)))
         AND (?3 IS NULL OR changed_ms >= ?3) AND (?4 IS NULL OR raised_ms < ?4)
         ORDER BY open DESC, severity DESC, raised_ms DESC, number DESC LIMIT ?5";
    let limit = if filter.limit == 0 {
        MOST
    } else {
        filter.limit
    } as i64;
    let motor = filter.motor.as_ref().map(|motor| motor.as_str());
    let mut statement = connection.prepare_cached(text)?;
    collected(statement.query(params![motor, states, filter.from_ms, filter.to_ms, limit])?)
}

/// An alarm by its number.
pub(super) fn one(connection: &Connection, number: u64) -> Result<Option<Alarm>, StoreError> {
    let text = "SELECT number, body FROM alarm WHERE number = ?1";
    let mut statement = connection.prepare_cached(text)?;
    let mut found = collected(statement.query([number as i64])?)?;
    Ok(found.pop())
}

/// Alarms that are not normal, by number.
pub(super) fn not_normal(connection: &Connection) -> Result<Vec<Alarm>, StoreError> {
    let text = "SELECT number, body FROM alarm WHERE state <> 'normal' ORDER BY number";
    let mut statement = connection.prepare_cached(text)?;
    collected(statement.query([])?)
}

/// Alarms from number and body.
fn collected(mut rows: rusqlite::Rows<'_>) -> Result<Vec<Alarm>, StoreError> {
    let mut found = Vec::new();
    while let Some(row) = rows.next()? {
        let (id, body) = (row.get::<_, i64>(0)? as u64, row.get::<_, String>(1)?);
        let damaged = |e: serde_json::Error| StoreError::Damaged {
            id,
            reason: e.to_string(),
        };
        found.push(serde_json::from_str(&body).map_err(damaged)?);
    }
    Ok(found)
}

/// Open alarms of a motor.
pub(super) struct Counts {
    pub open: u32,
    pub unacknowledged: u32,
    pub worst: Severity,
}

/// Open alarms by motor's key.
pub(super) fn counts(connection: &Connection) -> rusqlite::Result<HashMap<i64, Counts>> {
    let text = "SELECT motor, count(*), sum(state <> 'acknowledged'), max(severity) FROM alarm
         WHERE open = 1 AND motor IS NOT NULL GROUP BY motor";
    let mut statement = connection.prepare_cached(text)?;
    let rows = statement.query_map([], |row| {
        let worst = match row.get::<_, i64>(3)? {
            2 => Severity::High,
            1 => Severity::Medium,
            _ => Severity::Low,
        };
        Ok((
            row.get(0)?,
            Counts {
                open: row.get(1)?,
                unacknowledged: row.get(2)?,
                worst,
            },
        ))
    })?;
    rows.collect()
}
