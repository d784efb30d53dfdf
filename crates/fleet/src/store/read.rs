//! Reading entries and states.

use rusqlite::{Connection, Row, params};

use super::{StoreError, alarms, id_of, seconds};
use crate::entry::{Entry, Link, Numbered};
use crate::motor::MotorInfo;
use crate::state::MotorState;

/// Entries after an id, in order, at most `limit`.
pub(super) fn since(
    connection: &Connection,
    cursor: u64,
    limit: usize,
) -> Result<Vec<Numbered>, StoreError> {
    // Both tables as of one moment: an id that is committed between two readings would be passed over.
    let tx = connection.unchecked_transaction()?;
    let seconds = queued(&tx, cursor, limit)?;
    let others = entries(&tx, cursor, limit)?;
    Ok(merged(seconds, others, limit))
}

fn queued(connection: &Connection, cursor: u64, limit: usize) -> Result<Vec<Numbered>, StoreError> {
    let text = format!(
        "SELECT queue.id, motor.id, {} FROM queue JOIN motor ON motor.key = queue.motor WHERE queue.id > ?1 ORDER BY queue.id LIMIT ?2",
        seconds::COLUMNS
    );
    let mut statement = connection.prepare_cached(&text)?;
    let rows = statement.query_map(params![cursor as i64, limit as i64], |row| {
        let entry = Entry::Second(seconds::second_of(row, 2)?);
        Ok(Numbered {
            id: row.get::<_, i64>(0)? as u64,
            motor: Some(id_of(row, 1)?),
            entry,
        })
    })?;
    Ok(rows.collect::<Result<_, _>>()?)
}

fn entries(
    connection: &Connection,
    cursor: u64,
    limit: usize,
) -> Result<Vec<Numbered>, StoreError> {
    let text =
        "SELECT entry.id, motor.id, body FROM entry LEFT JOIN motor ON motor.key = entry.motor
         WHERE entry.id > ?1 ORDER BY entry.id LIMIT ?2";
    let mut statement = connection.prepare_cached(text)?;
    let mut rows = statement.query(params![cursor as i64, limit as i64])?;
    let mut found = Vec::new();
    while let Some(row) = rows.next()? {
        found.push(numbered(row)?);
    }
    Ok(found)
}

/// An entry from id, motor and body.
pub(super) fn numbered(row: &Row<'_>) -> Result<Numbered, StoreError> {
    let id = row.get::<_, i64>(0)? as u64;
    let motor = match row.get::<_, Option<String>>(1)? {
        Some(_) => Some(id_of(row, 1)?),
        None => None,
    };
    let body: String = row.get(2)?;
    let damaged = |e: serde_json::Error| StoreError::Damaged {
        id,
        reason: e.to_string(),
    };
    Ok(Numbered {
        id,
        motor,
        entry: serde_json::from_str(&body).map_err(damaged)?,
    })
}

/// Two lists that rise by id as one.
fn merged(one: Vec<Numbered>, other: Vec<Numbered>, limit: usize) -> Vec<Numbered> {
    if other.is_empty() {
        return one;
    }
    let mut both = one;
    both.extend(other);
    both.sort_by_key(|entry| entry.id);
    both.truncate(limit);
    both
}

/// Every declared motor with its present state, in the order of names.
pub(super) fn motors(connection: &Connection) -> Result<Vec<MotorState>, StoreError> {
    let tx = connection.unchecked_transaction()?;
    let counts = alarms::counts(&tx)?;
    let text = format!(
        "SELECT key, id, title, nameplate, place, link, motor_file, event, link_up, link_ms, link_why, {}
         FROM motor JOIN state ON state.motor = motor.key WHERE in_force = 1 ORDER BY id",
        seconds::COLUMNS
    );
    let mut statement = tx.prepare_cached(&text)?;
    let rows = statement.query_map([], |row| {
        let mut state = state_of(row)?;
        if let Some(counts) = counts.get(&row.get(0)?) {
            state.open_alarms = counts.open;
            state.unacknowledged = counts.unacknowledged;
            state.worst = Some(counts.worst);
        }
        Ok(state)
    })?;
    Ok(rows.collect::<Result<_, _>>()?)
}

fn state_of(row: &Row<'_>) -> rusqlite::Result<MotorState> {
    let link = match row.get::<_, Option<bool>>(8)? {
        Some(up) => Some(Link {
            up,
            time_ms: row.get(9)?,
            why: row.get(10)?,
        }),
        None => None,
    };
    // A gap before the first second leaves its time open.
    let last = match row.get::<_, Option<i64>>(13)? {
        Some(_) => Some(seconds::second_of(row, 11)?),
        None => None,
    };
    let info = MotorInfo {
        id: id_of(row, 1)?,
        title: row.get(2)?,
        nameplate: row.get(3)?,
        place: row.get(4)?,
        link: row.get(5)?,
        motor_file: row.get(6)?,
    };
    Ok(MotorState {
        info,
        last,
        last_event: row.get(7)?,
        link,
        open_alarms: 0,
        unacknowledged: 0,
        worst: None,
    })
}
