//! MAT-files of version 5 (`save -v6`, `save -v7`): variables become columns.
//!
//! Field list: MathWorks, "MAT-File Format" (R2020a), chapter 1.

mod array;
mod element;
mod signals;

use super::columns::Columns;
use super::header::Header;
use super::table_file::TableFile;
use element::{COMPRESSED, Elements, MATRIX, truncated};
use recording::Error;
use std::path::Path;

/// Bytes of the header: text, an offset of no interest here, version, byte order.
const HEADER: usize = 128;
const HDF5: &[u8] = b"\x89HDF\r\n\x1A\n";

/// Whether a file begins as MAT-files of version 5 or 7.3 do.
pub(super) fn is(head: &[u8]) -> bool {
    head.starts_with(b"MATLAB 5.0 MAT-file") || head.starts_with(b"MATLAB 7.3 MAT-file")
}

/// Reads the variables that are signals; the others are named in the notes.
pub(super) fn open(path: &Path) -> Result<Box<dyn TableFile>, Error> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|error| Error::io(path, &error))?;
    of_bytes(&name, bytes)
}

/// The same of a file that is in memory.
pub(super) fn of_bytes(name: &str, bytes: Vec<u8>) -> Result<Box<dyn TableFile>, Error> {
    if bytes.starts_with(b"MATLAB 7.3") || bytes.starts_with(HDF5) {
        let remedy = "save it again in MATLAB: save('x.mat', '-v7')";
        let message = "is a MAT-file of version 7.3 (HDF5), which is not read";
        return Err(Error::unsupported(name, message, remedy));
    }
    let arrays = arrays(name, &bytes)?;
    let signals = signals::of(name, arrays)?;
    let (names, values): (Vec<String>, Vec<Vec<f64>>) = signals.columns.into_iter().unzip();
    let mut header = Header::new(name.to_owned(), 0, names)?;
    header.unreadable = signals.unreadable;
    Ok(Box::new(Columns::new(header, values, bytes.len() as u64)?))
}

fn arrays(name: &str, bytes: &[u8]) -> Result<Vec<array::Array>, Error> {
    let order = bytes.get(HEADER - 2..HEADER).unwrap_or_default();
    let big_endian = match order {
        b"IM" => false,
        b"MI" => true,
        _ => {
            let message = "is no MAT-file of version 5: its header does not say the order of bytes";
            let remedy = "save it again in MATLAB: save('x.mat', '-v7')";
            return Err(Error::bad(name, message, remedy));
        }
    };
    let mut found = Vec::new();
    let mut budget = element::budget();
    let mut elements = Elements::new(&bytes[HEADER..], big_endian, HEADER);
    while let Some(element) = elements.next(name)? {
        match element.kind {
            MATRIX => found.push(array::read(name, &element.inside(big_endian), 0)?),
            COMPRESSED => {
                let inflated = element::inflate(name, &element, &mut budget)?;
                let mut inner = Elements::new(&inflated, big_endian, element.offset);
                let matrix = inner.next(name)?.filter(|inner| inner.kind == MATRIX);
                let matrix = matrix.ok_or_else(|| truncated(name, element.offset))?;
                found.push(array::read(name, &matrix.inside(big_endian), 0)?);
            }
            // A file consists of nothing else: to pass it over would lose a variable without a word.
            _ => return Err(truncated(name, element.offset)),
        }
    }
    Ok(found)
}
