//! Rows of any kind in Parquet files: results, not recordings.

use std::io::Write;
use std::sync::Arc;

use parquet::basic::Compression;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::FileReader;
use parquet::file::writer::SerializedFileWriter;
use parquet::record::{RecordReader, RecordWriter};

/// Rows in one group: any usual table has one.
const GROUP: usize = 1 << 16;

/// Rows of a file that are written as they come: at most one group of them is in memory.
pub struct RowsWriter<R, W: Write + Send> {
    writer: SerializedFileWriter<W>,
    rows: Vec<R>,
}

impl<R, W: Write + Send> RowsWriter<R, W>
where
    for<'r> &'r [R]: RecordWriter<R>,
{
    /// Before the first row.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn new(file: W) -> Result<Self, ParquetError> {
        let properties = properties(Vec::new());
        let none: &[R] = &[];
        Ok(Self {
            writer: SerializedFileWriter::new(file, none.schema()?, properties)?,
            rows: Vec::new(),
        })
    }

    /// Takes the next row.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn push(&mut self, row: R) -> Result<(), ParquetError> {
        self.rows.push(row);
        match self.rows.len() {
            GROUP => self.write_group(),
            _ => Ok(()),
        }
    }

    /// Writes what is left.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(mut self) -> Result<(), ParquetError> {
        if !self.rows.is_empty() {
            self.write_group()?;
        }
        self.writer.close()?;
        Ok(())
    }

    fn write_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        self.rows.as_slice().write_to_row_group(&mut group)?;
        group.close()?;
        self.rows.clear();
        Ok(())
    }
}

fn properties(about: Vec<KeyValue>) -> Arc<WriterProperties> {
    let about = Some(about).filter(|pairs| !pairs.is_empty());
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_key_value_metadata(about)
        .build();
    Arc::new(properties)
}

/// Writes rows with pairs of key and text that say what they are. The same rows give the same bytes.
///
/// # Errors
/// A file that cannot be written.
pub fn write_rows<R>(
    file: &mut (impl Write + Send),
    rows: &[R],
    about: Vec<KeyValue>,
) -> Result<(), ParquetError>
where
    for<'r> &'r [R]: RecordWriter<R>,
{
    let mut writer = SerializedFileWriter::new(file, rows.schema()?, properties(about))?;
    for rows in rows.chunks(GROUP) {
        let mut group = writer.next_row_group()?;
        rows.write_to_row_group(&mut group)?;
        group.close()?;
    }
    writer.close()?;
    Ok(())
}

/// Reads all rows of a file.
///
/// # Errors
/// A file with other columns, or one that is damaged.
pub fn read_rows<R>(reader: &impl FileReader) -> Result<Vec<R>, ParquetError>
where
    Vec<R>: RecordReader<R>,
{
    let mut all = Vec::new();
    for k in 0..reader.num_row_groups() {
        let mut group = reader.get_row_group(k)?;
        let count = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        let mut rows: Vec<R> = Vec::with_capacity(count);
        rows.read_from_row_group(&mut *group, count)?;
        all.extend(rows);
    }
    Ok(all)
}
