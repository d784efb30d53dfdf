//! The one checksum of everything stored: CRC-32 as in Ethernet and zip.

use crc::{CRC_32_ISO_HDLC, Crc, Digest, Table};

/// With a table of 1 KiB: bit by bit, the frame of every window cost 17 instructions per sample.
static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// CRC-32 (ISO-HDLC) of the words' little-endian bytes.
pub fn crc32_words(words: &[u32]) -> u32 {
    let mut digest = CRC.digest();
    for word in words {
        digest.update(&word.to_le_bytes());
    }
    digest.finalize()
}

/// CRC-32 (ISO-HDLC) of bytes.
pub fn crc32(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// The same, of bytes that come one after the other.
pub struct Checksum(Digest<'static, u32, Table<1>>);

impl Checksum {
    /// Of nothing yet.
    pub fn new() -> Self {
        Checksum(CRC.digest())
    }

    /// Takes the next bytes.
    pub fn update(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// The checksum of all of them.
    pub fn finish(self) -> u32 {
        self.0.finalize()
    }
}

impl Default for Checksum {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_crc_that_zip_uses() {
        // 0x9AE0DAAF is what Python's zlib.crc32 gives for b"12345678".
        let words = [u32::from_le_bytes(*b"1234"), u32::from_le_bytes(*b"5678")];
        assert_eq!(crc32_words(&words), 0x9AE0_DAAF);
        let mut slowly = Checksum::new();
        b"12345678".chunks(3).for_each(|bytes| slowly.update(bytes));
        assert_eq!(slowly.finish(), 0x9AE0_DAAF);
    }
}
