//! One column of a Parquet file as numbers.

use super::chunk::{Chunk, of_column};
use super::paged_file::PagedFile;
use super::pages::Pages;
use parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::{DataType, Int96};
use parquet::errors::ParquetError;
use parquet::file::metadata::ParquetMetaData;
use parquet::schema::types::{ColumnDescPtr, ColumnDescriptor};
use std::sync::Arc;

/// How the stored values of a column become numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// As they stand, signed.
    Number,
    /// The bits of an unsigned integer.
    Unsigned,
    /// An integer with this factor: a decimal, or a duration in units of this many seconds.
    Decimal(f64),
    /// An instant in units of this many seconds; counts from the first sample, because the instant
    /// itself would cost a double the microseconds.
    Instant(f64),
}

impl Kind {
    /// The kind of a column whose integers last as long as `duration_s` says, where it says anything.
    ///
    /// # Errors
    /// What it holds instead of numbers, in words.
    pub fn of(column: &ColumnDescriptor, duration_s: Option<f64>) -> Result<Kind, &'static str> {
        if column.max_rep_level() > 0 {
            return Err("lists");
        }
        match column.physical_type() {
            Type::INT32 | Type::INT64 => of_integers(column, duration_s),
            Type::FLOAT | Type::DOUBLE => Ok(Kind::Number),
            Type::INT96 => Ok(Kind::Instant(1e-9)),
            Type::BOOLEAN => Err("truth values"),
            Type::BYTE_ARRAY | Type::FIXED_LEN_BYTE_ARRAY => Err(of_bytes(column)),
        }
    }

    #[allow(clippy::cast_precision_loss, clippy::cast_sign_loss)]
    fn number(self, first: i64, x: i64) -> f64 {
        match self {
            Kind::Number => x as f64,
            Kind::Unsigned => x as u64 as f64,
            Kind::Decimal(factor) => x as f64 * factor,
            Kind::Instant(second) => x.wrapping_sub(first) as f64 * second,
        }
    }
}

fn of_integers(column: &ColumnDescriptor, duration_s: Option<f64>) -> Result<Kind, &'static str> {
    match column.logical_type_ref() {
        Some(LogicalType::Timestamp(stamp)) => return Ok(Kind::Instant(seconds(stamp.unit))),
        Some(LogicalType::Time(time)) => return Ok(Kind::Instant(seconds(time.unit))),
        Some(LogicalType::Integer(int)) if !int.is_signed => return Ok(Kind::Unsigned),
        Some(LogicalType::Decimal(decimal)) => return Ok(scaled(decimal.scale)),
        _ => {}
    }
    Ok(match column.converted_type() {
        ConvertedType::TIMESTAMP_MILLIS | ConvertedType::TIME_MILLIS => Kind::Instant(1e-3),
        ConvertedType::TIMESTAMP_MICROS | ConvertedType::TIME_MICROS => Kind::Instant(1e-6),
        ConvertedType::DATE => Kind::Instant(86_400.0),
        ConvertedType::UINT_8 | ConvertedType::UINT_16 => Kind::Unsigned,
        ConvertedType::UINT_32 | ConvertedType::UINT_64 => Kind::Unsigned,
        ConvertedType::DECIMAL => scaled(column.type_scale()),
        _ => duration_s.map_or(Kind::Number, Kind::Decimal),
    })
}

/// What bytes stand for.
fn of_bytes(column: &ColumnDescriptor) -> &'static str {
    match (column.logical_type_ref(), column.converted_type()) {
        (Some(LogicalType::Decimal(_)), _) | (_, ConvertedType::DECIMAL) => {
            "decimals in bytes, of which only those in 32 and 64 bits are read"
        }
        (Some(LogicalType::Float16), _) => "numbers of 16 bits, which are not read",
        (_, ConvertedType::INTERVAL) => "intervals of months and days",
        (Some(LogicalType::String), _) | (_, ConvertedType::UTF8) => "text",
        _ => "bytes or text",
    }
}

fn scaled(scale: i32) -> Kind {
    Kind::Decimal(10f64.powi(scale.saturating_neg()))
}

fn seconds(unit: TimeUnit) -> f64 {
    match unit {
        TimeUnit::MILLIS => 1e-3,
        TimeUnit::MICROS => 1e-6,
        TimeUnit::NANOS => 1e-9,
    }
}

/// An old instant, nanoseconds of a Julian day and that day, as a count of nanoseconds.
fn nanoseconds(instant: Int96) -> i64 {
    const NANOSECONDS_IN_DAY: i64 = 86_400_000_000_000;
    let &[low, high, day] = instant.data() else {
        return 0;
    };
    let of_day = i64::from(low) | i64::from(high) << 32;
    i64::from(day)
        .wrapping_mul(NANOSECONDS_IN_DAY)
        .wrapping_add(of_day)
}

/// One column of all groups of rows, read from its beginning to its end; NaN where a row has no number.
pub(super) struct Column {
    file: Arc<PagedFile>,
    descriptor: ColumnDescPtr,
    index: usize,
    kind: Kind,
    /// Rows of the whole file.
    rows: u64,
    /// What follows the group of rows that `reader` reads.
    chunks: std::vec::IntoIter<Chunk>,
    reader: Option<ColumnReader>,
    /// Definition level of a value that is there; 0 when all are.
    level: i16,
    first: Option<i64>,
    held: u64,
}

impl Column {
    /// Before its first value.
    pub fn new(
        file: &Arc<PagedFile>,
        metadata: &ParquetMetaData,
        index: usize,
        kind: Kind,
    ) -> Column {
        Column {
            file: Arc::clone(file),
            descriptor: metadata.file_metadata().schema_descr().column(index),
            index,
            kind,
            rows: metadata.file_metadata().num_rows().unsigned_abs(),
            chunks: of_column(metadata, index).into_iter(),
            reader: None,
            level: 0,
            first: None,
            held: 0,
        }
    }

    /// Appends the next `rows` values.
    ///
    /// # Errors
    /// A damaged file, or one that holds fewer values than it declares.
    pub fn read(&mut self, rows: u64, values: &mut Vec<f64>) -> Result<(), ParquetError> {
        let wanted = usize::try_from(rows).unwrap_or(usize::MAX);
        let before = values.len();
        while values.len() - before < wanted {
            let left = wanted - (values.len() - before);
            let Some(mut reader) = self
                .reader
                .take()
                .map_or_else(|| self.next_reader(), |it| Ok(Some(it)))?
            else {
                let (index, held) = (self.index, self.held + (values.len() - before) as u64);
                let declared = self.rows;
                return Err(ParquetError::General(format!(
                    "column {index} holds {held} values, the file declares {declared}"
                )));
            };
            if self.take(&mut reader, left, values)? > 0 {
                self.reader = Some(reader);
            }
        }
        self.held += rows;
        Ok(())
    }

    /// Refuses what follows the last row.
    ///
    /// # Errors
    /// A damaged file, or one that holds more values than it declares.
    pub fn check_end(&mut self) -> Result<(), ParquetError> {
        let mut beyond = Vec::new();
        while let Some(mut reader) = self
            .reader
            .take()
            .map_or_else(|| self.next_reader(), |it| Ok(Some(it)))?
        {
            if self.take(&mut reader, 1, &mut beyond)? > 0 {
                let message = "a column holds more values than the file declares";
                return Err(ParquetError::General(message.to_owned()));
            }
        }
        Ok(())
    }

    fn next_reader(&mut self) -> Result<Option<ColumnReader>, ParquetError> {
        let Some(chunk) = self.chunks.next() else {
            return Ok(None);
        };
        self.level = self.descriptor.max_def_level();
        let column = chunk.metadata(&self.descriptor)?;
        let pages = Pages::new(&self.file, &column, self.rows)?;
        let descriptor = self.descriptor.clone();
        Ok(Some(get_column_reader(descriptor, Box::new(pages))))
    }

    /// Appends at most `most` values of a group; returns how many there were.
    fn take(
        &mut self,
        reader: &mut ColumnReader,
        most: usize,
        values: &mut Vec<f64>,
    ) -> Result<usize, ParquetError> {
        match reader {
            ColumnReader::DoubleColumnReader(reader) => self.batch(reader, most, values, |_, x| x),
            ColumnReader::FloatColumnReader(reader) => {
                self.batch(reader, most, values, |_, x| f64::from(x))
            }
            ColumnReader::Int64ColumnReader(reader) => {
                self.batch(reader, most, values, Column::integer)
            }
            ColumnReader::Int32ColumnReader(reader) => {
                let unsigned = self.kind == Kind::Unsigned;
                self.batch(reader, most, values, move |column, x: i32| {
                    let wide = i64::from(x);
                    column.integer(if unsigned { wide & 0xFFFF_FFFF } else { wide })
                })
            }
            ColumnReader::Int96ColumnReader(reader) => {
                self.batch(reader, most, values, |column, x| {
                    column.integer(nanoseconds(x))
                })
            }
            _ => Err(ParquetError::General(
                "another type than declared".to_owned(),
            )),
        }
    }

    fn integer(&mut self, x: i64) -> f64 {
        let first = *self.first.get_or_insert(x);
        self.kind.number(first, x)
    }

    fn batch<T: DataType>(
        &mut self,
        reader: &mut ColumnReaderImpl<T>,
        most: usize,
        values: &mut Vec<f64>,
        number: impl Fn(&mut Column, T::T) -> f64,
    ) -> Result<usize, ParquetError>
    where
        T::T: Copy,
    {
        let (mut levels, mut batch) = (Vec::new(), Vec::new());
        let wanted = (self.level > 0).then_some(&mut levels);
        let (records, _, _) = reader.read_records(most, wanted, None, &mut batch)?;
        let mut present = batch.iter().copied();
        for k in 0..records {
            let there = levels.get(k).is_none_or(|level| *level == self.level);
            let value = if there { present.next() } else { None };
            values.push(value.map_or(f64::NAN, |x| number(self, x)));
        }
        Ok(records)
    }
}
