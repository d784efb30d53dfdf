//! A file of named columns, whatever its format.

use super::header::Header;
use crate::read::text::source::Progress;
use recording::{Error, Mapping};

/// A file of which the header has been read.
pub(super) trait TableFile {
    /// The names of its columns.
    fn header(&self) -> &Header;

    /// Calls `row` for every row in the order of the file, and `progress` every few milliseconds.
    ///
    /// # Errors
    /// A damaged row, or what `row` returns.
    fn for_each_row(
        &mut self,
        progress: &mut dyn FnMut(Progress),
        row: &mut dyn FnMut(&dyn Row) -> Result<(), Error>,
    ) -> Result<(), Error>;

    /// Calls `block` for blocks of rows in the order of the file, where it holds columns; `false` where it holds rows, of
    /// which none was read then.
    ///
    /// # Errors
    /// A damaged file, or what `block` returns.
    fn for_each_block(
        &mut self,
        _progress: &mut dyn FnMut(Progress),
        _block: &mut dyn FnMut(&Block<'_>) -> Result<(), Error>,
    ) -> Result<bool, Error> {
        Ok(false)
    }

    /// Refuses a file that says by itself that it would not fit into memory.
    ///
    /// # Errors
    /// More numbers than a file may hold that is kept as a whole.
    fn check_size(&self) -> Result<(), Error> {
        Ok(())
    }

    /// How the file is laid out, in the words of a sidecar.
    fn layout(&self) -> Mapping {
        Mapping::default()
    }

    /// What the rows took to be read, one sentence each; complete after the last row.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
}

/// One row of a file.
pub(super) trait Row {
    /// Its line in a text file, its number in a binary one, counted from 1.
    fn line(&self) -> u64;

    /// The number in a column, infinite where the instrument overflowed; `None` where there is none.
    ///
    /// # Errors
    /// A cell that holds something else.
    fn number(&self, column: usize, name: &str) -> Result<Option<f64>, Error>;

    /// The error for a cell without a number.
    fn missing(&self, name: &str) -> Error;

    /// The error for a cell whose number is infinite.
    fn not_finite(&self, column: usize, name: &str, x: f64) -> Error;
}

/// Consecutive rows of a file that holds columns; NaN where a number is missing.
pub(super) struct Block<'b> {
    file: &'b str,
    columns: &'b [Vec<f64>],
    rows: usize,
    /// Number of the first row, counted from 1.
    first: u64,
}

impl<'b> Block<'b> {
    /// All columns of a file, each with as many numbers as there are rows; `first` counts from 1.
    pub fn new(file: &'b str, columns: &'b [Vec<f64>], first: u64) -> Block<'b> {
        Block {
            file,
            rows: columns.first().map_or(0, Vec::len),
            columns,
            first,
        }
    }

    /// How many rows it holds.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The numbers of a column.
    pub fn column(&self, index: usize) -> &[f64] {
        &self.columns[index]
    }

    /// Row `k` of the block.
    pub fn row(&self, k: usize) -> BlockRow<'_> {
        BlockRow { block: self, k }
    }
}

/// One row of a block.
pub(super) struct BlockRow<'b> {
    block: &'b Block<'b>,
    k: usize,
}

impl Row for BlockRow<'_> {
    fn line(&self) -> u64 {
        self.block.first + self.k as u64
    }

    fn number(&self, column: usize, _name: &str) -> Result<Option<f64>, Error> {
        let x = self.block.columns[column][self.k];
        Ok(Some(x).filter(|x| !x.is_nan()))
    }

    fn not_finite(&self, _column: usize, name: &str, x: f64) -> Error {
        not_finite(self.block.file, self.line(), name, &x.to_string(), x)
    }

    fn missing(&self, name: &str) -> Error {
        missing(self.block.file, self.line(), name)
    }
}

/// The error for a cell without a number.
pub(super) fn missing(file: &str, line: u64, name: &str) -> Error {
    let remedy = "fill the cell, remove the row, or let --skip-missing drop such rows";
    let message = "the cell holds no number (empty or NaN)";
    Error::at(file, line, name, message, remedy)
}

/// The error for an infinite number, as the file writes it.
pub(super) fn not_finite(file: &str, line: u64, name: &str, text: &str, x: f64) -> Error {
    let remedy = "an overflow of the instrument: remove the row, or use --skip-missing";
    Error::at(file, line, name, format!("`{text}` is {x}"), remedy)
}
