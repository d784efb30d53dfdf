//! Excel workbooks (.xlsx, .xlsm): the first sheet with cells, read as the text that it shows.

mod parts;
mod sheet;

use super::table_file::TableFile;
use super::text::csv_file::CsvFile;
use crate::contained::contained;
use crate::error::Error;
use crate::mapping::Mapping;
use calamine::{Reader, Xlsx, XlsxError};
use std::io::Cursor;
use std::path::Path;

/// Names of the parts with which the archive of a workbook begins.
const FIRST_PARTS: [&[u8]; 4] = [b"[Content_Types].xml", b"_rels/", b"xl/", b"docProps/"];

/// Whether a file begins as workbooks do: zip archives of such parts.
pub(super) fn is(head: &[u8]) -> bool {
    // A local header of 30 bytes stands before the name of the first part.
    let first = head.get(30..).unwrap_or_default();
    head.starts_with(b"PK\x03\x04") && FIRST_PARTS.iter().any(|part| first.starts_with(part))
}

/// Reads the workbook of a file.
pub(super) fn open(path: &Path, mapping: &Mapping) -> Result<Box<dyn TableFile>, Error> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|error| Error::io(path, &error))?;
    of_bytes(&name, bytes, mapping)
}

/// The same of a workbook that is in memory.
pub(super) fn of_bytes(
    name: &str,
    bytes: Vec<u8>,
    mapping: &Mapping,
) -> Result<Box<dyn TableFile>, Error> {
    parts::check(name, &bytes)?;
    let text = contained(|| text(name, bytes))
        .unwrap_or_else(|| Err(damaged(name, "its cells cannot be read")))?;
    let mapping = Mapping {
        delimiter: Some(sheet::SEPARATOR),
        ..mapping.clone()
    };
    let file = CsvFile::of_stream(name, Cursor::new(text.lines), &mapping)?;
    Ok(Box::new(file.with_notes(text.notes)))
}

/// A sheet as lines, and what was left aside.
struct Text {
    lines: Vec<u8>,
    notes: Vec<String>,
}

fn text(name: &str, bytes: Vec<u8>) -> Result<Text, Error> {
    let wrong = |error: XlsxError| damaged(name, &error.to_string());
    let mut book: Xlsx<_> = Xlsx::new(Cursor::new(bytes)).map_err(wrong)?;
    let sheets = book.sheet_names();
    for sheet in &sheets {
        let lines = sheet::lines(name, &mut book, sheet)?;
        if lines.is_empty() {
            continue;
        }
        let others = sheets.iter().filter(|other| *other != sheet).count();
        let note = (others > 0).then(|| format!("sheet {sheet} is read, {others} others are not"));
        return Ok(Text {
            lines,
            notes: note.into_iter().collect(),
        });
    }
    let remedy = "put the samples into a sheet, with the names of the columns above them";
    Err(Error::bad(name, "has no sheet with cells", remedy))
}

fn damaged(name: &str, why: &str) -> Error {
    let remedy = "open it in a spreadsheet program and save it again as .xlsx or .csv";
    Error::bad(name, format!("is no sound workbook ({why})"), remedy)
}
