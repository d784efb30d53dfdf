//! Parquet files: flat columns of numbers, in every encoding and compression of the format but brotli.

mod column;
mod extent;
mod paged_file;
mod pages;

use super::columns::{Columns, check_size};
use super::header::{Header, shown};
use super::table_file::TableFile;
use crate::contained::contained;
use crate::error::Error;
use column::Kind;
use paged_file::PagedFile;
use parquet::errors::ParquetError;
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

/// Whether a file begins as Parquet files do.
pub(super) fn is(head: &[u8]) -> bool {
    head.starts_with(b"PAR1")
}

/// Reads the columns of numbers; other columns are named in the notes.
pub(super) fn open(path: &Path) -> Result<Box<dyn TableFile>, Error> {
    let name = path.display().to_string();
    contained(|| read(path, &name)).unwrap_or_else(|| {
        let error = "a page does not hold what it declares".to_owned();
        Err(damaged(&name, &ParquetError::General(error)))
    })
}

fn read(path: &Path, name: &str) -> Result<Box<dyn TableFile>, Error> {
    let file = File::open(path).map_err(|error| Error::io(path, &error))?;
    let bytes = file.metadata().map_or(0, |metadata| metadata.len());
    let metadata = ParquetMetaDataReader::new().parse_and_finish(&file);
    let metadata = metadata.map_err(|error| damaged(name, &error))?;
    let (used, header) = header(name, &metadata)?;
    let rows = metadata.file_metadata().num_rows();
    let rows = u64::try_from(rows).map_err(|_| {
        let error = ParquetError::General(format!("it declares {rows} rows"));
        damaged(name, &error)
    })?;
    check_size(name, rows, used.len())?;
    extent::check(&metadata, bytes).map_err(|error| damaged(name, &error))?;
    let file = Arc::new(PagedFile::new(file, rows));
    let columns = used.iter().map(|(index, kind)| {
        let column = column::read(&file, &metadata, *index, *kind);
        column.map_err(|error| damaged(name, &error))
    });
    let columns = columns.collect::<Result<_, _>>()?;
    Ok(Box::new(Columns::new(header, columns, bytes)?))
}

type Used = Vec<(usize, Kind)>;

fn header(name: &str, metadata: &ParquetMetaData) -> Result<(Used, Header), Error> {
    let schema = metadata.file_metadata().schema_descr();
    let (mut used, mut names, mut notes) = (Vec::new(), Vec::new(), Vec::new());
    for (index, column) in schema.columns().iter().enumerate() {
        let path = column.path().string();
        match Kind::of(column) {
            Some(kind) => {
                used.push((index, kind));
                names.push(path);
            }
            None => notes.push(format!(
                "column {} is not used: it holds no numbers",
                shown(&path)
            )),
        }
    }
    if names.is_empty() {
        let remedy = "store each signal as a column of numbers: t, va, vb, vc, ia, ib, ic, speed";
        return Err(Error::bad(name, "holds no column of numbers", remedy));
    }
    let mut header = Header::new(name.to_owned(), 0, names)?;
    header.notes = notes;
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
