//! Where one column of a group of rows stands: the library keeps much more of it, and eight hours have
//! thousands of them.

use parquet::basic::Compression;
use parquet::errors::Result;
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData};
use parquet::schema::types::ColumnDescPtr;

/// Place and compression of one column of a group of rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chunk {
    compression: Compression,
    compressed_bytes: i64,
    data: i64,
    dictionary: Option<i64>,
}

impl Chunk {
    fn of(column: &ColumnChunkMetaData) -> Chunk {
        Chunk {
            compression: column.compression(),
            compressed_bytes: column.compressed_size(),
            data: column.data_page_offset(),
            dictionary: column.dictionary_page_offset(),
        }
    }

    /// As the library reads pages by it.
    ///
    /// # Errors
    /// What the library refuses to build.
    pub fn metadata(&self, column: &ColumnDescPtr) -> Result<ColumnChunkMetaData> {
        ColumnChunkMetaData::builder(column.clone())
            .set_compression(self.compression)
            .set_total_compressed_size(self.compressed_bytes)
            .set_data_page_offset(self.data)
            .set_dictionary_page_offset(self.dictionary)
            .build()
    }
}

/// One column of all groups of rows, in their order.
pub(super) fn of_column(metadata: &ParquetMetaData, index: usize) -> Vec<Chunk> {
    let groups = metadata.row_groups().iter();
    groups.map(|group| Chunk::of(group.column(index))).collect()
}
