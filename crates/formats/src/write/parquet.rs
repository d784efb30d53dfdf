//! A recording as a Parquet file: doubles in groups of rows, compressed with zstd, each page with its checksum.

use super::pages::Pages;
use super::{Next, columns};
use crate::seal::{self, Seal};
use bytes::Bytes;
use parquet::basic::{Compression, Repetition, Type as Physical, ZstdLevel};
use parquet::column::writer::{get_column_writer, get_typed_column_writer};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterPropertiesPtr};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use recording::Recording;
use std::io::{self, Write};
use std::sync::Arc;

/// Writes the clock and every measured channel, bit by bit: each piece as a group of rows.
pub(super) fn write<W: Write + Send>(next: &mut Next<'_, '_>, out: W) -> io::Result<()> {
    let Some(first) = next()? else {
        return Err(io::Error::other("a recording without a sample"));
    };
    let mut table = Table::new(&first, out).map_err(io::Error::other)?;
    table.add(&first).map_err(io::Error::other)?;
    drop(first);
    while let Some(piece) = next()? {
        table.add(&piece).map_err(io::Error::other)?;
    }
    table.finish().map_err(io::Error::other)
}

/// A file that is being written.
struct Table<W: Write + Send> {
    writer: SerializedFileWriter<W>,
    properties: WriterPropertiesPtr,
    seal: Seal,
    rows: u64,
}

impl<W: Write + Send> Table<W> {
    fn new(first: &Recording, out: W) -> Result<Self, ParquetError> {
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .set_dictionary_enabled(false)
            .set_created_by(seal::CREATED_BY.to_owned())
            .set_statistics_enabled(EnabledStatistics::Chunk)
            .build();
        let properties = Arc::new(properties);
        let names: Vec<String> = named(first).into_iter().map(|(name, _)| name).collect();
        Ok(Table {
            writer: SerializedFileWriter::new(out, schema(&names)?, Arc::clone(&properties))?,
            properties,
            seal: Seal::new(names.iter().map(String::as_str)),
            rows: 0,
        })
    }

    fn add(&mut self, piece: &Recording) -> Result<(), ParquetError> {
        let (_, all): (Vec<String>, Vec<&[f64]>) = named(piece).into_iter().unzip();
        self.seal.add(&all);
        self.rows += piece.len() as u64;
        let columns = self.writer.schema_descr().columns().to_vec();
        let mut group = self.writer.next_row_group()?;
        for (column, values) in columns.into_iter().zip(all) {
            let mut pages = Vec::new();
            let written = {
                let pages = Box::new(Pages::new(&mut pages));
                let column = get_column_writer(column, Arc::clone(&self.properties), pages);
                let mut column = get_typed_column_writer::<DoubleType>(column);
                column.write_batch(values, None, None)?;
                column.close()?
            };
            group.append_column(&Bytes::from(pages), written)?;
        }
        group.close()?;
        Ok(())
    }

    fn finish(mut self) -> Result<(), ParquetError> {
        let sum = self.seal.sum(self.rows);
        let pair = KeyValue::new(seal::KEY.to_owned(), sum);
        self.writer.append_key_value_metadata(pair);
        self.writer.into_inner()?.flush()?;
        Ok(())
    }
}

/// The columns that are written.
fn named(recording: &Recording) -> Vec<(String, &[f64])> {
    let clock = ("t".to_owned(), recording.t());
    let channels = columns(recording);
    let channels = channels
        .iter()
        .map(|(channel, x)| (channel.to_string(), *x));
    std::iter::once(clock).chain(channels).collect()
}

fn schema(names: &[String]) -> Result<Arc<Type>, ParquetError> {
    let column = |name: &String| {
        let column = Type::primitive_type_builder(name, Physical::DOUBLE);
        let column = column.with_repetition(Repetition::REQUIRED).build()?;
        Ok(Arc::new(column))
    };
    let fields: Result<Vec<_>, ParquetError> = names.iter().map(column).collect();
    let schema = Type::group_type_builder("recording")
        .with_fields(fields?)
        .build()?;
    Ok(Arc::new(schema))
}
