//! Parts of a batch, for an engine that spreads them over machines.

use crate::errors::{of_file, of_recording, usage};
use crate::source::PyFlags;
use crate::work;
use pyo3::prelude::*;
use report::study::MapError;
use report::study::batch::{BatchError, FAULT, NOT_JUDGED, NOT_READ, StoreError};
use std::path::PathBuf;
use std::sync::Arc;

/// A folder of recordings with their motors.
#[pyclass(frozen, module = "drivemon._drivemon")]
pub struct Batch {
    batch: Arc<report::study::batch::Batch>,
}

#[pymethods]
impl Batch {
    /// Reads a map with its motor files, and lists the recordings.
    #[new]
    fn read(
        folder: PathBuf,
        motor_map: PathBuf,
        output: PathBuf,
        flags: PyFlags,
    ) -> PyResult<Batch> {
        let read = report::study::batch::Batch::read(&folder, &motor_map, &output, &flags.into());
        Ok(Batch {
            batch: Arc::new(read.map_err(|error| refused(&error))?),
        })
    }

    /// Hash of the list, of motor files, flags and version, as parts are named by it.
    #[getter]
    fn fingerprint(&self) -> String {
        self.batch.fingerprint()
    }

    /// Ranges of recordings that neither the table nor a part holds a row of.
    fn open(&self, py: Python<'_>) -> PyResult<Vec<(usize, usize)>> {
        let batch = Arc::clone(&self.batch);
        let open = work::run(py, None, move |_| batch.open(&batch.store()?.with_parts()?))?;
        let open = open.map_err(stored)?.into_iter();
        Ok(open.map(|range| (range.start, range.end)).collect())
    }

    /// Judges recordings `begin..end` on this core and writes their rows to `output`, whole or not at all.
    #[pyo3(signature = (begin, end, output, progress=None))]
    fn share(
        &self,
        py: Python<'_>,
        begin: usize,
        end: usize,
        output: PathBuf,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let recordings = self.batch.jobs.len();
        if begin > end || end > recordings {
            return Err(usage(format!(
                "recordings {begin}..{end}: the list has 0..{recordings}"
            )));
        }
        let batch = Arc::clone(&self.batch);
        let written = work::run(py, progress, move |told| {
            let (mut made, all) = (0.0, (end - begin) as f64);
            batch.share(begin..end, &output, &mut || {
                made += 1.0;
                told.say("judging", made / all);
            })
        })?;
        written.map_err(stored)
    }

    /// Writes the table out of all parts; what they do not hold is judged here. Recordings, those with FAULT, those that were not
    /// judged, those that were not read.
    fn finish(&self, py: Python<'_>) -> PyResult<(usize, usize, usize, usize)> {
        let batch = Arc::clone(&self.batch);
        let rows = work::run(py, None, move |_| {
            batch.finish(&batch.store()?.with_parts()?, &|_| ())
        })?;
        let rows = rows.map_err(stored)?;
        let count = |state: &str| rows.iter().filter(|row| row.state == state).count();
        Ok((rows.len(), count(FAULT), count(NOT_JUDGED), count(NOT_READ)))
    }
}

fn refused(error: &BatchError) -> PyErr {
    match error {
        BatchError::Flags(error) => of_recording(error),
        BatchError::Map(MapError::File(error)) => of_file(error),
        BatchError::Map(error @ MapError::Entry(_)) => usage(error.to_string()),
        BatchError::Store(error) => usage(error.to_string()),
    }
}

fn stored(error: StoreError) -> PyErr {
    usage(error.to_string())
}
