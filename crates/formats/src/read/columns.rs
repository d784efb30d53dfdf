//! The columns of a binary file, all of them in memory.

use super::budget::{most_numbers, too_large};
use super::header::Header;
use super::table_file::{Block, Row, TableFile};
use crate::read::text::source::Progress;
use recording::Error;

/// Named columns of equal length; NaN where a sample is missing.
pub(super) struct Columns {
    header: Header,
    values: Vec<Vec<f64>>,
    bytes: u64,
}

impl Columns {
    /// Columns of a file of `bytes` bytes, as many as the header names.
    ///
    /// # Errors
    /// Columns of unequal length.
    pub fn new(header: Header, values: Vec<Vec<f64>>, bytes: u64) -> Result<Columns, Error> {
        let rows = values.first().map_or(0, Vec::len);
        if let Some(k) = values.iter().position(|column| column.len() != rows) {
            let (name, first) = (&header.names[k], &header.names[0]);
            let message = format!("holds {} values, {first} holds {rows}", values[k].len());
            return Err(header.error(name, message, "give every column one value per sample"));
        }
        Ok(Columns {
            header,
            values,
            bytes,
        })
    }
}

/// Refuses what would not fit into memory, before it is read.
///
/// # Errors
/// More numbers than [`most_numbers`].
pub(super) fn check_size(file: &str, rows: u64, columns: usize) -> Result<(), Error> {
    match rows.saturating_mul(columns as u64) > most_numbers() {
        true => Err(too_large(file)),
        false => Ok(()),
    }
}

impl TableFile for Columns {
    fn header(&self) -> &Header {
        &self.header
    }

    fn for_each_row(
        &mut self,
        progress: &mut dyn FnMut(Progress),
        row: &mut dyn FnMut(&dyn Row) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let block = Block::new(&self.header.file, &self.values, 1);
        (0..block.rows()).try_for_each(|k| row(&block.row(k)))?;
        progress(Progress {
            bytes_read: self.bytes,
            bytes_total: self.bytes,
        });
        Ok(())
    }
}
