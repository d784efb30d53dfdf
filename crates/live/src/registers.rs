//! The register map of a board, read and put into words.

use board::modbus::{Entry, Field, Kind, MAP, MAP_VERSION, WORDS, address};
use board::{Doubts, FaultCause, FaultRecord, LAMP_NAMES, LAMPS};
use update::Version;

use crate::modbus::{ModbusError, ModbusLine};

/// Why there are no registers.
#[derive(Debug, thiserror::Error)]
pub enum RegistersError {
    /// The line.
    #[error(transparent)]
    Line(#[from] ModbusError),
    /// They have other meanings.
    #[error(
        "the board's register map has version {version}, this drivemon knows {MAP_VERSION}: use the drivemon of the firmware's version"
    )]
    Map {
        /// Which one the board has.
        version: u16,
    },
}

/// All input registers.
pub struct Registers(Vec<u16>);

impl Registers {
    /// Reads them.
    ///
    /// # Errors
    /// No answer, or a map of another version.
    pub fn read(line: &mut ModbusLine) -> Result<Self, RegistersError> {
        let [version] = line.read_inputs(0, 1)?[..] else {
            return Err(line.damaged().into());
        };
        if version != MAP_VERSION {
            return Err(RegistersError::Map { version });
        }
        Ok(Registers(line.read_inputs(0, WORDS as u16)?))
    }

    /// A value of one register.
    pub fn word(&self, field: Field) -> u16 {
        let at = usize::from(address(field));
        self.0.get(at).copied().unwrap_or(0)
    }

    /// A value of two registers.
    pub fn long(&self, field: Field) -> u32 {
        let at = usize::from(address(field));
        let low = self.0.get(at + 1).copied().unwrap_or(0);
        u32::from(self.word(field)) << 16 | u32::from(low)
    }

    /// A number; `None` where there is no value.
    pub fn number(&self, field: Field) -> Option<f32> {
        Some(f32::from_bits(self.long(field))).filter(|x| !x.is_nan())
    }

    /// What the board doubts about itself.
    pub fn doubts(&self) -> Doubts {
        Doubts::from_bits(self.long(Field::Doubts))
    }

    /// The crash before the last start.
    pub fn crash(&self) -> Option<FaultRecord> {
        let cause = FaultCause::by_number(u32::from(self.word(Field::CrashCause)))?;
        Some(FaultRecord {
            cause,
            pc: self.long(Field::CrashProgramCounter),
            lr: self.long(Field::CrashLink),
            xpsr: self.long(Field::CrashStatus),
            cfsr: self.long(Field::CrashFaults),
            hfsr: self.long(Field::CrashHardFault),
            address: self.long(Field::CrashAddress),
            sp: self.long(Field::CrashStack),
            line: u32::from(self.word(Field::CrashLine)),
            length: u32::from(self.word(Field::CrashLength)),
            uptime_ms: self.long(Field::CrashUptime),
        })
    }

    /// Name, value and unit of each entry.
    pub fn rows(&self) -> Vec<(String, String, &'static str)> {
        let row = |entry: &Entry| {
            let name = format!("{:?}", entry.field);
            (name, self.told(entry), entry.unit)
        };
        MAP.iter().map(row).collect()
    }

    fn told(&self, entry: &Entry) -> String {
        match (entry.field, entry.kind) {
            (Field::Lamps, _) => lamps(self.long(Field::Lamps)),
            (Field::Doubts, _) => doubts_in_words(self.doubts()),
            (field, _) if is_code(field) => format!("{:#010x}", self.long(field)),
            (Field::ProgramVersion, _) => Version(self.long(Field::ProgramVersion)).to_string(),
            (field, Kind::Word) => {
                let number = self.word(field);
                match entry.meaning.label(number) {
                    Some(label) => format!("{number} {label}"),
                    None => number.to_string(),
                }
            }
            (field, Kind::Long) => self.long(field).to_string(),
            (field, Kind::Float) => self
                .number(field)
                .map_or("-".into(), |number| format!("{number:.4}")),
        }
    }
}

/// Addresses, checksums and status words read better in hexadecimal digits.
fn is_code(field: Field) -> bool {
    use Field::*;
    matches!(
        field,
        MotorIdentification
            | CrashProgramCounter
            | CrashLink
            | CrashStatus
            | CrashFaults
            | CrashHardFault
            | CrashAddress
            | CrashStack
            | ProgramChecksum
            | SerialHigh
            | SerialMiddle
            | SerialLow
            | CalibrationIdentification
    )
}

fn lamps(word: u32) -> String {
    let lit = (0..LAMPS).filter_map(|k| match word >> (2 * k) & 3 {
        1 => Some(LAMP_NAMES[k].to_owned()),
        2 => Some(format!("{} blinks", LAMP_NAMES[k])),
        _ => None,
    });
    joined(lit.collect())
}

/// Doubts in words; "none" without any.
pub fn doubts_in_words(doubts: Doubts) -> String {
    joined(doubts.iter().map(|doubt| doubt.label().into()).collect())
}

fn joined(words: Vec<String>) -> String {
    match words.is_empty() {
        true => "none".into(),
        false => words.join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use board::modbus::Image;

    #[test]
    fn numbers_are_told_with_their_words_and_a_version_as_one() {
        let mut image = Image::default();
        image.set_word(Field::Update, 4);
        image.set_word(Field::Stack, 4);
        image.set_long(Field::ProgramVersion, 0x0102_0003);
        let words = image.range(0, WORDS as u16).expect("the whole map");
        let rows = Registers(words.to_vec()).rows();
        for (name, expected) in [
            ("Update", "4 new program on trial"),
            ("Stack", "4"),
            ("ProgramVersion", "1.2.3"),
            ("CrashCause", "0 nothing"),
        ] {
            let row = rows.iter().find(|(field, ..)| field == name);
            assert_eq!(
                row.map(|(_, value, _)| value.as_str()),
                Some(expected),
                "{name}"
            );
        }
    }
}
