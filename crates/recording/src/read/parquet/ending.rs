//! A file whose end is an error: the library skips what is not there, however often the file says so.

use bytes::Bytes;
use parquet::errors::Result;
use parquet::file::reader::{ChunkReader, Length};
use std::fs::File;
use std::io::{BufReader, ErrorKind, Read};

/// A Parquet file whose readers fail at its end instead of reading nothing, without end.
pub(super) struct EndingFile(pub File);

/// What reads on from a place of the file.
pub(super) struct Ending<R>(R);

impl Length for EndingFile {
    fn len(&self) -> u64 {
        self.0.len()
    }
}

impl ChunkReader for EndingFile {
    type T = Ending<BufReader<File>>;

    fn get_read(&self, start: u64) -> Result<Self::T> {
        self.0.get_read(start).map(Ending)
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        self.0.get_bytes(start, length)
    }
}

impl<R: Read> Read for Ending<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        match self.0.read(buffer)? {
            0 if !buffer.is_empty() => Err(ErrorKind::UnexpectedEof.into()),
            read => Ok(read),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Ending;
    use std::io::{Read, copy, sink};

    #[test]
    fn what_is_there_is_read_and_its_end_is_an_error() {
        let mut file = Ending(&[1u8, 2, 3][..]);
        let skipped = |file: &mut Ending<&[u8]>, n| copy(&mut file.take(n), &mut sink()).ok();
        assert_eq!(skipped(&mut file, 3), Some(3));
        assert_eq!(file.read(&mut []).ok(), Some(0));
        assert_eq!(skipped(&mut file, 8), None);
    }
}
