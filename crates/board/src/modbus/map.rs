//! The register map: one table, from which addresses follow and against which docs/modbus.md is tested.

use core::fmt;

use monitor::{FaultId, Reason};

use super::table::{FIELDS, Field, MAP};

use crate::doubt::Doubt;
use crate::fault_record::FaultCause;

/// Grows when an address changes its meaning.
pub const MAP_VERSION: u16 = 2;

/// How a value lies in registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One register.
    Word,
    /// Two registers, high word first.
    Long,
    /// IEEE 754 single precision in two registers, high word first; NaN where there is no value.
    Float,
}

impl Kind {
    /// Registers that a value takes.
    pub const fn words(self) -> u16 {
        match self {
            Kind::Word => 1,
            Kind::Long | Kind::Float => 2,
        }
    }
}

/// One value of the map.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// What it is of.
    pub field: Field,
    /// How it is stored.
    pub kind: Kind,
    /// Unit, empty where there is none.
    pub unit: &'static str,
    /// What it says.
    pub meaning: Meaning,
}

/// What a value says.
#[derive(Clone, Copy, Debug)]
pub enum Meaning {
    /// In words.
    Words(&'static str),
    /// Number of a [`Reason`].
    Reasons,
    /// Number of a [`FaultId`].
    Faults,
    /// Bits of [`Doubts`](crate::Doubts).
    Doubts,
    /// Number of a [`FaultCause`].
    Crashes,
}

impl fmt::Display for Meaning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Meaning::Words(words) => f.write_str(words),
            Meaning::Reasons => {
                f.write_str("0 judged")?;
                let mut all = Reason::ALL.into_iter();
                all.try_for_each(|why| write!(f, ", {} {}", why.number(), why.label()))
            }
            Meaning::Faults => {
                f.write_str("likeliest cause while FAULT is lit: ")?;
                let named = FaultId::ALL.into_iter().filter(|fault| fault.number() > 0);
                for fault in named {
                    let before = if fault.number() > 1 { ", " } else { "" };
                    write!(f, "{before}{} {fault}", fault.number())?;
                }
                f.write_str(
                    "; 0 none of them; causes of the same pattern are tied, the first is named",
                )
            }
            Meaning::Doubts => {
                f.write_str("what the board doubts about itself, a bit each from the lowest: ")?;
                list(f, Doubt::ALL.map(|doubt| (doubt as usize, doubt.label())))
            }
            Meaning::Crashes => {
                f.write_str("what ended the program before its last start: 0 nothing, ")?;
                list(
                    f,
                    FaultCause::ALL.map(|cause| (cause as usize, cause.label())),
                )
            }
        }
    }
}

fn list<const N: usize>(
    f: &mut fmt::Formatter<'_>,
    numbered: [(usize, &'static str); N],
) -> fmt::Result {
    for (k, (number, label)) in numbered.into_iter().enumerate() {
        let before = if k > 0 { ", " } else { "" };
        write!(f, "{before}{number} {label}")?;
    }
    Ok(())
}

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

    /// Sets a value of kind [`Kind::Word`].
    pub fn set_word(&mut self, field: Field, value: u16) {
        if let Some(word) = self.0.get_mut(usize::from(address(field))) {
            *word = value;
        }
    }

    /// Sets a value of kind [`Kind::Long`].
    pub fn set_long(&mut self, field: Field, value: u32) {
        let first = usize::from(address(field));
        if let Some([high, low]) = self.0.get_mut(first..first + 2) {
            *high = (value >> 16) as u16;
            *low = value as u16;
        }
    }

    /// Sets a value of kind [`Kind::Float`].
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
    }
}
