//! A Parquet file block by block: of each column one page is in memory at a time.

use super::column::{Column, Kind};
use super::damaged;
use super::paged_file::PagedFile;
use crate::contained::contained;
use crate::read::columns::check_size;
use crate::read::header::Header;
use crate::read::table_file::{Block, Row, TableFile};
use crate::read::text::source::Progress;
use crate::seal::Seal;
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::ParquetMetaData;
use recording::Error;
use std::sync::Arc;

/// Rows of a block.
const BLOCK: u64 = 1 << 13;

/// A Parquet file of which the footer has been read.
pub(super) struct ParquetFile {
    header: Header,
    columns: Vec<Column>,
    rows: u64,
    bytes: u64,
    /// What the file says of all its numbers, and what they say so far, where it was written by us.
    seal: Option<(String, Seal)>,
}

impl ParquetFile {
    /// `used`: index and kind of the columns that the header names; `seal`: what the file says of its numbers.
    pub fn new(
        header: Header,
        metadata: &ParquetMetaData,
        file: &Arc<PagedFile>,
        used: &[(usize, Kind)],
        seal: Option<String>,
    ) -> ParquetFile {
        let of = |(index, kind): &(usize, Kind)| Column::new(file, metadata, *index, *kind);
        let names = header.names.iter().map(String::as_str);
        ParquetFile {
            columns: used.iter().map(of).collect(),
            rows: metadata.file_metadata().num_rows().unsigned_abs(),
            bytes: parquet::file::reader::Length::len(&**file),
            seal: seal.map(|said| (said, Seal::new(names))),
            header,
        }
    }

    /// The next rows of all columns, fewer than asked for at the end.
    fn read(&mut self, rows: u64, values: &mut [Vec<f64>]) -> Result<()> {
        for (column, values) in self.columns.iter_mut().zip(values.iter_mut()) {
            values.clear();
            column.read(rows, values)?;
        }
        if let Some((_, seal)) = &mut self.seal {
            seal.add(values);
        }
        Ok(())
    }

    fn check_end(&mut self) -> Result<()> {
        self.columns.iter_mut().try_for_each(Column::check_end)?;
        match &self.seal {
            Some((said, seal)) if *said != seal.sum(self.rows) => Err(ParquetError::General(
                "its checksum does not fit".to_owned(),
            )),
            _ => Ok(()),
        }
    }

    /// What `work` returns; whatever the library finds wrong, or panics at, is a damaged file.
    fn guarded<T>(
        &mut self,
        work: impl FnOnce(&mut ParquetFile) -> Result<T>,
    ) -> std::result::Result<T, Error> {
        let done = contained(|| work(self)).unwrap_or_else(|| {
            let what = "a page does not hold what it declares".to_owned();
            Err(ParquetError::General(what))
        });
        done.map_err(|error| damaged(&self.header.file, &error))
    }

    fn progress(&self, done: u64) -> Progress {
        let share = done as f64 / self.rows.max(1) as f64;
        Progress {
            bytes_read: (share * self.bytes as f64) as u64,
            bytes_total: self.bytes,
        }
    }
}

impl TableFile for ParquetFile {
    fn header(&self) -> &Header {
        &self.header
    }

    fn for_each_row(
        &mut self,
        progress: &mut dyn FnMut(Progress),
        row: &mut dyn FnMut(&dyn Row) -> std::result::Result<(), Error>,
    ) -> std::result::Result<(), Error> {
        let each = &mut |block: &Block<'_>| (0..block.rows()).try_for_each(|k| row(&block.row(k)));
        self.for_each_block(progress, each).map(drop)
    }

    fn for_each_block(
        &mut self,
        progress: &mut dyn FnMut(Progress),
        block: &mut dyn FnMut(&Block<'_>) -> std::result::Result<(), Error>,
    ) -> std::result::Result<bool, Error> {
        let mut values = vec![Vec::new(); self.columns.len()];
        let mut done = 0;
        while done < self.rows {
            let rows = BLOCK.min(self.rows - done);
            self.guarded(|file| file.read(rows, &mut values))?;
            block(&Block::new(&self.header.file, &values, done + 1))?;
            done += rows;
            progress(self.progress(done));
        }
        self.guarded(ParquetFile::check_end)?;
        Ok(true)
    }

    fn check_size(&self) -> std::result::Result<(), Error> {
        check_size(&self.header.file, self.rows, self.columns.len())
    }
}
