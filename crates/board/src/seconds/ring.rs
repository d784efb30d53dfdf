//! The ring in memory.

use super::second::{SECOND_BYTES, Second};

/// Seconds that are kept: a master may be away for two minutes.
pub const SECONDS: u32 = 120;

/// Place in the ring of the second with this number, from 0.
pub fn place_of_second(number: u32) -> u32 {
    number.wrapping_sub(1) % SECONDS
}

/// The last [`SECONDS`] seconds, as bytes.
#[derive(Clone, Debug)]
pub struct SecondRing([[u8; SECOND_BYTES]; SECONDS as usize]);

impl Default for SecondRing {
    fn default() -> Self {
        Self::new()
    }
}

impl SecondRing {
    /// Nothing happened yet.
    pub const fn new() -> Self {
        SecondRing([Second::BLANK; SECONDS as usize])
    }

    /// Takes a second in the place of the one that was [`SECONDS`] before.
    pub fn push(&mut self, second: &Second) {
        let place = place_of_second(second.number) as usize;
        if let Some(bytes) = self.0.get_mut(place) {
            *bytes = second.to_bytes();
        }
    }

    /// Copies bytes from place `at` on; `false` beyond the ring.
    pub fn read(&self, at: usize, bytes: &mut [u8]) -> bool {
        let Some(source) = self.0.as_flattened().get(at..at + bytes.len()) else {
            return false;
        };
        bytes.copy_from_slice(source);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::second::tests::example;
    use super::*;

    fn read(ring: &SecondRing, number: u32) -> Option<Second> {
        let mut bytes = Second::BLANK;
        let at = place_of_second(number) as usize * SECOND_BYTES;
        assert!(ring.read(at, &mut bytes));
        Second::from_bytes(&bytes)
    }

    #[test]
    fn the_newest_two_minutes_are_kept() {
        let mut ring = SecondRing::new();
        assert_eq!(read(&ring, 1), None);
        (1..=SECONDS + 30).for_each(|number| ring.push(&example(number)));
        for number in 31..=SECONDS + 30 {
            assert_eq!(read(&ring, number), Some(example(number)));
        }
    }

    #[test]
    fn nothing_is_read_beyond_the_ring() {
        let ring = SecondRing::new();
        let end = SECONDS as usize * SECOND_BYTES;
        assert!(ring.read(end - 2, &mut [0; 2]));
        assert!(!ring.read(end - 1, &mut [0; 2]));
    }
}
