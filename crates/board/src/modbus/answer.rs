//! The answer being written.

/// Longest frame of the protocol: address, 253 bytes, checksum.
pub const MAX_RESPONSE_BYTES: usize = 256;
const CHECKSUM_BYTES: usize = 2;

/// Bytes of an answer, and how many there are.
pub(super) struct Answer<'a> {
    bytes: &'a mut [u8; MAX_RESPONSE_BYTES],
    length: usize,
}

impl<'a> Answer<'a> {
    pub fn new(bytes: &'a mut [u8; MAX_RESPONSE_BYTES]) -> Self {
        Answer { bytes, length: 0 }
    }

    /// A byte too many is dropped; the longest answer is tested to fit.
    pub fn push(&mut self, byte: u8) {
        if let Some(place) = self.bytes.get_mut(self.length) {
            *place = byte;
            self.length += 1;
        }
    }

    pub fn push_all(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.push(*byte));
    }

    pub fn push_word(&mut self, word: u16) {
        self.push_all(&word.to_be_bytes());
    }

    /// Changes a byte that was pushed before.
    pub fn set(&mut self, at: usize, byte: u8) {
        if let Some(place) = self.bytes.get_mut(at) {
            *place = byte;
        }
    }

    pub fn clear(&mut self) {
        self.length = 0;
    }

    pub fn length(&self) -> usize {
        self.length
    }

    /// Bytes that may still be pushed before the checksum.
    pub fn room(&self) -> usize {
        (MAX_RESPONSE_BYTES - CHECKSUM_BYTES).saturating_sub(self.length)
    }

    pub fn written(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }
}
