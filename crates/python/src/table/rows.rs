//! Columns of an answer's list as a table.

use arrow_array::builder::{Float64Builder, ListBuilder};
use arrow_array::{
    ArrayRef, BooleanArray, Float64Array, RecordBatch, RecordBatchOptions, StringArray,
};
use arrow_schema::{ArrowError, Field, Schema};
use pyo3::FromPyObject;
use std::sync::Arc;

/// The cells of one column; the first kind that fits all of them.
#[derive(Debug, FromPyObject)]
pub enum Cells {
    Truths(Vec<Option<bool>>),
    Numbers(Vec<Option<f64>>),
    Lists(Vec<Option<Vec<f64>>>),
    Texts(Vec<Option<String>>),
}

/// The table.
pub fn batch(rows: usize, columns: Vec<(String, Cells)>) -> Result<RecordBatch, ArrowError> {
    let of = |(name, cells): (String, Cells)| {
        let array = array(cells);
        (Field::new(name, array.data_type().clone(), true), array)
    };
    let (fields, arrays): (Vec<Field>, Vec<ArrayRef>) = columns.into_iter().map(of).unzip();
    let options = RecordBatchOptions::new().with_row_count(Some(rows));
    RecordBatch::try_new_with_options(Arc::new(Schema::new(fields)), arrays, &options)
}

fn array(cells: Cells) -> ArrayRef {
    match cells {
        // What no row has is a number that is missing.
        Cells::Truths(truths) if truths.iter().all(Option::is_none) => {
            Arc::new(Float64Array::new_null(truths.len()))
        }
        Cells::Truths(truths) => Arc::new(BooleanArray::from(truths)),
        Cells::Numbers(numbers) => Arc::new(Float64Array::from(numbers)),
        Cells::Lists(lists) => Arc::new(of_lists(lists)),
        Cells::Texts(texts) => Arc::new(StringArray::from(texts)),
    }
}

fn of_lists(lists: Vec<Option<Vec<f64>>>) -> arrow_array::ListArray {
    let mut builder = ListBuilder::new(Float64Builder::new());
    for list in lists {
        let there = list.is_some();
        builder.values().append_slice(&list.unwrap_or_default());
        builder.append(there);
    }
    builder.finish()
}
