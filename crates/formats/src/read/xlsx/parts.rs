//! The parts of a workbook, looked at before they are read into memory: a small archive may unpack to gigabytes.

use super::damaged;
use crate::read::budget::{most_numbers, too_large};
use recording::Error;
use std::io::{Cursor, Read};
use zip::ZipArchive;

/// Bytes of texts, styles and whatever else is no sheet: they are kept in memory.
const MOST_BESIDE: u64 = 64 << 20;
/// Bytes of a sheet: about 20 million cells.
const MOST_OF_A_SHEET: u64 = 1 << 30;
/// Bytes of a sheet for each number that a file may hold.
const BYTES_A_CELL: u64 = 64;
/// Bytes between two marks of a sheet's XML: one cell's text.
const LONGEST_TEXT: u64 = 1 << 20;

/// Refuses archives that are no workbook, and parts that unpack to more than a recording needs.
pub(super) fn check(name: &str, bytes: &[u8]) -> Result<(), Error> {
    let wrong = |error: zip::result::ZipError| damaged(name, &error.to_string());
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(wrong)?;
    if archive.index_for_name("xl/workbook.xml").is_none() {
        let remedy = "unpack it and name the recording in it; of an .ods file save a .xlsx or .csv";
        return Err(Error::unsupported(
            name,
            "is a zip archive, but no Excel workbook",
            remedy,
        ));
    }
    let mut beside = MOST_BESIDE;
    for k in 0..archive.len() {
        let part = archive.by_index(k).map_err(wrong)?;
        let is_sheet = part.name().map_err(wrong)?.starts_with("xl/worksheets/");
        let limit = match is_sheet {
            true => MOST_OF_A_SHEET.min(BYTES_A_CELL.saturating_mul(most_numbers())),
            false => beside,
        };
        let size = size(name, part, limit)?;
        if !is_sheet {
            beside -= size;
        }
    }
    Ok(())
}

/// Bytes of a part as it unpacks, whatever the archive says of it.
fn size(name: &str, part: impl Read, limit: u64) -> Result<u64, Error> {
    let mut part = part.take(limit.saturating_add(1));
    let mut buffer = vec![0; 1 << 16];
    let (mut size, mut text) = (0, 0);
    loop {
        let n = part
            .read(&mut buffer)
            .map_err(|error| damaged(name, &error.to_string()))?;
        if n == 0 {
            return Ok(size);
        }
        size += n as u64;
        for piece in buffer[..n].split_inclusive(|byte| *byte == b'<') {
            text += piece.len() as u64;
            if text > LONGEST_TEXT {
                return Err(damaged(name, "a text in it is longer than 1 MiB"));
            }
            if piece.ends_with(b"<") {
                text = 0;
            }
        }
        if size > limit {
            return Err(unpacks(name, limit));
        }
    }
}

fn unpacks(name: &str, limit: u64) -> Error {
    let few_numbers = BYTES_A_CELL.saturating_mul(most_numbers());
    if limit == few_numbers {
        return too_large(name);
    }
    let message = format!("unpacks to more than {} MiB", limit.div_ceil(1 << 20));
    let remedy = "cut the recording, or save it as .csv or .parquet";
    Error::unsupported(name, message, remedy)
}
