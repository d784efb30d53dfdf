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
mod opened;
mod parquet;
mod plan;
mod preview;
mod samples;
mod table;
mod table_file;
mod text;
mod wav;
mod xlsx;

pub use budget::with_most_numbers;
pub use memory::{MemoryTable, read_table};
use opened::Opened;
pub use preview::{Preview, preview};
use recording::{Error, Follows, LoadTable, Mapping, Recording, Sidecar, Source, names};
use std::fs::File;
use std::io::Read;
use std::path::Path;
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
    open(path, flags)?.whole(progress)
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
    open_stream(name, stream, flags)?.whole(progress)
}

/// Rows of a piece: 50 s at 10 kHz. With ten columns they take 40 MB.
pub const PIECE_ROWS: usize = 500_000;

/// Reads a recording of any length as consecutive pieces of `rows` rows, of which one is in memory at a time: text and
/// Parquet; other formats are read as a whole first. `take` gets each piece when the one before is done, and what follows it; the last one is up to
/// a thirtieth longer, so that what is little longer than a piece is one. The last piece comes back, with the assumptions of the
/// file; so does a load table, which has no pieces.
///
/// Encoder counts, delays and spikes at the ends of a piece are treated with the rows beside it, as they are in its middle.
///
/// # Errors
/// Whatever is wrong with the file or its sidecar, with file, line, column and remedy, and what `take` returns.
pub fn read_in_pieces<E: From<Error>>(
    path: &Path,
    flags: &Mapping,
    rows: usize,
    progress: &mut dyn FnMut(Progress),
    take: &mut dyn FnMut(&Recording, Follows) -> Result<(), E>,
) -> Result<Source, E> {
    open(path, flags)?.in_pieces(rows, progress, take)
}

/// The same of a stream; `name` is what errors call it.
///
/// # Errors
/// As [`read_in_pieces`].
pub fn read_stream_in_pieces<E: From<Error>>(
    name: &str,
    stream: impl Read + 'static,
    flags: &Mapping,
    rows: usize,
    progress: &mut dyn FnMut(Progress),
    take: &mut dyn FnMut(&Recording, Follows) -> Result<(), E>,
) -> Result<Source, E> {
    open_stream(name, stream, flags)?.in_pieces(rows, progress, take)
}

fn open(path: &Path, flags: &Mapping) -> Result<Opened, Error> {
    // A file that cannot be opened is the first thing to say, before anything about its sidecar.
    let metadata = std::fs::metadata(path).map_err(|error| Error::io(path, &error))?;
    refuse_others(path, metadata.is_dir())?;
    if !metadata.is_file() {
        let stream = File::open(path).map_err(|error| Error::io(path, &error))?;
        return open_stream(&path.display().to_string(), stream, flags);
    }
    let sidecar = match &flags.sidecar {
        Some(path) => Sidecar::read(path)?,
        None => Sidecar::beside(path)?,
    };
    Opened::new(sidecar, flags, |mapping| format::open(path, mapping))
}

fn open_stream(name: &str, stream: impl Read + 'static, flags: &Mapping) -> Result<Opened, Error> {
    Opened::new(sidecar_named(flags)?, flags, |mapping| {
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
