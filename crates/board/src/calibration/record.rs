//! One calibration as bytes: postcard, filled up with zeros, CRC-32 behind.

use serde::{Deserialize, Serialize};

use super::Calibration;
use crate::checksum::crc32;

/// Bytes of a record; a whole number of the double words that flash is programmed in.
pub const RECORD_BYTES: usize = 160;
const CONTENT_BYTES: usize = RECORD_BYTES - 4;
/// What the fields mean; a different layout gets a different number.
const SCHEMA: u32 = 0x444D_4301;

/// A calibration with its place in time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Record {
    schema: u32,
    /// Grows with every record; the highest valid one holds.
    pub sequence: u32,
    pub calibration: Calibration,
}

/// What the bytes of one place say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Found {
    /// Erased and never programmed.
    Blank,
    /// Neither blank nor a whole record of this layout.
    Damaged,
    Record(Record),
}

impl Record {
    pub fn new(sequence: u32, calibration: Calibration) -> Self {
        Record {
            schema: SCHEMA,
            sequence,
            calibration,
        }
    }

    /// `None` is impossible by size; the longest record is tested to fit.
    #[inline(never)]
    pub fn to_bytes(self) -> Option<[u8; RECORD_BYTES]> {
        let mut bytes = [0; RECORD_BYTES];
        let (content, checksum) = bytes.split_at_mut(CONTENT_BYTES);
        postcard::to_slice(&self, content).ok()?;
        checksum.copy_from_slice(&crc32(content).to_le_bytes());
        Some(bytes)
    }
}

impl Found {
    #[inline(never)]
    pub fn read(bytes: &[u8; RECORD_BYTES]) -> Self {
        if bytes.iter().all(|byte| *byte == 0xFF) {
            return Found::Blank;
        }
        let (content, checksum) = bytes.split_at(CONTENT_BYTES);
        if crc32(content).to_le_bytes() != *checksum {
            return Found::Damaged;
        }
        match postcard::from_bytes::<Record>(content) {
            Ok(record) if record.schema == SCHEMA => Found::Record(record),
            _ => Found::Damaged,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::example;
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_longest_record_fits_and_comes_back() {
        let record = Record::new(u32::MAX, example(u32::MAX));
        let bytes = record.to_bytes().expect("a record that fits");
        assert_eq!(Found::read(&bytes), Found::Record(record));
    }

    #[test]
    fn erased_flash_is_blank_and_zeros_are_damage() {
        assert_eq!(Found::read(&[0xFF; RECORD_BYTES]), Found::Blank);
        assert_eq!(Found::read(&[0; RECORD_BYTES]), Found::Damaged);
    }

    #[test]
    fn another_layout_is_not_read() {
        let mut other = Record::new(1, example(2));
        other.schema += 1;
        let bytes = other.to_bytes().expect("a record that fits");
        assert_eq!(Found::read(&bytes), Found::Damaged);
    }

    proptest! {
        /// CRC-32 finds every single-bit error.
        #[test]
        fn any_flipped_bit_is_found(place in 0..RECORD_BYTES, bit in 0..8_u32) {
            let mut bytes = Record::new(7, example(3)).to_bytes().expect("a record that fits");
            bytes[place] ^= 1 << bit;
            prop_assert_eq!(Found::read(&bytes), Found::Damaged);
        }
    }
}
