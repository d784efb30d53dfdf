//! The columns of a binary file, all of them in memory.

use super::budget::{most_numbers, too_large};
use super::header::Header;
use super::table_file::{Row, TableFile, missing, not_finite};
use crate::read::text::source::Progress;
use recording::Error;

/// Named columns of equal length; NaN where a sample is missing.
pub(super) struct Columns {
    header: Header,
    values: Vec<Vec<f64>>,
    rows: usize,
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
            rows,
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
        for k in 0..self.rows {
            row(&Sample { columns: self, k })?;
        }
        progress(Progress {
            bytes_read: self.bytes,
            bytes_total: self.bytes,
        });
        Ok(())
    }
}

/// One sample of all columns.
struct Sample<'c> {
    columns: &'c Columns,
    k: usize,
}

impl Row for Sample<'_> {
    fn line(&self) -> u64 {
        self.k as u64 + 1
    }

    fn number(&self, column: usize, _name: &str) -> Result<Option<f64>, Error> {
        let x = self.columns.values[column][self.k];
        Ok(Some(x).filter(|x| !x.is_nan()))
    }

    fn not_finite(&self, _column: usize, name: &str, x: f64) -> Error {
        let file = &self.columns.header.file;
        not_finite(file, self.line(), name, &x.to_string(), x)
    }

    fn missing(&self, name: &str) -> Error {
        missing(&self.columns.header.file, self.line(), name)
    }
}
