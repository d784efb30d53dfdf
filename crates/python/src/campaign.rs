//! Shares of a campaign, for an engine that spreads them over machines.

use crate::errors::{of_file, usage};
use crate::work;
use ::campaign::{About, Results, StoreError, finished, share};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// A plan of a campaign.
#[pyclass(frozen, module = "drivemon._drivemon")]
#[derive(Debug)]
pub struct Plan {
    plan: Arc<::campaign::Plan>,
}

#[pymethods]
impl Plan {
    /// Reads a plan and the motor files that it names.
    #[new]
    fn read(path: PathBuf) -> PyResult<Plan> {
        let plan = ::campaign::Plan::read(&path).map_err(|error| of_file(&error))?;
        Ok(Plan {
            plan: Arc::new(plan),
        })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.plan.name
    }

    #[getter]
    fn runs(&self) -> u64 {
        self.plan.runs()
    }

    /// Hash of plan, motor files and version, as results carry it.
    #[getter]
    fn fingerprint(&self) -> String {
        About::of(&self.plan).fingerprint
    }

    /// What `output` holds, where these runs are all in it: their number, and in how many FAULT was lit on a healthy motor; nothing
    /// where there is no such file. Any other content is refused.
    fn finished(
        &self,
        py: Python<'_>,
        begin: u64,
        end: u64,
        output: PathBuf,
    ) -> PyResult<Option<(usize, usize)>> {
        let plan = Arc::clone(&self.plan);
        let found = work::run(py, None, move |_| finished(&plan, &(begin..end), &output))?;
        Ok(found.map_err(stored)?.as_ref().map(counted))
    }

    /// Makes runs `begin..end` on this core and writes them to `output`, whole or not at all.
    #[pyo3(signature = (begin, end, output, progress=None))]
    fn share(
        &self,
        py: Python<'_>,
        begin: u64,
        end: u64,
        output: PathBuf,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let plan = Arc::clone(&self.plan);
        let written = work::run(py, progress, move |told| {
            let (mut made, all) = (0.0, (end - begin) as f64);
            let results = share(&plan, begin..end, &mut || {
                made += 1.0;
                told.say("making runs", made / all);
            });
            results.write(&output)
        })?;
        written.map_err(stored)
    }
}

/// Puts the results in `parts` together and writes them to `output`: the rows' number, and in how many runs FAULT was lit on a
/// healthy motor.
#[pyfunction]
pub fn merge(py: Python<'_>, parts: Vec<PathBuf>, output: PathBuf) -> PyResult<(usize, usize)> {
    let merged = work::run(py, None, move |_| {
        let read = |path: PathBuf| Ok((path.clone(), Results::read(&path)?));
        let parts = parts
            .into_iter()
            .map(read)
            .collect::<Result<_, StoreError>>()?;
        let results = Results::merge(parts)?;
        results.write(&output)?;
        Ok(results)
    })?;
    Ok(counted(&merged.map_err(stored)?))
}

fn counted(results: &Results) -> (usize, usize) {
    let lit = results
        .rows
        .iter()
        .filter(|row| row.healthy_fault_windows > 0);
    (results.rows.len(), lit.count())
}

fn stored(error: StoreError) -> PyErr {
    usage(error.to_string())
}
