//! Days of seconds as Parquet, for programs that compute with them.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use parquet::basic::{Compression, ZstdLevel};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::record::RecordWriter;
use parquet_derive::ParquetRecordWriter;
use rusqlite::Connection;

use super::{Reader, StoreError, history};
use crate::entry::Second;

/// Rows that are written together: some tens of megabytes of memory.
const GROUP: usize = 500_000;

/// A second as a row. What is not known is null.
#[derive(Default, ParquetRecordWriter)]
struct SecondRow {
    motor: String,
    time_unix_ms: i64,
    start: u32,
    number: u32,
    lamps: u32,
    windows: u32,
    judged: u32,
    not_judged: u32,
    fault: u32,
    r1: Option<f32>,
    r2: Option<f32>,
    r3: Option<f32>,
    r4: Option<f32>,
    voltage_v: Option<f32>,
    current_a: Option<f32>,
    frequency_hz: Option<f32>,
    speed_rpm: Option<f32>,
}

impl SecondRow {
    fn new(motor: &str, second: &Second) -> Self {
        let known = |r: f32| Some(r).filter(|r| !r.is_nan());
        let [r1, r2, r3, r4] = second
            .residuals
            .map(|all| all.map(known))
            .unwrap_or_default();
        Self {
            motor: motor.to_owned(),
            time_unix_ms: second.time_ms,
            start: second.start,
            number: second.number,
            lamps: second.lamps,
            windows: second.windows.into(),
            judged: second.judged.into(),
            not_judged: second.not_judged.into(),
            fault: second.fault.into(),
            r1,
            r2,
            r3,
            r4,
            voltage_v: second.voltage_v,
            current_a: second.current_a,
            frequency_hz: second.frequency_hz,
            speed_rpm: second.speed_rpm,
        }
    }
}

impl Reader {
    /// Writes the seconds that were stored from `from_ms` to before `to_ms` as `file`, by motor and time; how many. The file is
    /// there as a whole or not at all. Seconds that were thinned are not in it.
    ///
    /// # Errors
    /// Reading the store or writing the file failed.
    pub fn export_seconds(&self, from_ms: i64, to_ms: i64, file: &Path) -> Result<u64, StoreError> {
        let failed = |reason: String| StoreError::Export {
            path: file.to_owned(),
            reason,
        };
        let part = part_of(file);
        let count = self.reading(|c| {
            let out = File::create(&part).map_err(|e| failed(e.to_string()))?;
            let mut writer = Writer::new(out).map_err(|e| failed(e.to_string()))?;
            every_second(c, from_ms, to_ms, |motor, second| {
                writer
                    .take(SecondRow::new(motor, second))
                    .map_err(|e| failed(e.to_string()))
            })?;
            writer.finish().map_err(|e| failed(e.to_string()))
        });
        match count.and_then(|count| {
            std::fs::rename(&part, file).map_err(|e| failed(e.to_string()))?;
            Ok(count)
        }) {
            Ok(count) => Ok(count),
            Err(error) => {
                // What is half written is of no use; that it is left behind would be.
                let _ = std::fs::remove_file(&part);
                Err(error)
            }
        }
    }
}

/// Name of a file while it is being written.
fn part_of(file: &Path) -> PathBuf {
    let mut name = file.as_os_str().to_owned();
    name.push(".part");
    name.into()
}

/// Every second of a time, motor by motor.
fn every_second(
    connection: &Connection,
    from_ms: i64,
    to_ms: i64,
    mut work: impl FnMut(&str, &Second) -> Result<(), StoreError>,
) -> Result<(), StoreError> {
    let tx = connection.unchecked_transaction()?;
    let mut motors = tx.prepare_cached("SELECT key, id FROM motor ORDER BY id")?;
    let mut rows = motors.query([])?;
    while let Some(row) = rows.next()? {
        let id: String = row.get(1)?;
        history::seconds_between(&tx, row.get(0)?, from_ms, to_ms, |second| work(&id, second))?;
    }
    Ok(())
}

/// Rows on their way into a file.
struct Writer {
    file: SerializedFileWriter<File>,
    rows: Vec<SecondRow>,
    count: u64,
}

impl Writer {
    fn new(out: File) -> Result<Self, ParquetError> {
        let compression = Compression::ZSTD(ZstdLevel::default());
        let properties = WriterProperties::builder()
            .set_compression(compression)
            .build();
        let none: &[SecondRow] = &[];
        let file = SerializedFileWriter::new(out, none.schema()?, Arc::new(properties))?;
        Ok(Self {
            file,
            rows: Vec::new(),
            count: 0,
        })
    }

    fn take(&mut self, row: SecondRow) -> Result<(), ParquetError> {
        self.rows.push(row);
        self.count += 1;
        if self.rows.len() < GROUP {
            Ok(())
        } else {
            self.flush()
        }
    }

    fn flush(&mut self) -> Result<(), ParquetError> {
        let mut group = self.file.next_row_group()?;
        (&self.rows[..]).write_to_row_group(&mut group)?;
        group.close()?;
        self.rows.clear();
        Ok(())
    }

    fn finish(mut self) -> Result<u64, ParquetError> {
        if !self.rows.is_empty() {
            self.flush()?;
        }
        let count = self.count;
        self.file.into_inner()?.sync_all()?;
        Ok(count)
    }
}
