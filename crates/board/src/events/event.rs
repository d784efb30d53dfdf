//! One event as bytes of flash.

use super::cause::EventCause;
use crate::checksum::crc32_words;

/// Bytes of an event: four double words of flash.
pub const EVENT_BYTES: usize = 32;
const WORDS: usize = EVENT_BYTES / 4;
/// Layout of the words; a different one gets a different number.
const MAGIC: u32 = 0x444D_4501;

/// Something that happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// Counts from 1 over the board's life. A number is left out where power failed while it was written.
    pub number: u32,
    /// Since the program's start, s.
    pub uptime_s: u32,
    /// What happened.
    pub cause: EventCause,
    /// How often since this cause was written last; 1 or more.
    pub times: u16,
    /// What they say depends on the cause: [`EventCause::values`].
    pub values: [u32; 2],
}

impl Event {
    /// As it lies in flash: little-endian words, the last of them the CRC-32 of the others.
    pub fn to_bytes(&self) -> [u8; EVENT_BYTES] {
        let [first, second] = self.values;
        let kind = u32::from(self.times) << 16 | u32::from(self.cause as u16);
        let content = [MAGIC, self.number, self.uptime_s, kind, first, second, 0];
        let mut bytes = [0xFF; EVENT_BYTES];
        let words = content.into_iter().chain([crc32_words(&content)]);
        let (places, _) = bytes.as_chunks_mut::<4>();
        for (place, word) in places.iter_mut().zip(words) {
            *place = word.to_le_bytes();
        }
        bytes
    }

    /// From flash; `None` where there is no whole event.
    pub fn from_bytes(bytes: &[u8; EVENT_BYTES]) -> Option<Self> {
        let mut words = [0; WORDS];
        for (word, four) in words.iter_mut().zip(bytes.as_chunks::<4>().0) {
            *word = u32::from_le_bytes(*four);
        }
        let [content @ .., checksum] = &words;
        let [magic, number, uptime_s, kind, first, second, _] = *content;
        if magic != MAGIC || crc32_words(content) != *checksum {
            return None;
        }
        Some(Event {
            number,
            uptime_s,
            cause: EventCause::by_number(kind as u16)?,
            times: (kind >> 16) as u16,
            values: [first, second],
        })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    pub(in super::super) fn example(number: u32) -> Event {
        Event {
            number,
            uptime_s: 12_345,
            cause: EventCause::FaultOn,
            times: 3,
            values: [4, 930],
        }
    }

    #[test]
    fn an_event_comes_back_and_blank_flash_holds_none() {
        for cause in EventCause::ALL {
            let event = Event {
                cause,
                ..example(u32::MAX)
            };
            assert_eq!(Event::from_bytes(&event.to_bytes()), Some(event));
        }
        assert_eq!(Event::from_bytes(&[0xFF; EVENT_BYTES]), None);
        assert_eq!(Event::from_bytes(&[0; EVENT_BYTES]), None);
    }

    proptest! {
        /// CRC-32 finds every single-bit error.
        #[test]
        fn any_flipped_bit_is_found(place in 0..EVENT_BYTES, bit in 0..8_u32) {
            let mut bytes = example(7).to_bytes();
            bytes[place] ^= 1 << bit;
            prop_assert_eq!(Event::from_bytes(&bytes), None);
        }
    }
}
