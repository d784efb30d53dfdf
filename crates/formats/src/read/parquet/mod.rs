//! Parquet files: flat columns of numbers, in every encoding and compression of the format but brotli.

mod arrow_schema;
mod chunk;
mod column;
mod content;
mod extent;
mod paged_file;
mod pages;
mod stream;

use super::header::{Header, Unreadable};
use super::table_file::TableFile;
use crate::contained::contained;
use crate::seal;
use column::Kind;
use content::Content;
use paged_file::PagedFile;
use parquet::errors::ParquetError;
use parquet::file::metadata::{
    ParquetMetaData, ParquetMetaDataOptions, ParquetMetaDataReader, ParquetStatisticsPolicy,
};
use parquet::file::reader::Length;
use recording::Error;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;
use stream::ParquetFile;

/// Whether a file begins as Parquet files do.
pub(super) fn is(head: &[u8]) -> bool {
    head.starts_with(b"PAR1")
}

/// Reads the columns of numbers; other columns are named in the notes.
pub(super) fn open(path: &Path) -> Result<Box<dyn TableFile>, Error> {
    let file = File::open(path).map_err(|error| Error::io(path, &error))?;
    of_content(&path.display().to_string(), Content::File(file))
}

/// The same of a file that is in memory.
pub(super) fn of_bytes(name: &str, bytes: Vec<u8>) -> Result<Box<dyn TableFile>, Error> {
    of_content(name, Content::Memory(bytes.into()))
}

fn of_content(name: &str, content: Content) -> Result<Box<dyn TableFile>, Error> {
    contained(|| read(name, content)).unwrap_or_else(|| {
        let error = "a page does not hold what it declares".to_owned();
        Err(damaged(name, &ParquetError::General(error)))
    })
}

fn read(name: &str, content: Content) -> Result<Box<dyn TableFile>, Error> {
    let bytes = content.len();
    let metadata = ParquetMetaDataReader::new()
        .with_metadata_options(Some(without_statistics()))
        .parse_and_finish(&content);
    let metadata = metadata.map_err(|error| damaged(name, &error))?;
    let (used, header) = header(name, &metadata)?;
    let rows = metadata.file_metadata().num_rows();
    let rows = u64::try_from(rows).map_err(|_| {
        let error = ParquetError::General(format!("it declares {rows} rows"));
        damaged(name, &error)
    })?;
    extent::check(&metadata, bytes).map_err(|error| damaged(name, &error))?;
    let file = Arc::new(PagedFile::new(content, rows));
    let seal = seal_of(&metadata);
    Ok(Box::new(ParquetFile::new(
        header, &metadata, &file, &used, seal,
    )))
}

/// Eight hours have thousands of groups of rows with minima and maxima of each column; nobody asks for them.
fn without_statistics() -> ParquetMetaDataOptions {
    ParquetMetaDataOptions::default()
        .with_column_stats_policy(ParquetStatisticsPolicy::SkipAll)
        .with_encoding_stats_policy(ParquetStatisticsPolicy::SkipAll)
        .with_size_stats_policy(ParquetStatisticsPolicy::SkipAll)
}

/// What a file of ours says of all its numbers.
fn seal_of(metadata: &ParquetMetaData) -> Option<String> {
    let file = metadata.file_metadata();
    let mut pairs = file.key_value_metadata().into_iter().flatten();
    let ours = file.created_by() == Some(seal::CREATED_BY);
    let pair = pairs.find(|pair| pair.key == seal::KEY && pair.value.is_some());
    pair.and_then(|pair| pair.value.clone()).filter(|_| ours)
}

type Used = Vec<(usize, Kind)>;

fn header(name: &str, metadata: &ParquetMetaData) -> Result<(Used, Header), Error> {
    let schema = metadata.file_metadata().schema_descr();
    let durations = arrow_schema::durations(metadata.file_metadata().key_value_metadata());
    let (mut used, mut names, mut unreadable) = (Vec::new(), Vec::new(), Vec::new());
    for (index, column) in schema.columns().iter().enumerate() {
        let path = column.path().string();
        match Kind::of(column, durations.get(&path).copied()) {
            Ok(kind) => {
                used.push((index, kind));
                names.push(path);
            }
            // A list has its own names inside; what the user knows is the name of the whole.
            Err(what) => unreadable.push(Unreadable::holds(&column.path().parts()[0], what)),
        }
    }
    if names.is_empty() {
        let remedy = "store each signal as a column of numbers: t, va, vb, vc, ia, ib, ic, speed";
        return Err(Error::bad(name, "holds no column of numbers", remedy));
    }
    let mut header = Header::new(name.to_owned(), 0, names)?;
    header.unreadable = unreadable;
    Ok((used, header))
}

fn damaged(name: &str, error: &ParquetError) -> Error {
    let text = error.to_string();
    let text: String = text
        .lines()
        .next()
        .unwrap_or_default()
        .chars()
        .take(200)
        .collect();
    if text.contains("Disabled feature") || text.contains("brotli") {
        let message = format!("is compressed in a way that is not read ({text})");
        let remedy = "write it again with snappy, zstd, gzip, lz4 or without compression";
        return Error::unsupported(name, message, remedy);
    }
    let message = format!("is no Parquet file, or a truncated or damaged one ({text})");
    Error::bad(name, message, "copy or export the file again")
}
