//! Columns of other libraries: contiguous `float64` is lent to a recording, everything else is converted into numbers of its own.

mod arrays;
mod arrow;

use formats::MemoryTable;
use pyo3::prelude::*;
use recording::Column;

/// A column as it came: numbers, or what else it holds.
pub type Taken = Result<Column, &'static str>;

/// Sorts columns into those of numbers and the others.
pub fn table(name: &str, columns: impl IntoIterator<Item = (String, Taken)>) -> MemoryTable {
    let mut table = MemoryTable {
        name: name.to_owned(),
        ..MemoryTable::default()
    };
    for (name, taken) in columns {
        match taken {
            Ok(column) => table.columns.push((name, column)),
            Err(what) => table.others.push((name, what)),
        }
    }
    table
}

/// The columns of anything that exports an Arrow stream.
///
/// # Errors
/// An object without one, or a stream that breaks off.
pub fn of_arrow(table: &Bound<'_, PyAny>) -> PyResult<Vec<(String, Taken)>> {
    arrow::columns(table)
}

/// Columns of one-dimensional numpy arrays of `float64`; a name without an array holds something else.
///
/// # Errors
/// An array of another kind: the caller converts before.
pub fn of_arrays(
    arrays: Vec<(String, Option<Bound<'_, PyAny>>)>,
) -> PyResult<Vec<(String, Taken)>> {
    let one = |(name, array): (String, Option<Bound<'_, PyAny>>)| match array {
        Some(array) => Ok((name, Ok(arrays::column(&array)?))),
        None => Ok((name, Err("something other than numbers"))),
    };
    arrays.into_iter().map(one).collect()
}
