//! A recording as a Parquet file: one group of rows, doubles, compressed with zstd.

use super::columns;
use crate::recording::Recording;
use parquet::basic::{Compression, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::io::{self, Write};
use std::sync::Arc;

/// Writes the clock and every measured channel, bit by bit.
pub(super) fn write<W: Write + Send>(recording: &Recording, out: W) -> io::Result<()> {
    write_columns(recording, out).map_err(io::Error::other)
}

fn write_columns<W: Write + Send>(recording: &Recording, out: W) -> Result<(), ParquetError> {
    let channels = columns(recording);
    let clock = ("t".to_owned(), recording.t());
    let named = channels
        .iter()
        .map(|(channel, x)| (channel.to_string(), *x));
    let all: Vec<(String, &[f64])> = std::iter::once(clock).chain(named).collect();
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_dictionary_enabled(false)
        .set_created_by("drive-monitor".to_owned())
        .build();
    let mut writer = SerializedFileWriter::new(out, schema(&all)?, Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for (_, values) in &all {
        if let Some(mut column) = group.next_column()? {
            column
                .typed::<DoubleType>()
                .write_batch(values, None, None)?;
            column.close()?;
        }
    }
    group.close()?;
    writer.into_inner()?.flush()?;
    Ok(())
}

fn schema(columns: &[(String, &[f64])]) -> Result<Arc<Type>, ParquetError> {
    let column = |(name, _): &(String, _)| {
        let column = Type::primitive_type_builder(name, Physical::DOUBLE);
        let column = column.with_repetition(Repetition::REQUIRED).build()?;
        Ok(Arc::new(column))
    };
    let fields: Result<Vec<_>, ParquetError> = columns.iter().map(column).collect();
    let schema = Type::group_type_builder("recording")
        .with_fields(fields?)
        .build()?;
    Ok(Arc::new(schema))
}
