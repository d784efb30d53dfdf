//! Recordings and load tables, from files and from tables in memory.

use crate::errors::{of_recording, unsupported, usage};
use crate::lend;
use crate::table::export;
use crate::work::run;
use audit::{Expectation, audit};
use formats::{read_any, read_table};
use numpy::PyArray1;
use numpy::ndarray::ArrayView1;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use recording::{Channel, Column, Flags, Source, TableColumn};
use std::path::PathBuf;

/// How a file is to be read, as the flags of the commands say it.
#[derive(Debug, FromPyObject)]
#[pyo3(from_item_all)]
pub struct PyFlags {
    column: Vec<String>,
    columns: Option<String>,
    sensor: Vec<String>,
    unit: Vec<String>,
    scale: Vec<String>,
    offset: Vec<String>,
    delay: Vec<String>,
    sample_rate: Option<f64>,
    line_voltages: bool,
    skip_missing: bool,
    delimiter: Option<String>,
    decimal_comma: bool,
    thousands: Option<String>,
    date_order: Option<String>,
    pulses_per_revolution: Option<u32>,
    sidecar: Option<PathBuf>,
}

impl From<PyFlags> for Flags {
    fn from(flags: PyFlags) -> Flags {
        Flags {
            column: flags.column,
            columns: flags.columns,
            sensor: flags.sensor,
            unit: flags.unit,
            scale: flags.scale,
            offset: flags.offset,
            delay: flags.delay,
            sample_rate: flags.sample_rate,
            line_voltages: flags.line_voltages,
            skip_missing: flags.skip_missing,
            delimiter: flags.delimiter,
            decimal_comma: flags.decimal_comma,
            thousands: flags.thousands,
            date_order: flags.date_order,
            pulses_per_revolution: flags.pulses_per_revolution,
            sidecar: flags.sidecar,
        }
    }
}

/// A recording or a load table. Copies share their numbers.
#[pyclass(frozen, from_py_object, module = "drivemon._drivemon")]
#[derive(Clone, Debug)]
pub struct Recording {
    pub source: Source,
    /// The flags that it was read with, as they are typed; nothing for what is no file.
    pub typed: Option<String>,
}

impl Recording {
    /// Numbers are shared from here on: a question works on a copy.
    pub fn new(source: Source, typed: Option<String>) -> Recording {
        let source = match source {
            Source::Recording(recording) => Source::Recording(recording.lent()),
            table @ Source::LoadTable(_) => table,
        };
        Recording { source, typed }
    }

    /// Its samples.
    ///
    /// # Errors
    /// A load table, with what takes it.
    pub fn samples(&self) -> PyResult<&recording::Recording> {
        match &self.source {
            Source::Recording(recording) => Ok(recording),
            Source::LoadTable(table) => Err(unsupported(format!(
                "{}: a load table has no waveforms; compare, explain and adopt take it",
                table.name()
            ))),
        }
    }

    fn column(&self, name: &str) -> Option<&Column> {
        match &self.source {
            Source::Recording(recording) if name == "t" => Some(recording.t_column()),
            Source::Recording(recording) => recording.column(Channel::parse(name)?),
            Source::LoadTable(_) => None,
        }
    }
}

#[pymethods]
impl Recording {
    #[staticmethod]
    fn from_file(
        py: Python<'_>,
        path: PathBuf,
        flags: PyFlags,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Recording> {
        let flags = Flags::from(flags);
        let mapping = flags.mapping().map_err(|error| of_recording(&error))?;
        let read = run(py, progress, move |told| {
            read_any(&path, &mapping, &mut |read| {
                let share = read.bytes_read as f64 / read.bytes_total.max(1) as f64;
                told.say("reading", share);
            })
        })?;
        let source = read.map_err(|error| of_recording(&error))?;
        Ok(Recording::new(source, Some(flags.typed())))
    }

    #[staticmethod]
    fn from_arrow(
        py: Python<'_>,
        table: &Bound<'_, PyAny>,
        name: &str,
        flags: PyFlags,
    ) -> PyResult<Recording> {
        let columns = lend::of_arrow(table)?;
        of_columns(py, name, columns, flags)
    }

    #[staticmethod]
    fn from_arrays(
        py: Python<'_>,
        arrays: Vec<(String, Option<Bound<'_, PyAny>>)>,
        name: &str,
        flags: PyFlags,
    ) -> PyResult<Recording> {
        let columns = lend::of_arrays(arrays)?;
        of_columns(py, name, columns, flags)
    }

    #[getter]
    fn name(&self) -> &str {
        match &self.source {
            Source::Recording(recording) => recording.name(),
            Source::LoadTable(table) => table.name(),
        }
    }

    #[getter]
    fn is_load_table(&self) -> bool {
        matches!(self.source, Source::LoadTable(_))
    }

    fn __len__(&self) -> usize {
        match &self.source {
            Source::Recording(recording) => recording.len(),
            Source::LoadTable(table) => table.len(),
        }
    }

    #[getter]
    fn duration_s(&self) -> PyResult<f64> {
        Ok(self.samples()?.duration())
    }

    #[getter]
    fn t_sample_s(&self) -> PyResult<f64> {
        Ok(self.samples()?.t_sample())
    }

    #[getter]
    fn assumptions(&self) -> Vec<String> {
        match &self.source {
            Source::Recording(recording) => recording.assumptions.clone(),
            Source::LoadTable(table) => table.assumptions.clone(),
        }
    }

    /// Names of the columns, the clock first.
    #[getter]
    fn columns(&self) -> Vec<String> {
        match &self.source {
            Source::Recording(recording) => {
                let channels = recording.channels().map(|(channel, _)| channel.to_string());
                std::iter::once("t".to_owned()).chain(channels).collect()
            }
            Source::LoadTable(table) => {
                let all = TableColumn::ALL.into_iter();
                let held = all.filter(|column| table.column(*column).is_some());
                held.map(|column| column.name().to_owned()).collect()
            }
        }
    }

    /// A column as a numpy array that cannot be written to; the recording keeps the numbers.
    #[allow(unsafe_code)]
    fn array<'py>(slf: Bound<'py, Self>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let this = slf.get();
        if let Source::LoadTable(table) = &this.source {
            let column = TableColumn::parse(name).and_then(|column| table.column(column));
            let values = column.ok_or_else(|| unknown(this, name))?;
            return Ok(PyArray1::from_slice(slf.py(), values));
        }
        let column = this.column(name).ok_or_else(|| unknown(this, name))?;
        let view = ArrayView1::from(&column[..]);
        // SAFETY: a recording is never changed, and the array keeps it alive.
        let array = unsafe { PyArray1::borrow_from_array(&view, slf.clone().into_any()) };
        let only_read = [("write", false)];
        let only_read = pyo3::types::IntoPyDict::into_py_dict(only_read, slf.py())?;
        array.call_method("setflags", (), Some(&only_read))?;
        Ok(array)
    }

    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // The interface lets an exporter answer in its own types.
        let _ = requested_schema;
        export::recording(py, &self.source)
    }

    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let recording = self.samples()?.clone();
        let written = run(py, None, move |_| {
            formats::write_recording(&path, &recording)
        })?;
        written.map_err(|error| of_recording(&error))
    }

    /// What the audit finds, as JSON; a motor file adds what is expected.
    fn audit(&self, py: Python<'_>, motor: Option<&crate::motor::Motor>) -> PyResult<String> {
        let recording = self.samples()?.clone();
        let expectation = motor.map_or_else(Expectation::default, |motor| {
            Expectation::from(&motor.known.motor)
        });
        let found = run(py, None, move |_| audit(&recording, &expectation))?;
        serde_json::to_string(&found).map_err(|error| usage(error.to_string()))
    }

    fn __repr__(&self) -> String {
        match &self.source {
            Source::Recording(recording) => format!(
                "<drivemon.Recording \"{}\": {} samples, {:.3} s, {}>",
                recording.name(),
                recording.len(),
                recording.duration(),
                self.columns().join(" ")
            ),
            Source::LoadTable(table) => format!(
                "<drivemon.Recording \"{}\": load table of {} points>",
                table.name(),
                table.len()
            ),
        }
    }
}

fn unknown(recording: &Recording, name: &str) -> PyErr {
    let columns = recording.columns().join(", ");
    pyo3::exceptions::PyKeyError::new_err(format!("no column {name}; there are {columns}"))
}

fn of_columns(
    py: Python<'_>,
    name: &str,
    columns: Vec<(String, lend::Taken)>,
    flags: PyFlags,
) -> PyResult<Recording> {
    let mapping = Flags::from(flags)
        .mapping()
        .map_err(|error| of_recording(&error))?;
    let table = lend::table(name, columns);
    let read = run(py, None, move |_| read_table(table, &mapping))?;
    let source = read.map_err(|error| of_recording(&error))?;
    Ok(Recording::new(source, None))
}
