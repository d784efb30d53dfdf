//! A file that is read by pages: its end is an error, and so is a page that declares more than its file's rows can fill.
//!
//! The library skips what is not there as often as the file says so, and makes room for what a page declares before it looks.

use super::content::Content;
use crate::read::budget::most_numbers;
use bytes::Bytes;
use parquet::errors::Result;
use parquet::file::reader::{ChunkReader, Length};
use std::io::{BufRead, Error, ErrorKind, Read};

/// A Parquet file whose readers fail at its end instead of reading nothing, without end.
pub(super) struct PagedFile {
    content: Content,
    most_page_bytes: u64,
}

/// What reads the header of a page.
pub(super) struct PageHeader {
    input: <Content as ChunkReader>::T,
    most_page_bytes: u64,
    is_checked: bool,
}

/// Bytes that a page may take for each row: a number takes 8, its level and the worst encoding less than as much again each.
const MOST_ROW_BYTES: u64 = 32;

/// Bytes that a page of few rows may take: encodings fill up their last block.
const MOST_SMALL_PAGE_BYTES: u64 = 1 << 16;

impl PagedFile {
    /// `rows`: of the whole file; a page holds no more than what may be kept of a file.
    pub fn new(content: Content, rows: u64) -> PagedFile {
        let most_page_bytes = rows.min(most_numbers()).saturating_mul(MOST_ROW_BYTES);
        PagedFile {
            content,
            most_page_bytes: most_page_bytes.saturating_add(MOST_SMALL_PAGE_BYTES),
        }
    }
}

impl Length for PagedFile {
    fn len(&self) -> u64 {
        self.content.len()
    }
}

impl ChunkReader for PagedFile {
    type T = PageHeader;

    fn get_read(&self, start: u64) -> Result<PageHeader> {
        Ok(PageHeader {
            input: self.content.get_read(start)?,
            most_page_bytes: self.most_page_bytes,
            is_checked: false,
        })
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        self.content.get_bytes(start, length)
    }
}

impl Read for PageHeader {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if !self.is_checked {
            self.is_checked = true;
            check(self.input.fill_buf()?, self.most_page_bytes)?;
        }
        match self.input.read(buffer)? {
            0 if !buffer.is_empty() => Err(ErrorKind::UnexpectedEof.into()),
            read => Ok(read),
        }
    }
}

/// Refuses a page of more than `most` bytes; what is no header is left to the library.
fn check(header: &[u8], most: u64) -> std::io::Result<()> {
    match uncompressed_page_size(header) {
        Some(bytes) if bytes > most => {
            let message = format!("a page declares {bytes} bytes, its rows fill {most} at most");
            Err(Error::new(ErrorKind::InvalidData, message))
        }
        _ => Ok(()),
    }
}

/// The second of a header's fields (`PageHeader` in parquet.thrift), in Thrift's compact protocol.
fn uncompressed_page_size(header: &[u8]) -> Option<u64> {
    let kind_of_page = header.get(1..)?;
    let size = after_varint(kind_of_page)?.1.get(1..)?;
    Some(after_varint(size)?.0 >> 1)
}

/// A number of seven bits a byte, and what follows it.
fn after_varint(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let last = bytes.iter().take(10).position(|byte| byte & 0x80 == 0)?;
    let (number, rest) = bytes.split_at(last + 1);
    let digits = number.iter().rev();
    let number = digits.fold(0u64, |sum, byte| sum << 7 | u64::from(byte & 0x7F));
    Some((number, rest))
}

#[cfg(test)]
mod tests {
    use super::{check, uncompressed_page_size};

    /// A dictionary page of 300 bytes: fields 1 and 2, zigzag varints.
    const HEADER: [u8; 6] = [0x15, 0x04, 0x15, 0xD8, 0x04, 0x15];

    #[test]
    fn a_header_tells_the_size_of_its_page() {
        assert_eq!(uncompressed_page_size(&HEADER), Some(300));
        assert_eq!(uncompressed_page_size(&HEADER[..4]), None);
    }

    #[test]
    fn a_page_larger_than_its_rows_is_refused() {
        assert!(check(&HEADER, 300).is_ok());
        assert!(check(&HEADER, 299).is_err());
        assert!(check(&[], 0).is_ok());
    }
}
