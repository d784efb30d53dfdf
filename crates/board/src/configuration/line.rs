//! How the Modbus line is set.

use super::Refused;

/// Address, speed and parity of the Modbus line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// The board's address, 1 to 247.
    pub unit: u8,
    /// Bit/s, 1200 to 115 200.
    pub baud: u32,
    /// Parity bit; without one there are two stop bits, as the protocol wants it.
    pub parity: LineParity,
}

/// Parity of the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum LineParity {
    /// None, two stop bits.
    None = 0,
    /// Odd.
    Odd = 1,
    /// The protocol's default.
    Even = 2,
}

/// As a new board comes, and as one answers whose button is held at power-up.
impl Default for Line {
    fn default() -> Self {
        Line {
            unit: 1,
            baud: 19_200,
            parity: LineParity::Even,
        }
    }
}

/// Bits of a character with start and stop bits.
const CHARACTER_BITS: u32 = 11;
/// The protocol's silence from 19 200 bit/s on, us, with a fifth for clocks and interrupts.
const SHORTEST_SILENCE_US: u32 = 2_100;

impl Line {
    pub(super) fn to_word(self) -> u32 {
        u32::from(self.unit) | u32::from(self.parity as u8) << 8
    }

    pub(super) fn from_word(word: u16, baud: u32) -> Result<Self, Refused> {
        let [unit, parity] = word.to_le_bytes();
        if !(1..=247).contains(&unit) {
            return Err(Refused::Unit);
        }
        if !(1_200..=115_200).contains(&baud) {
            return Err(Refused::Baud);
        }
        let parity = match parity {
            0 => LineParity::None,
            1 => LineParity::Odd,
            2 => LineParity::Even,
            _ => return Err(Refused::Parity),
        };
        Ok(Line { unit, baud, parity })
    }

    /// The silence that ends a frame, us: 3.5 characters, a fixed time where they are shorter (Modbus over serial line V1.02, 2.5.1.1).
    pub fn silence_us(&self) -> u32 {
        let characters = 7 * CHARACTER_BITS * 1_000_000 / (2 * self.baud.max(1));
        (characters + characters / 20).max(SHORTEST_SILENCE_US)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_survive_the_round_trip_and_others_are_refused() {
        for parity in [LineParity::None, LineParity::Odd, LineParity::Even] {
            for (unit, baud) in [(1, 1_200), (247, 115_200)] {
                let line = Line { unit, baud, parity };
                assert_eq!(Line::from_word(line.to_word() as u16, baud), Ok(line));
            }
        }
        let of = |unit: u16, parity: u16, baud| Line::from_word(unit | parity << 8, baud);
        assert_eq!(of(0, 2, 19_200), Err(Refused::Unit));
        assert_eq!(of(248, 2, 19_200), Err(Refused::Unit));
        assert_eq!(of(1, 3, 19_200), Err(Refused::Parity));
        assert_eq!(of(1, 2, 1_199), Err(Refused::Baud));
        assert_eq!(of(1, 2, 115_201), Err(Refused::Baud));
    }

    #[test]
    fn a_frame_ends_after_three_and_a_half_characters() {
        let at = |baud| {
            Line {
                baud,
                ..Line::default()
            }
            .silence_us()
        };
        // 38.5 bits of 1/1200 s are 32.08 ms.
        assert!((32_083..35_000).contains(&at(1_200)), "{}", at(1_200));
        assert!((4_010..4_300).contains(&at(9_600)), "{}", at(9_600));
        // The protocol's 1.75 ms hold from 19 200 bit/s on.
        assert!((1_750..2_200).contains(&at(115_200)));
    }
}
