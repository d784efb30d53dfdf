//! Numpy arrays as columns.

use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use recording::Column;
use std::sync::Arc;

/// The numbers of an array, and the array, which keeps them.
struct LentArray {
    numbers: *const f64,
    len: usize,
    /// Numpy frees the numbers when the last of its owners has gone.
    _owner: Py<PyArray1<f64>>,
}

// SAFETY: the numbers are only read, and `Py` may be kept and dropped on every thread.
#[allow(unsafe_code)]
unsafe impl Send for LentArray {}
// SAFETY: as above.
#[allow(unsafe_code)]
unsafe impl Sync for LentArray {}

impl AsRef<[f64]> for LentArray {
    fn as_ref(&self) -> &[f64] {
        // SAFETY: numpy said that so many numbers lie there without gaps, aligned, and the owner keeps them in place: an array
        // that somebody refers to cannot be resized. Whoever writes into them while a question is worked on gets an answer
        // about a mixture; the documentation of `Recording.from_table` says so.
        #[allow(unsafe_code)]
        unsafe {
            std::slice::from_raw_parts(self.numbers, self.len)
        }
    }
}

/// An array of `float64`: lent where it has no gaps, else copied.
///
/// # Errors
/// An array of another kind.
pub fn column(array: &Bound<'_, PyAny>) -> PyResult<Column> {
    let array = array.cast::<PyArray1<f64>>()?;
    let readable: PyReadonlyArray1<'_, f64> = array.try_readonly()?;
    let Ok(slice) = readable.as_slice() else {
        return Ok(readable.to_vec()?.into());
    };
    // Numpy gives empty arrays any address.
    if slice.is_empty() {
        return Ok(Vec::new().into());
    }
    let lent = LentArray {
        numbers: slice.as_ptr(),
        len: slice.len(),
        _owner: array.clone().unbind(),
    };
    Ok(Column::Lent(Arc::new(lent)))
}
