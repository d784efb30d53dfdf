//! The register map: one table, from which addresses follow and against which docs/modbus.md is tested.

use super::entry::{FIELDS, Field};
use super::table::MAP;

/// Grows when an address changes its meaning.
pub const MAP_VERSION: u16 = 2;

const ADDRESSES: [u16; FIELDS] = addresses();
/// Registers of the map.
pub const WORDS: usize = {
    let last = FIELDS - 1;
    (ADDRESSES[last] + MAP[last].kind.words()) as usize
};

const fn addresses() -> [u16; FIELDS] {
    let mut addresses = [0; FIELDS];
    let mut k = 1;
    while k < FIELDS {
        addresses[k] = addresses[k - 1] + MAP[k - 1].kind.words();
        k += 1;
    }
    addresses
}

/// Address of a value's first register, counted from 0 as on the wire.
pub const fn address(field: Field) -> u16 {
    ADDRESSES[field as usize]
}

/// The input registers with their values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Image([u16; WORDS]);

impl Default for Image {
    fn default() -> Self {
        Image([0; WORDS])
    }
}

impl Image {
    /// The registers from `first` on; `None` beyond the map.
    pub fn range(&self, first: u16, count: u16) -> Option<&[u16]> {
        let first = usize::from(first);
        self.0.get(first..first + usize::from(count))
    }

    /// Sets a value of kind [`Kind::Word`](super::entry::Kind::Word).
    pub fn set_word(&mut self, field: Field, value: u16) {
        if let Some(word) = self.0.get_mut(usize::from(address(field))) {
            *word = value;
        }
    }

    /// Sets a value of kind [`Kind::Long`](super::entry::Kind::Long).
    pub fn set_long(&mut self, field: Field, value: u32) {
        let first = usize::from(address(field));
        if let Some([high, low]) = self.0.get_mut(first..first + 2) {
            *high = (value >> 16) as u16;
            *low = value as u16;
        }
    }

    /// A value of kind [`Kind::Word`](super::entry::Kind::Word).
    pub fn word(&self, field: Field) -> u16 {
        self.0
            .get(usize::from(address(field)))
            .copied()
            .unwrap_or(0)
    }

    /// A value of kind [`Kind::Float`](super::entry::Kind::Float).
    pub fn float(&self, field: Field) -> f32 {
        f32::from_bits(self.long(field))
    }

    /// A value of kind [`Kind::Long`](super::entry::Kind::Long).
    pub fn long(&self, field: Field) -> u32 {
        let first = usize::from(address(field));
        match self.0.get(first..first + 2) {
            Some([high, low]) => u32::from(*high) << 16 | u32::from(*low),
            _ => 0,
        }
    }

    /// Sets a value of kind [`Kind::Float`](super::entry::Kind::Float).
    pub fn set_float(&mut self, field: Field, value: f32) {
        self.set_long(field, value.to_bits());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_and_table_have_the_same_order_and_no_gap() {
        let mut next = 0;
        for (k, entry) in MAP.iter().enumerate() {
            assert_eq!(entry.field as usize, k, "{:?}", entry.field);
            assert_eq!(address(entry.field), next, "{:?}", entry.field);
            next += entry.kind.words();
        }
        assert_eq!(WORDS, usize::from(next));
    }

    #[test]
    fn one_request_reads_the_whole_map() {
        // The protocol's limit for registers in one answer.
        const { assert!(WORDS <= 125) };
        assert!(Image::default().range(0, WORDS as u16).is_some());
        assert!(Image::default().range(1, WORDS as u16).is_none());
        assert!(Image::default().range(u16::MAX, u16::MAX).is_none());
    }

    #[test]
    fn the_high_word_comes_first() {
        let mut image = Image::default();
        image.set_long(Field::Windows, 0x1234_5678);
        let first = address(Field::Windows);
        assert_eq!(image.range(first, 2), Some(&[0x1234, 0x5678][..]));
        assert_eq!(image.long(Field::Windows), 0x1234_5678);
    }

    #[test]
    fn a_number_of_a_list_has_its_words() {
        let told = |field: Field, number| MAP[field as usize].meaning.label(number);
        assert_eq!(told(Field::Verdict, 2), Some("FAULT lit"));
        assert_eq!(told(Field::NotJudged, 0), Some("judged"));
        assert_eq!(told(Field::LikelyFault, 1), Some("Rs"));
        assert_eq!(told(Field::Update, 4), Some("new program on trial"));
        assert_eq!(
            told(Field::UpdateRefused, 3),
            Some("older than the program that runs")
        );
        assert_eq!(told(Field::CrashCause, 2), Some("panic"));
        for (field, number) in [(Field::Update, 999), (Field::Stack, 1), (Field::Doubts, 1)] {
            assert_eq!(told(field, number), None, "{field:?}");
        }
    }
}
