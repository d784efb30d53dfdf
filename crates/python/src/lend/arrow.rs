//! Arrow tables as columns: polars, pyarrow, DuckDB and whatever else exports a stream.

use super::Taken;
use arrow_array::cast::AsArray;
use arrow_array::ffi_stream::{FFI_ArrowArrayStream, RecordBatchStreamReader};
use arrow_array::types::{
    ArrowPrimitiveType, DurationMicrosecondType, DurationMillisecondType, DurationNanosecondType,
    DurationSecondType, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type,
    TimestampMicrosecondType, TimestampMillisecondType, TimestampNanosecondType,
    TimestampSecondType, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, Float64Array, RecordBatchReader};
use arrow_schema::{DataType, TimeUnit};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use recording::Column;
use std::sync::Arc;

/// The columns of a table; of several pieces one is made.
pub fn columns(table: &Bound<'_, PyAny>) -> PyResult<Vec<(String, Taken)>> {
    let reader = stream(table)?;
    let names: Vec<String> = reader
        .schema()
        .fields()
        .iter()
        .map(|field| field.name().clone())
        .collect();
    let mut pieces: Vec<Vec<ArrayRef>> = vec![Vec::new(); names.len()];
    for batch in reader {
        let batch = batch.map_err(|error| PyTypeError::new_err(error.to_string()))?;
        for (of_column, array) in pieces.iter_mut().zip(batch.columns()) {
            of_column.push(Arc::clone(array));
        }
    }
    let columns = pieces.iter().map(|pieces| column(pieces));
    Ok(names.into_iter().zip(columns).collect())
}

/// The stream behind the Arrow PyCapsule interface.
fn stream(table: &Bound<'_, PyAny>) -> PyResult<RecordBatchStreamReader> {
    let capsule = table.call_method0("__arrow_c_stream__")?;
    let capsule = capsule.cast::<PyCapsule>()?;
    let pointer = capsule.pointer_checked(Some(c"arrow_array_stream"))?;
    // SAFETY: a capsule of this name holds an ArrowArrayStream by the interface's definition; it is moved out, and the empty
    // one that stays is what the capsule's destructor expects.
    #[allow(unsafe_code)]
    let reader = unsafe {
        RecordBatchStreamReader::from_raw(pointer.as_ptr().cast::<FFI_ArrowArrayStream>())
    };
    reader.map_err(|error| PyTypeError::new_err(error.to_string()))
}

/// Numbers that an Arrow array keeps.
struct LentArrow(Float64Array);

impl AsRef<[f64]> for LentArrow {
    fn as_ref(&self) -> &[f64] {
        self.0.values()
    }
}

fn column(pieces: &[ArrayRef]) -> Taken {
    if let [only] = pieces
        && let Some(numbers) = only.as_primitive_opt::<Float64Type>()
        && numbers.null_count() == 0
    {
        return Ok(Column::Lent(Arc::new(LentArrow(numbers.clone()))));
    }
    let mut numbers = Vec::with_capacity(pieces.iter().map(|piece| piece.len()).sum());
    let mut origin = None;
    for piece in pieces {
        append(piece, &mut numbers, &mut origin)?;
    }
    Ok(numbers.into())
}

/// Adds the numbers of a piece, NaN where one is missing. Stamps become seconds since the first of them.
fn append(
    piece: &ArrayRef,
    to: &mut Vec<f64>,
    origin: &mut Option<i64>,
) -> Result<(), &'static str> {
    match piece.data_type() {
        DataType::Float64 => add::<Float64Type>(piece, to, |x| x),
        DataType::Float32 => add::<Float32Type>(piece, to, f64::from),
        DataType::Int8 => add::<Int8Type>(piece, to, f64::from),
        DataType::Int16 => add::<Int16Type>(piece, to, f64::from),
        DataType::Int32 => add::<Int32Type>(piece, to, f64::from),
        DataType::Int64 => add::<Int64Type>(piece, to, |x| x as f64),
        DataType::UInt8 => add::<UInt8Type>(piece, to, f64::from),
        DataType::UInt16 => add::<UInt16Type>(piece, to, f64::from),
        DataType::UInt32 => add::<UInt32Type>(piece, to, f64::from),
        DataType::UInt64 => add::<UInt64Type>(piece, to, |x| x as f64),
        DataType::Timestamp(unit, _) => stamps(piece, *unit, to, origin),
        DataType::Duration(unit) => durations(piece, *unit, to),
        DataType::Boolean => return Err("truth values"),
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => return Err("text"),
        _ => return Err("something other than numbers"),
    }
    Ok(())
}

fn add<T: ArrowPrimitiveType>(
    piece: &ArrayRef,
    to: &mut Vec<f64>,
    number: impl Fn(T::Native) -> f64,
) {
    let values = piece.as_primitive::<T>().iter();
    to.extend(values.map(|value| value.map_or(f64::NAN, &number)));
}

/// One of a unit, s.
fn seconds(unit: TimeUnit) -> f64 {
    match unit {
        TimeUnit::Second => 1.0,
        TimeUnit::Millisecond => 1e-3,
        TimeUnit::Microsecond => 1e-6,
        TimeUnit::Nanosecond => 1e-9,
    }
}

fn stamps(piece: &ArrayRef, unit: TimeUnit, to: &mut Vec<f64>, origin: &mut Option<i64>) {
    let one = seconds(unit);
    // The difference is taken of whole numbers: a stamp of today in nanoseconds has more digits than f64.
    let since = |x: i64| one * x.wrapping_sub(*origin.get_or_insert(x)) as f64;
    match unit {
        TimeUnit::Second => add_stamps::<TimestampSecondType>(piece, to, since),
        TimeUnit::Millisecond => add_stamps::<TimestampMillisecondType>(piece, to, since),
        TimeUnit::Microsecond => add_stamps::<TimestampMicrosecondType>(piece, to, since),
        TimeUnit::Nanosecond => add_stamps::<TimestampNanosecondType>(piece, to, since),
    }
}

fn add_stamps<T: ArrowPrimitiveType<Native = i64>>(
    piece: &ArrayRef,
    to: &mut Vec<f64>,
    mut since: impl FnMut(i64) -> f64,
) {
    let values = piece.as_primitive::<T>().iter();
    to.extend(values.map(|value| value.map_or(f64::NAN, &mut since)));
}

fn durations(piece: &ArrayRef, unit: TimeUnit, to: &mut Vec<f64>) {
    let one = seconds(unit);
    let number = |x: i64| one * x as f64;
    match unit {
        TimeUnit::Second => add::<DurationSecondType>(piece, to, number),
        TimeUnit::Millisecond => add::<DurationMillisecondType>(piece, to, number),
        TimeUnit::Microsecond => add::<DurationMicrosecondType>(piece, to, number),
        TimeUnit::Nanosecond => add::<DurationNanosecondType>(piece, to, number),
    }
}
