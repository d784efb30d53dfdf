//! The pages of a column, none of which declares more numbers than it holds: the library makes room for them before it looks.

use super::paged_file::PagedFile;
use parquet::basic::Type;
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::serialized_reader::SerializedPageReader;
use std::sync::Arc;

/// Pages of one column of a row group.
pub(super) struct Pages {
    inner: SerializedPageReader<PagedFile>,
    rows: u64,
    number_bytes: u64,
}

impl Pages {
    /// # Errors
    /// A column without a place in the file.
    pub fn new(file: &Arc<PagedFile>, column: &ColumnChunkMetaData, rows: u64) -> Result<Pages> {
        let total = usize::try_from(rows).unwrap_or(usize::MAX);
        let number_bytes = match column.column_type() {
            Type::INT32 | Type::FLOAT => 4,
            _ => 8,
        };
        Ok(Pages {
            inner: SerializedPageReader::new(Arc::clone(file), column, total, None)?,
            rows,
            number_bytes,
        })
    }

    fn check(&self, page: &Page) -> Result<()> {
        let (declared, held) = match page {
            Page::DictionaryPage { buf, .. } => {
                (page.num_values(), buf.len() as u64 / self.number_bytes)
            }
            _ => (page.num_values(), self.rows),
        };
        if u64::from(declared) <= held {
            return Ok(());
        }
        Err(ParquetError::General(format!(
            "a page declares {declared} numbers and can hold {held}"
        )))
    }
}

impl PageReader for Pages {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        let page = self.inner.get_next_page()?;
        page.iter().try_for_each(|page| self.check(page))?;
        Ok(page)
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        self.inner.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<()> {
        self.inner.skip_next_page()
    }
}

impl Iterator for Pages {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Result<Page>> {
        self.get_next_page().transpose()
    }
}
