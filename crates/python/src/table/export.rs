//! Arrow streams for other libraries.

use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{ArrayRef, Float64Array, RecordBatch, RecordBatchIterator};
use arrow_buffer::{Buffer, ScalarBuffer};
use arrow_schema::{Field, Schema};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use recording::{Column, Recording, Source, TableColumn};
use std::ptr::NonNull;
use std::sync::Arc;

/// The stream of one batch.
pub fn batch(py: Python<'_>, batch: RecordBatch) -> PyResult<Bound<'_, PyCapsule>> {
    let schema = batch.schema();
    let batches = RecordBatchIterator::new([Ok(batch)], schema);
    let stream = FFI_ArrowArrayStream::new(Box::new(batches));
    PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
}

/// The stream of a recording, clock first, or of a load table. The numbers of a recording are lent.
pub fn recording<'py>(py: Python<'py>, source: &Source) -> PyResult<Bound<'py, PyCapsule>> {
    let columns = match source {
        Source::Recording(recording) => of_recording(recording),
        Source::LoadTable(table) => TableColumn::ALL
            .into_iter()
            .filter_map(|column| {
                let values = table.column(column)?.to_vec();
                let array: ArrayRef = Arc::new(Float64Array::from(values));
                Some((column.name().to_owned(), array))
            })
            .collect(),
    };
    let fields = columns.iter();
    let fields: Vec<Field> = fields
        .map(|(name, array)| Field::new(name, array.data_type().clone(), false))
        .collect();
    let arrays = columns.into_iter().map(|(_, array)| array).collect();
    let whole = RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays);
    batch(
        py,
        whole.map_err(|error| crate::errors::usage(error.to_string()))?,
    )
}

fn of_recording(recording: &Recording) -> Vec<(String, ArrayRef)> {
    let names = recording.channels().map(|(channel, _)| channel);
    let channels = names.filter_map(|channel| {
        let column = recording.column(channel)?;
        Some((channel.to_string(), lent(column)))
    });
    let clock = ("t".to_owned(), lent(recording.t_column()));
    std::iter::once(clock).chain(channels).collect()
}

/// What keeps the numbers of an exported array.
struct Owner(#[allow(dead_code)] Column);

// A panic cannot leave a column half changed: nothing changes it.
impl std::panic::RefUnwindSafe for Owner {}

/// A column of a recording as an array over the same numbers.
#[allow(unsafe_code)]
fn lent(column: &Column) -> ArrayRef {
    // A clone of a lent column is over the same numbers; that of an owned one has its own.
    let kept = column.clone();
    let (pointer, len) = (kept.as_ptr(), kept.len());
    let Some(pointer) = NonNull::new(pointer.cast_mut().cast::<u8>()) else {
        return Arc::new(Float64Array::from(column.to_vec()));
    };
    // SAFETY: so many numbers lie there, and the owner keeps them where they are for as long as the buffer lives: a vector that
    // is moved does not move its numbers. Nothing writes into a recording.
    let buffer = unsafe {
        Buffer::from_custom_allocation(pointer, len * size_of::<f64>(), Arc::new(Owner(kept)))
    };
    Arc::new(Float64Array::new(ScalarBuffer::new(buffer, 0, len), None))
}
