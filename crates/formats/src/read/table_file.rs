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
