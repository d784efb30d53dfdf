//! Reading recordings and load tables from files.

mod aliases;
mod budget;
mod columns;
mod comtrade;
mod convert;
mod format;
mod header;
mod mat;
mod memory;
mod parquet;
mod plan;
mod preview;
mod raw;
mod table;
mod table_file;
mod text;
mod wav;
mod xlsx;

pub use budget::with_most_numbers;
use convert::finish;
use header::Header;
pub use memory::{MemoryTable, read_table};
use plan::Plan;
pub use preview::{Preview, preview};
use raw::{Raw, Rows};
use recording::{
    Column, Error, LoadTable, Mapping, Metadata, Recording, Sidecar, Source, Target, names,
};
use std::fs::File;
use std::io::Read;
use std::path::Path;
use table::Kind;
use table_file::{Row, TableFile};
pub use text::source::Progress;
pub use xlsx::workbook_text;

/// Reads a recording of any format, with the sidecar beside it; `flags` win over the sidecar.
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

/// Reads a load table of any format.
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
    let metadata = std::fs::metadata(path).map_err(|error| Error::io(path, &error))?;
    refuse_others(path, metadata.is_dir())?;
    if !metadata.is_file() {
        let stream = File::open(path).map_err(|error| Error::io(path, &error))?;
        return read_stream(&path.display().to_string(), stream, flags, progress);
    }
    let sidecar = match &flags.sidecar {
        Some(path) => Sidecar::read(path)?,
        None => Sidecar::beside(path)?,
    };
    read_as(sidecar, flags, progress, |mapping| {
        format::open(path, mapping)
    })
}

/// Reads whatever a stream holds: standard input, a pipe. Its content tells the format, compressed or not; it has a sidecar
/// where `flags` name one.
///
/// # Errors
/// Whatever is wrong with the content or the sidecar; `name` is what they call the stream.
pub fn read_stream(
    name: &str,
    stream: impl Read + 'static,
    flags: &Mapping,
    progress: &mut dyn FnMut(Progress),
) -> Result<Source, Error> {
    read_as(sidecar_named(flags)?, flags, progress, |mapping| {
        format::open_stream(name, stream, mapping)
    })
}

/// The sidecar that is named for what lies beside nothing.
fn sidecar_named(flags: &Mapping) -> Result<Sidecar, Error> {
    match &flags.sidecar {
        Some(path) => Sidecar::read(path),
        None => Ok(Sidecar::default()),
    }
}

/// What is no recording by its place or name, said before a sidecar is looked for beside it.
fn refuse_others(path: &Path, is_folder: bool) -> Result<(), Error> {
    let name = path.display().to_string();
    if is_folder {
        let remedy = "name a .csv, .csv.gz, .xlsx, .parquet, .mat, .wav, .cfg or .cff file in it";
        return Err(Error::bad(&name, "is a folder", remedy));
    }
    if names::extension(path) == "toml" {
        let message = "is a motor file, a scenario or a sidecar by its name, no recording";
        let remedy = "name the recording: .csv, .csv.gz, .xlsx, .parquet, .mat, .wav, .cfg or .cff";
        return Err(Error::bad(&name, message, remedy));
    }
    Ok(())
}

fn read_as(
    sidecar: Sidecar,
    flags: &Mapping,
    progress: &mut dyn FnMut(Progress),
    open: impl FnOnce(&Mapping) -> Result<Box<dyn TableFile>, Error>,
) -> Result<Source, Error> {
    let mapping = flags.clone().over(sidecar.mapping);
    let mut file = open(&mapping)?;
    match table::kind(file.header(), &mapping)? {
        Kind::LoadTable => table::load_table(&mut *file, progress).map(Source::LoadTable),
        Kind::Recording => {
            recording_of(&mut *file, sidecar.metadata, &mapping, progress).map(Source::Recording)
        }
    }
}

fn recording_of(
    file: &mut dyn TableFile,
    metadata: Metadata,
    mapping: &Mapping,
    progress: &mut dyn FnMut(Progress),
) -> Result<Recording, Error> {
    let mut plan = Plan::new(file.header(), mapping)?;
    let rate = file.header().rate.as_ref().filter(|_| !plan.has_clock());
    if let Some(rate) = rate {
        plan.mapping.sample_rate_hz = Some(rate.hz);
        plan.rate_is_declared = true;
        plan.notes.push(rate.note.clone());
    }
    plan_is_sufficient(file.header(), &plan)?;
    let raw = read_columns(file, &plan, progress)?;
    plan.notes.extend(file.notes());
    plan.reading.sample_rate_hz = plan.mapping.sample_rate_hz;
    plan.reading = plan.reading.over(file.layout());
    finish::recording(&file.header().file, raw, plan, metadata)
}

fn plan_is_sufficient(header: &Header, plan: &Plan) -> Result<(), Error> {
    let electrical = |target: &Target| matches!(target, Target::Channel(c) if c.is_electrical());
    if !plan.columns.keys().any(electrical) {
        let names = plan::list(&header.names);
        let message = format!("has neither currents nor voltages among {names}");
        let remedy = "name the columns ia ib ic, va vb vc, or map them: --column ia=NAME, or all in their order: --columns t,va,vb,-,ia";
        return Err(header.error("", message, remedy));
    }
    if !plan.has_clock() {
        let message = "the file has no clock";
        let remedy =
            "name the time column t, map it with --column t=NAME, or declare --sample-rate HZ";
        return Err(header.error("t", message, remedy));
    }
    Ok(())
}

fn read_columns(
    file: &mut dyn TableFile,
    plan: &Plan,
    progress: &mut dyn FnMut(Progress),
) -> Result<Raw, Error> {
    let mut collector = Collector::new(file.header(), plan);
    file.for_each_row(progress, &mut |row| collector.take(row))?;
    let Collector {
        used,
        values,
        lines,
        numbers,
        skipped,
        ..
    } = collector;
    let targets = used.into_iter().map(|column| column.target);
    Ok(Raw {
        columns: targets.zip(values.into_iter().map(Column::from)).collect(),
        rows: Rows::Kept { lines, numbers },
        skipped,
    })
}

struct UsedColumn {
    target: Target,
    index: usize,
    name: String,
}

/// Gathers the used columns row by row.
struct Collector {
    used: Vec<UsedColumn>,
    values: Vec<Vec<f64>>,
    row: Vec<f64>,
    lines: Vec<u64>,
    numbers: Vec<u64>,
    skipped: u64,
    skip_missing: bool,
}

impl Collector {
    fn new(header: &Header, plan: &Plan) -> Collector {
        let used = plan.columns.iter().map(|(target, index)| UsedColumn {
            target: *target,
            index: *index,
            name: header.names[*index].clone(),
        });
        let used: Vec<UsedColumn> = used.collect();
        Collector {
            values: vec![Vec::new(); used.len()],
            row: vec![0.0; used.len()],
            used,
            lines: Vec::new(),
            numbers: Vec::new(),
            skipped: 0,
            skip_missing: plan.mapping.skip_missing.unwrap_or(false),
        }
    }

    fn take(&mut self, cells: &dyn Row) -> Result<(), Error> {
        for (slot, column) in self.row.iter_mut().zip(&self.used) {
            match cells.number(column.index, &column.name)? {
                Some(x) if x.is_finite() => *slot = x,
                _ if self.skip_missing => {
                    self.skipped += 1;
                    return Ok(());
                }
                Some(x) => return Err(cells.not_finite(column.index, &column.name, x)),
                None => return Err(cells.missing(&column.name)),
            }
        }
        for (column, x) in self.values.iter_mut().zip(&self.row) {
            column.push(*x);
        }
        self.numbers.push(self.skipped + self.lines.len() as u64);
        self.lines.push(cells.line());
        Ok(())
    }
}
