//! What happened to a motor, and to an alarm, newest first.

use rusqlite::params;

use super::{Store, StoreError, read};
use crate::alarm::change::AlarmChange;
use crate::entry::{Entry, Numbered};
use crate::motor::MotorId;

impl Store {
    /// Everything but seconds of a motor from `from_ms` to before `to_ms`, newest first, at most `limit`. `None`: of the plant
    /// as a whole.
    ///
    /// # Errors
    /// Reading failed.
    pub fn timeline(
        &self,
        motor: Option<&MotorId>,
        from_ms: i64,
        to_ms: i64,
        limit: usize,
    ) -> Result<Vec<Numbered>, StoreError> {
        let text = "SELECT entry.id, motor.id, body FROM entry LEFT JOIN motor ON motor.key = entry.motor
             WHERE entry.motor IS (SELECT key FROM motor WHERE id = ?1) AND time_ms >= ?2 AND time_ms < ?3
             ORDER BY time_ms DESC, entry.id DESC LIMIT ?4";
        let motor = motor.map(MotorId::as_str);
        self.reading(|c| {
            let mut statement = c.prepare_cached(text)?;
            let mut rows = statement.query(params![motor, from_ms, to_ms, limit as i64])?;
            let mut found = Vec::new();
            while let Some(row) = rows.next()? {
                found.push(read::numbered(row)?);
            }
            Ok(found)
        })
    }

    /// All changes of an alarm, in order; none: there is no such alarm.
    ///
    /// # Errors
    /// Reading failed.
    pub fn alarm_changes(&self, number: u64) -> Result<Vec<AlarmChange>, StoreError> {
        let text = "SELECT entry.id, NULL, body FROM entry WHERE kind = 'alarm' AND number = ?1 ORDER BY id";
        self.reading(|c| {
            let mut statement = c.prepare_cached(text)?;
            let mut rows = statement.query([number as i64])?;
            let mut found = Vec::new();
            while let Some(row) = rows.next()? {
                if let Entry::Alarm(change) = read::numbered(row)?.entry {
                    found.push(change);
                }
            }
            Ok(found)
        })
    }
}
