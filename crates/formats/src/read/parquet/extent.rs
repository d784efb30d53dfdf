//! Where the columns of a Parquet file stand: the library takes the numbers of the footer for granted.

use parquet::errors::ParquetError;
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData};

/// Refuses columns that reach beyond the file.
///
/// # Errors
/// A place or a length that is negative or beyond the end.
pub(super) fn check(metadata: &ParquetMetaData, bytes: u64) -> Result<(), ParquetError> {
    let groups = metadata.row_groups();
    let chunks = groups.iter().flat_map(|group| group.columns());
    match chunks.into_iter().find(|chunk| !is_inside(chunk, bytes)) {
        None => Ok(()),
        Some(chunk) => {
            let message = format!("column {} stands beyond the file", chunk.column_path());
            Err(ParquetError::General(message))
        }
    }
}

fn is_inside(chunk: &ColumnChunkMetaData, bytes: u64) -> bool {
    let start = chunk
        .dictionary_page_offset()
        .unwrap_or(chunk.data_page_offset());
    let (start, length) = (u64::try_from(start), u64::try_from(chunk.compressed_size()));
    match (start, length) {
        (Ok(start), Ok(length)) => start.checked_add(length).is_some_and(|end| end <= bytes),
        _ => false,
    }
}
