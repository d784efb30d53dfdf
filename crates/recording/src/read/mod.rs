//! Reading recordings and load tables from files.

mod clock;
mod csv_file;
mod encoder;
mod finish;
mod plan;
mod table;

use crate::error::Error;
use crate::load_table::LoadTable;
use crate::mapping::{Mapping, Target};
use crate::metadata::Metadata;
use crate::recording::Recording;
use crate::sidecar::Sidecar;
use crate::source::Progress;
use csv_file::CsvFile;
use plan::Plan;
use std::collections::BTreeMap;
use std::path::Path;
use table::Kind;

/// What a file turned out to hold.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// Samples over time.
    Recording(Recording),
    /// Operating points.
    LoadTable(LoadTable),
}

/// Reads a recording, `.csv` or `.csv.gz`, with the sidecar beside it; `flags` win over the sidecar.
///
/// # Errors
/// Whatever is wrong with the file or its sidecar, with file, line, column and remedy; also a load
/// table.
pub fn read_recording(
    path: &Path,
    flags: &Mapping,
    progress: &mut dyn FnMut(Progress),
) -> Result<Recording, Error> {
    match read_any(path, flags, progress)? {
        Source::Recording(recording) => Ok(recording),
        Source::LoadTable(table) => {
            let remedy = "name a recording: columns t, va vb vc, ia ib ic, speed";
            let message = "is a load table, not a recording in time";
            Err(Error::unsupported(table.name(), message, remedy))
        }
    }
}

/// Reads a load table, `.csv` or `.csv.gz`.
///
/// # Errors
/// Whatever is wrong with the file, with file, line, column and remedy; also a recording.
pub fn read_load_table(
    path: &Path,
    flags: &Mapping,
    progress: &mut dyn FnMut(Progress),
) -> Result<LoadTable, Error> {
    match read_any(path, flags, progress)? {
        Source::LoadTable(table) => Ok(table),
        Source::Recording(recording) => {
            let remedy = "name a table with power_watt, current_rms_amp, speed_rpm and the like";
            let message = "is a recording in time, not a load table";
            Err(Error::unsupported(recording.name(), message, remedy))
        }
    }
}

/// Reads whatever the file holds, told by the names of its columns.
///
/// # Errors
/// Whatever is wrong with the file or its sidecar, with file, line, column and remedy.
pub fn read_any(
    path: &Path,
    flags: &Mapping,
    progress: &mut dyn FnMut(Progress),
) -> Result<Source, Error> {
    // A file that cannot be opened is the first thing to say, before anything about its sidecar.
    std::fs::metadata(path).map_err(|error| Error::io(path, &error))?;
    let sidecar = match &flags.sidecar {
        Some(path) => Sidecar::read(path)?,
        None => Sidecar::beside(path)?,
    };
    let mapping = flags.clone().over(sidecar.mapping);
    let csv = CsvFile::open(path, &mapping)?;
    match table::kind(&csv, &mapping)? {
        Kind::LoadTable => table::load_table(csv, progress).map(Source::LoadTable),
        Kind::Recording => {
            recording_of(csv, sidecar.metadata, &mapping, progress).map(Source::Recording)
        }
    }
}

fn recording_of(
    mut csv: CsvFile,
    metadata: Metadata,
    mapping: &Mapping,
    progress: &mut dyn FnMut(Progress),
) -> Result<Recording, Error> {
    let plan = Plan::new(&csv.name, csv.header_line, &csv.header, mapping)?;
    plan_is_sufficient(&csv, &plan, mapping)?;
    let raw = read_columns(&mut csv, &plan, mapping, progress)?;
    finish::recording(&csv.name, raw, plan, mapping, metadata)
}

fn plan_is_sufficient(csv: &CsvFile, plan: &Plan, mapping: &Mapping) -> Result<(), Error> {
    let electrical = |target: &Target| matches!(target, Target::Channel(c) if c.is_electrical());
    if !plan.columns.keys().any(electrical) {
        let message = format!(
            "has neither currents nor voltages among {}",
            plan::list(&csv.header)
        );
        let remedy = "name the columns ia ib ic, va vb vc, or map them: --column ia=NAME";
        return Err(Error::at(&csv.name, csv.header_line, "", message, remedy));
    }
    if !plan.columns.contains_key(&Target::Time) && mapping.sample_rate_hz.is_none() {
        let message = "the file has no clock";
        let remedy =
            "name the time column t, map it with --column t=NAME, or declare --sample-rate HZ";
        return Err(Error::at(&csv.name, csv.header_line, "t", message, remedy));
    }
    Ok(())
}

/// The samples of a file as they stand there, with their lines.
pub(crate) struct Raw {
    pub columns: BTreeMap<Target, Vec<f64>>,
    pub lines: Vec<u64>,
    /// Running number of each kept row; skips where rows were dropped.
    pub numbers: Vec<u64>,
    pub skipped: u64,
}

fn read_columns(
    csv: &mut CsvFile,
    plan: &Plan,
    mapping: &Mapping,
    progress: &mut dyn FnMut(Progress),
) -> Result<Raw, Error> {
    let used: Vec<(Target, usize)> = plan.columns.iter().map(|(t, c)| (*t, *c)).collect();
    let names: Vec<String> = used
        .iter()
        .map(|(_, column)| csv.header[*column].clone())
        .collect();
    let skip = mapping.skip_missing.unwrap_or(false);
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); used.len()];
    let (mut lines, mut numbers, mut skipped) = (Vec::new(), Vec::new(), 0);
    let mut row = vec![0.0; used.len()];
    csv.for_each_row(progress, |cells| {
        for (k, (_, column)) in used.iter().enumerate() {
            match cells.number(*column, &names[k])? {
                Some(x) => row[k] = x,
                None if skip => {
                    skipped += 1;
                    return Ok(());
                }
                None => return Err(cells.missing(&names[k])),
            }
        }
        for (column, x) in values.iter_mut().zip(&row) {
            column.push(*x);
        }
        numbers.push(skipped + lines.len() as u64);
        lines.push(cells.line);
        Ok(())
    })?;
    let columns = used
        .into_iter()
        .map(|(target, _)| target)
        .zip(values)
        .collect();
    Ok(Raw {
        columns,
        lines,
        numbers,
        skipped,
    })
}
