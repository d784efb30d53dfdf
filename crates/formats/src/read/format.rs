//! The formats that are read; one entry registers one.

use super::budget::{most_numbers, too_large};
use super::table_file::TableFile;
use super::text::csv_file::CsvFile;
use super::{comtrade, mat, parquet, wav, xlsx};
use crate::read::text::source;
use recording::names::extension;
use recording::{Error, Mapping};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// A table, or why there is none.
type Opened = Result<Box<dyn TableFile>, Error>;

/// A format other than CSV.
struct Format {
    /// The words of a message: "is {name}".
    name: &'static str,
    /// How its file names end, in lower case.
    extensions: &'static [&'static str],
    /// Whether the first bytes of a file are this format's and no other's.
    is: fn(&[u8]) -> bool,
    /// Reads a file of this name.
    open: fn(&Path, &Mapping) -> Opened,
    /// Reads what was in a stream of this name.
    of_bytes: fn(&str, Vec<u8>, &Mapping) -> Opened,
}

/// Every format but CSV, which is what remains.
const FORMATS: [Format; 5] = [
    Format {
        name: "a Parquet file",
        extensions: &["parquet"],
        is: parquet::is,
        open: |path, _| parquet::open(path),
        of_bytes: |name, bytes, _| parquet::of_bytes(name, bytes),
    },
    Format {
        name: "a MAT-file",
        extensions: &["mat"],
        is: mat::is,
        open: |path, _| mat::open(path),
        of_bytes: |name, bytes, _| mat::of_bytes(name, bytes),
    },
    Format {
        name: "a COMTRADE recording",
        extensions: &["cff", "cfg", "dat"],
        is: comtrade::is,
        open: |path, _| comtrade::open(path),
        of_bytes: |name, bytes, _| comtrade::of_bytes(name, bytes),
    },
    Format {
        name: "an Excel workbook",
        extensions: &["xlsx", "xlsm"],
        is: xlsx::is,
        open: xlsx::open,
        of_bytes: xlsx::of_bytes,
    },
    Format {
        name: "a WAV file",
        extensions: &["wav"],
        is: wav::is,
        open: |path, _| wav::open(path),
        of_bytes: |name, bytes, _| wav::of_bytes(name, bytes),
    },
];

/// Bytes of a stream that are kept at once: [`most_numbers`] doubles.
fn most_bytes() -> u64 {
    8 * most_numbers()
}
/// Bytes that tell a format.
const HEAD: u64 = 512;

/// The format that a file's name means, and the one that its content is; neither for CSV.
struct Found {
    by_name: Option<&'static Format>,
    by_content: Option<&'static Format>,
    is_empty: bool,
}

fn find(path: &Path) -> Result<Found, Error> {
    let head = head(path)?;
    let extension = extension(path);
    // A table that is called .dat, and has no .cfg, is a table.
    let is_table = extension == "dat" && !comtrade::has_configuration(path);
    let named = |format: &&Format| !is_table && format.extensions.contains(&extension.as_str());
    Ok(Found {
        by_name: FORMATS.iter().find(named),
        by_content: FORMATS.iter().find(|format| (format.is)(&head)),
        is_empty: head.is_empty(),
    })
}

/// Whether a file is read as lines of text, compressed or not.
///
/// # Errors
/// A file that cannot be opened.
pub(super) fn is_text(path: &Path) -> Result<bool, Error> {
    let found = find(path)?;
    Ok(found.by_name.is_none() && found.by_content.is_none())
}

/// Opens a file of any format and reads its header.
///
/// # Errors
/// A file that is damaged, or of another format than its name says.
pub(super) fn open(path: &Path, mapping: &Mapping) -> Result<Box<dyn TableFile>, Error> {
    let found = find(path)?;
    match (found.by_name, found.by_content) {
        (Some(format), _) if found.is_empty => Err(empty(path, format)),
        (Some(format), Some(content)) if format.name != content.name => {
            Err(misnamed(path, content))
        }
        (None, Some(content)) => Err(misnamed(path, content)),
        (Some(format), _) => (format.open)(path, mapping),
        (None, None) => Ok(Box::new(CsvFile::open(path, mapping)?)),
    }
}

/// Opens a stream, of which nothing but the content tells the format, and reads its header.
///
/// # Errors
/// A stream that ends or is damaged, or holds more than any recording.
pub(super) fn open_stream(
    name: &str,
    mut stream: impl Read + 'static,
    mapping: &Mapping,
) -> Result<Box<dyn TableFile>, Error> {
    let broken = |error: std::io::Error| source::broken(name, 0, &error);
    let mut bytes = Vec::new();
    let mut head = stream.by_ref().take(HEAD);
    head.read_to_end(&mut bytes).map_err(broken)?;
    let Some(format) = FORMATS.iter().find(|format| (format.is)(&bytes)) else {
        let whole = std::io::Cursor::new(bytes).chain(stream);
        return Ok(Box::new(CsvFile::of_stream(name, whole, mapping)?));
    };
    let mut rest = stream.take(most_bytes());
    rest.read_to_end(&mut bytes).map_err(broken)?;
    match bytes.len() as u64 > most_bytes() {
        true => Err(too_large(name)),
        false => (format.of_bytes)(name, bytes, mapping),
    }
}

/// The first bytes; none of a folder or a pipe, whose bytes cannot be read twice.
fn head(path: &Path) -> Result<Vec<u8>, Error> {
    let mut head = Vec::new();
    if path.is_file() {
        let file = File::open(path).map_err(|error| Error::io(path, &error))?;
        let read = file.take(HEAD).read_to_end(&mut head);
        read.map_err(|error| Error::io(path, &error))?;
    }
    Ok(head)
}

fn empty(path: &Path, format: &Format) -> Error {
    let message = format!("is empty, not {}", format.name);
    let remedy = "record or export it again";
    Error::bad(&path.display().to_string(), message, remedy)
}

fn misnamed(path: &Path, content: &Format) -> Error {
    let extension = content.extensions[0];
    let message = format!(
        "is {}, but its name does not end in .{extension}",
        content.name
    );
    let remedy = format!("rename it to {}", path.with_extension(extension).display());
    Error::bad(&path.display().to_string(), message, remedy)
}
