//! The bytes of a Parquet file, wherever they are.

use bytes::Bytes;
use parquet::errors::Result;
use parquet::file::reader::{ChunkReader, Length};
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};

/// A file on the disk, or one in memory.
pub(super) enum Content {
    /// On the disk.
    File(File),
    /// In memory.
    Memory(Bytes),
}

impl Length for Content {
    fn len(&self) -> u64 {
        match self {
            Content::File(file) => file.len(),
            Content::Memory(bytes) => bytes.len() as u64,
        }
    }
}

impl ChunkReader for Content {
    type T = BufReader<Box<dyn Read + Send>>;

    fn get_read(&self, start: u64) -> Result<Self::T> {
        let reader: Box<dyn Read + Send> = match self {
            Content::File(file) => {
                let mut file = file.try_clone()?;
                file.seek(SeekFrom::Start(start))?;
                Box::new(file)
            }
            Content::Memory(bytes) => Box::new(ChunkReader::get_read(bytes, start)?),
        };
        Ok(BufReader::new(reader))
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        match self {
            Content::File(file) => file.get_bytes(start, length),
            Content::Memory(bytes) => bytes.get_bytes(start, length),
        }
    }
}
