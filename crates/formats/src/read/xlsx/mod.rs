//! Excel workbooks (.xlsx, .xlsm): the first sheet with cells, read as the text that it shows.

mod parts;
mod sheet;

use super::table_file::TableFile;
use super::text::csv_file::CsvFile;
use crate::contained::contained;
use calamine::{Reader, Xlsx, XlsxError};
use recording::{Error, Mapping};
use std::io::{Cursor, Read};
use std::path::Path;

/// Names of the parts with which the archive of a workbook begins.
const FIRST_PARTS: [&[u8]; 4] = [b"[Content_Types].xml", b"_rels/", b"xl/", b"docProps/"];

/// What of a file tells its format, bytes.
const HEAD: u64 = 64;

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

/// The first sheet with cells as lines of text with tabs, a line for each row; `None` of a file that is no workbook by name and
/// content.
///
/// # Errors
/// A file that cannot be read, or a damaged workbook, with the remedy.
pub fn workbook_text(path: &Path) -> Result<Option<String>, Error> {
    let name = path.display().to_string();
    let failed = |error: std::io::Error| Error::io(path, &error);
    let mut head = Vec::new();
    let file = std::fs::File::open(path).map_err(failed)?;
    file.take(HEAD).read_to_end(&mut head).map_err(failed)?;
    let extension = recording::names::extension(path);
    if !is(&head) && extension != "xlsx" && extension != "xlsm" {
        return Ok(None);
    }
    let bytes = std::fs::read(path).map_err(failed)?;
    parts::check(&name, &bytes)?;
    let text = contained(|| text(&name, bytes))
        .unwrap_or_else(|| Err(damaged(&name, "its cells cannot be read")))?;
    Ok(Some(String::from_utf8_lossy(&text.lines).into_owned()))
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
