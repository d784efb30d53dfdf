//! Tables that go out: recordings and the lists of an answer, as Arrow.

pub mod export;
mod rows;

use arrow_array::RecordBatch;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;

/// A table of an answer. `pyarrow.table(x)`, `polars.DataFrame(x)` and whatever else takes Arrow streams read it.
#[pyclass(frozen, module = "drivemon._drivemon")]
#[derive(Debug)]
pub struct Table {
    batch: RecordBatch,
}

#[pymethods]
impl Table {
    #[staticmethod]
    fn of_columns(rows: usize, columns: Vec<(String, rows::Cells)>) -> PyResult<Table> {
        let batch = rows::batch(rows, columns);
        let batch = batch.map_err(|error| crate::errors::usage(error.to_string()))?;
        Ok(Table { batch })
    }

    #[getter]
    fn columns(&self) -> Vec<String> {
        let schema = self.batch.schema();
        let fields = schema.fields().iter();
        fields.map(|field| field.name().clone()).collect()
    }

    fn __len__(&self) -> usize {
        self.batch.num_rows()
    }

    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // The interface lets an exporter answer in its own types.
        let _ = requested_schema;
        export::batch(py, self.batch.clone())
    }

    fn __repr__(&self) -> String {
        format!(
            "<drivemon.Table: {} rows, {}>",
            self.batch.num_rows(),
            self.columns().join(" ")
        )
    }
}
