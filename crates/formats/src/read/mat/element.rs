//! The elements that a MAT-file is made of: a tag, the bytes, padding.

use super::super::budget::{most_numbers, too_large};
use flate2::read::ZlibDecoder;
use recording::Error;
use std::io::Read;

/// An array.
pub(super) const MATRIX: u32 = 14;
/// An element that is compressed with zlib.
pub(super) const COMPRESSED: u32 = 15;

/// Bytes that all compressed elements of a file may unpack to.
pub(super) fn budget() -> u64 {
    most_numbers() * 8
}

/// One element.
pub(super) struct Element<'b> {
    /// Its type, as its tag says.
    pub kind: u32,
    /// Its content without padding.
    pub data: &'b [u8],
    /// Where its tag stands in the file; of a compressed element's content, where that element stands.
    pub offset: usize,
}

impl<'b> Element<'b> {
    /// The elements inside.
    pub fn inside(&self, big_endian: bool) -> Elements<'b> {
        Elements::new(self.data, big_endian, self.offset)
    }
}

/// The elements of some bytes, one after the other.
pub(super) struct Elements<'b> {
    data: &'b [u8],
    at: usize,
    base: usize,
    /// Whether the most significant byte comes first.
    pub big_endian: bool,
}

impl<'b> Elements<'b> {
    /// The elements of `data`, which stands at `base` of the file.
    pub fn new(data: &'b [u8], big_endian: bool, base: usize) -> Elements<'b> {
        Elements {
            data,
            at: 0,
            base,
            big_endian,
        }
    }

    /// The same elements from the first on.
    pub fn again(&self) -> Elements<'b> {
        Elements::new(self.data, self.big_endian, self.base)
    }

    /// The next element; `None` at the end.
    ///
    /// # Errors
    /// A tag or content that reaches beyond the end.
    pub fn next(&mut self, name: &str) -> Result<Option<Element<'b>>, Error> {
        let rest = &self.data[self.at.min(self.data.len())..];
        if rest.is_empty() {
            return Ok(None);
        }
        let offset = self.base + self.at;
        let cut = || truncated(name, offset);
        let first = self.word(rest, 0).ok_or_else(cut)?;
        // A small element holds its length in the upper half of the first word, and at most four bytes.
        let (kind, start, length): (u32, usize, usize) = match first >> 16 {
            0 => (first, 8, self.word(rest, 4).ok_or_else(cut)? as usize),
            small => (first & 0xFFFF, 4, small as usize),
        };
        let data = rest
            .get(start..start.saturating_add(length))
            .ok_or_else(cut)?;
        let padded = match (start, kind) {
            (4, _) => 8,
            (_, COMPRESSED) => start + length,
            _ => start + length.next_multiple_of(8),
        };
        self.at += padded;
        Ok(Some(Element { kind, data, offset }))
    }

    fn word(&self, bytes: &[u8], at: usize) -> Option<u32> {
        let bytes = bytes.get(at..at + 4)?.try_into().ok()?;
        Some(match self.big_endian {
            true => u32::from_be_bytes(bytes),
            false => u32::from_le_bytes(bytes),
        })
    }
}

/// The error for a file that ends inside an element.
pub(super) fn truncated(name: &str, offset: usize) -> Error {
    let message = format!("is truncated or damaged: the element at byte {offset} does not fit");
    Error::bad(name, message, "copy or save the file again")
}

/// The content of a compressed element.
///
/// # Errors
/// A damaged stream, or more than what is left of `budget`.
pub(super) fn inflate(
    name: &str,
    element: &Element<'_>,
    budget: &mut u64,
) -> Result<Vec<u8>, Error> {
    let mut inflated = Vec::new();
    let mut stream = ZlibDecoder::new(element.data).take(*budget + 1);
    stream.read_to_end(&mut inflated).map_err(|error| {
        let message = format!(
            "the compressed variable at byte {} is truncated or damaged ({error})",
            element.offset
        );
        Error::bad(name, message, "copy or save the file again")
    })?;
    *budget = budget
        .checked_sub(inflated.len() as u64)
        .ok_or_else(|| too_large(name))?;
    Ok(inflated)
}
