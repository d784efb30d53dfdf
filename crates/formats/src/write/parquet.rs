//! A recording as a Parquet file: one group of rows, doubles, compressed with zstd, each page with its checksum.

use super::columns;
use super::pages::Pages;
use crate::seal;
use bytes::Bytes;
use parquet::basic::{Compression, Repetition, Type as Physical, ZstdLevel};
use parquet::column::writer::{get_column_writer, get_typed_column_writer};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use recording::Recording;
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
    let sum = seal::of(all.iter().map(|(name, x)| (name.as_str(), *x)));
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_dictionary_enabled(false)
        .set_created_by(seal::CREATED_BY.to_owned())
        .set_key_value_metadata(Some(vec![KeyValue::new(seal::KEY.to_owned(), sum)]))
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .build();
    let properties = Arc::new(properties);
    let mut writer = SerializedFileWriter::new(out, schema(&all)?, Arc::clone(&properties))?;
    let columns = writer.schema_descr().columns().to_vec();
    let mut group = writer.next_row_group()?;
    for (column, (_, values)) in columns.into_iter().zip(&all) {
        let mut pages = Vec::new();
        let written = {
            let pages = Box::new(Pages::new(&mut pages));
            let column = get_column_writer(column, Arc::clone(&properties), pages);
            let mut column = get_typed_column_writer::<DoubleType>(column);
            column.write_batch(values, None, None)?;
            column.close()?
        };
        group.append_column(&Bytes::from(pages), written)?;
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
