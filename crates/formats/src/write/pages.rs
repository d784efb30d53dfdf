//! Pages of a Parquet column with their checksums, which the library reads and does not write.
//!
//! Field list: `PageHeader` and `DataPageHeader` of parquet.thrift, in Thrift's compact protocol.

use flate2::Crc;
use parquet::basic::{Encoding, PageType};
use parquet::column::page::{CompressedPage, Page, PageWriteSpec, PageWriter};
use parquet::errors::{ParquetError, Result};

/// The pages of one column, one behind the other.
pub(super) struct Pages<'b> {
    bytes: &'b mut Vec<u8>,
}

impl Pages<'_> {
    /// Writes behind what `bytes` hold.
    pub fn new(bytes: &mut Vec<u8>) -> Pages<'_> {
        Pages { bytes }
    }
}

impl PageWriter for Pages<'_> {
    fn write_page(&mut self, page: CompressedPage) -> Result<PageWriteSpec> {
        let header = header(&page)?;
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(&header);
        self.bytes.extend_from_slice(page.data());
        Ok(PageWriteSpec {
            page_type: page.page_type(),
            uncompressed_size: page.uncompressed_size() + header.len(),
            compressed_size: page.compressed_size() + header.len(),
            num_values: page.num_values(),
            offset: offset as u64,
            bytes_written: (self.bytes.len() - offset) as u64,
        })
    }

    fn close(&mut self) -> Result<()> {
        Ok(())
    }
}

/// A page of plain numbers; the writer is told to make no others.
fn header(page: &CompressedPage) -> Result<Vec<u8>> {
    let Page::DataPage {
        num_values,
        encoding: Encoding::PLAIN,
        def_level_encoding,
        rep_level_encoding,
        ..
    } = page.compressed_page()
    else {
        let message = format!("a page of {:?} is not written", page.encoding());
        return Err(ParquetError::General(message));
    };
    let mut checksum = Crc::new();
    checksum.update(page.data());
    let mut header = Vec::new();
    number(&mut header, PageType::DATA_PAGE as i32);
    number(&mut header, size(page.uncompressed_size())?);
    number(&mut header, size(page.compressed_size())?);
    number(&mut header, checksum.sum().cast_signed());
    // The next field, a structure.
    header.push(0x1C);
    number(&mut header, size(*num_values as usize)?);
    number(&mut header, Encoding::PLAIN as i32);
    number(&mut header, *def_level_encoding as i32);
    number(&mut header, *rep_level_encoding as i32);
    // The ends of both structures.
    header.extend([0, 0]);
    Ok(header)
}

fn size(bytes: usize) -> Result<i32> {
    i32::try_from(bytes).map_err(|_| ParquetError::General("a page is too large".to_owned()))
}

/// The next field, an integer: zigzag, seven bits a byte.
fn number(header: &mut Vec<u8>, x: i32) {
    header.push(0x15);
    let mut rest = (x.cast_unsigned() << 1) ^ (x >> 31).cast_unsigned();
    while rest >= 0x80 {
        header.push(rest.to_le_bytes()[0] | 0x80);
        rest >>= 7;
    }
    header.push(rest.to_le_bytes()[0]);
}

#[cfg(test)]
mod tests {
    use super::number;

    /// The examples of the protocol's specification: zigzag of 0, -1, 1, and 300 in two bytes.
    #[test]
    fn numbers_are_written_as_thrift_does() {
        for (x, bytes) in [
            (0, &[0x15, 0][..]),
            (-1, &[0x15, 1]),
            (1, &[0x15, 2]),
            (150, &[0x15, 0xAC, 0x02]),
            (i32::MIN, &[0x15, 0xFF, 0xFF, 0xFF, 0xFF, 0x0F]),
        ] {
            let mut header = Vec::new();
            number(&mut header, x);
            assert_eq!(header, bytes);
        }
    }
}
