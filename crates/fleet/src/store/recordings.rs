//! The samples around alarms.

use std::path::PathBuf;

use rusqlite::{Connection, OptionalExtension, Transaction, params};
use thiserror::Error;

use super::{Reader, Store, StoreError};
use crate::entry::{Recording, RecordingKey};
use crate::motor::MotorId;

/// Samples around an alarm, as a board has them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Samples {
    /// Whose they are.
    pub motor: MotorId,
    /// When the alarm was, Unix ms.
    pub time_ms: i64,
    /// What the board calls its motor constants.
    pub constants: u32,
    /// Instants, as the board has them (`board::captured_samples`); `None`: there are none, or they were dropped.
    pub instants: Option<Vec<u8>>,
}

/// The recording of an alarm, with what makes volts and amperes of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlarmRecording {
    /// Its name in the store.
    pub name: String,
    /// What the board calls the motor constants that it was flashed with.
    pub constants: u32,
    /// Instants, as the board has them (`board::captured_samples`).
    pub instants: Vec<u8>,
    /// The motor's file, an absolute path.
    pub motor_file: PathBuf,
}

/// Why an alarm gives no recording.
#[derive(Debug, Error)]
pub enum NoRecording {
    /// No alarm has this number.
    #[error("there is no alarm {0}: the numbers are in the list of alarms")]
    Unknown(u64),
    /// It has none.
    #[error("alarm {number} has no recording: {why}")]
    None {
        /// The alarm.
        number: u64,
        /// Why.
        why: String,
    },
    /// It had one.
    #[error(
        "the recording of alarm {0} was dropped: the store keeps recordings for `recordings_days`, and drops the oldest when it is full"
    )]
    Dropped(u64),
    /// Codes of a converter are no volts.
    #[error(
        "motor {0} has no `motor_file` in the gateway's configuration: name the file with which its board was flashed, and start the gateway again; without it codes of the converter do not become volts and amperes"
    )]
    NoMotorFile(MotorId),
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// Writes a recording, or why there is none; `false` where that is stored already.
pub(super) fn put(
    tx: &Transaction<'_>,
    motor: i64,
    recording: &Recording,
) -> Result<bool, StoreError> {
    let text =
        "INSERT INTO recording(name, motor, time_ms, constants, body) VALUES (?1, ?2, ?3, ?4, ?5)
         ON CONFLICT(name) DO UPDATE SET body = excluded.body, constants = excluded.constants
         WHERE recording.body IS NULL AND excluded.body IS NOT NULL";
    let samples = Some(&recording.samples).filter(|samples| !samples.is_empty());
    let changed = tx.prepare_cached(text)?.execute(params![
        recording.file,
        motor,
        recording.to_ms,
        recording.motor,
        samples,
    ])?;
    Ok(changed > 0)
}

/// Reads one by its name.
pub(super) fn get(connection: &Connection, name: &str) -> Result<Option<Samples>, StoreError> {
    let text = "SELECT id, time_ms, constants, body FROM recording JOIN motor ON motor.key = recording.motor WHERE name = ?1";
    let mut statement = connection.prepare_cached(text)?;
    let row = statement.query_row([name], |row| {
        Ok(Samples {
            motor: super::id_of(row, 0)?,
            time_ms: row.get(1)?,
            constants: row.get(2)?,
            instants: row.get(3)?,
        })
    });
    Ok(row.optional()?)
}

/// Drops the samples of a motor's alarms before `before_ms`; how many.
pub(super) fn drop_before(
    tx: &Transaction<'_>,
    motor: i64,
    before_ms: i64,
) -> rusqlite::Result<usize> {
    let text =
        "UPDATE recording SET body = NULL WHERE motor = ?1 AND time_ms < ?2 AND body IS NOT NULL";
    tx.prepare_cached(text)?.execute([motor, before_ms])
}

impl Store {
    /// Samples around an alarm, by the name that the alarm's evidence gives; `None`: no such name.
    ///
    /// # Errors
    /// Reading failed.
    pub fn recording(&self, name: &str) -> Result<Option<Samples>, StoreError> {
        self.reading(|connection| get(connection, name))
    }

    /// What is stored of a motor's recording: its samples, or that there are none; `None`: nothing.
    ///
    /// # Errors
    /// The motor is not declared, or reading failed.
    pub fn recording_of(
        &self,
        motor: &MotorId,
        key: RecordingKey,
    ) -> Result<Option<Samples>, StoreError> {
        self.recording(&key.name(motor, self.marks_of(motor)?.board))
    }
}

impl Reader {
    /// The recording of an alarm.
    ///
    /// # Errors
    /// Says why there is none.
    pub fn recording_of_alarm(&self, number: u64) -> Result<AlarmRecording, NoRecording> {
        let alarm = self.alarm(number)?.ok_or(NoRecording::Unknown(number))?;
        let why = || alarm.why_no_recording().unwrap_or_default();
        let name = alarm.evidence.recording.clone();
        let name = name.ok_or_else(|| NoRecording::None { number, why: why() })?;
        let samples = self.recording(&name)?;
        let samples = samples.ok_or(NoRecording::Dropped(number))?;
        let instants = samples.instants.ok_or(NoRecording::Dropped(number))?;
        let file = self.reading(|connection| {
            let text = "SELECT motor_file FROM motor WHERE id = ?1";
            let mut statement = connection.prepare_cached(text)?;
            Ok(statement.query_row([samples.motor.as_str()], |row| {
                row.get::<_, Option<String>>(0)
            })?)
        })?;
        let file = file.ok_or(NoRecording::NoMotorFile(samples.motor))?;
        Ok(AlarmRecording {
            name,
            constants: samples.constants,
            instants,
            motor_file: file.into(),
        })
    }
}
