//! The register map: one table, from which addresses follow and against which docs/modbus.md is tested.

use core::fmt;

use monitor::{FaultId, Reason};

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

const fn entry(field: Field, kind: Kind, unit: &'static str, meaning: &'static str) -> Entry {
    Entry {
        field,
        kind,
        unit,
        meaning: Meaning::Words(meaning),
    }
}

const fn numbered(field: Field, meaning: Meaning) -> Entry {
    Entry {
        field,
        kind: Kind::Word,
        unit: "",
        meaning,
    }
}

/// Names of the values, in the order of [`MAP`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // MAP says it once, for the documentation too.
pub enum Field {
    MapVersion,
    MotorIdentification,
    ResetCause,
    Lamps,
    NotJudged,
    Verdict,
    LikelyFault,
    FaultProbability,
    Windows,
    WindowsJudged,
    Residual1,
    Residual2,
    Residual3,
    Residual4,
    Threshold1,
    Threshold2,
    Threshold3,
    Threshold4,
    Voltage,
    VoltageA,
    VoltageB,
    VoltageC,
    Current,
    CurrentA,
    CurrentB,
    CurrentC,
    SupplyFrequency,
    Speed,
    Temperature,
    ConverterSupply,
    Calibration,
    Learning,
    LearnedWindows,
    Capture,
    CurrentLag,
    Doubts,
    Relay,
    Uptime,
    Stack,
    Crashes,
    CrashCause,
    CrashProgramCounter,
    CrashLink,
    CrashStatus,
    CrashFaults,
    CrashHardFault,
    CrashAddress,
    CrashStack,
    CrashLine,
    CrashLength,
    CrashUptime,
    ProgramLength,
    ProgramChecksum,
    StoredDataErrors,
}

const FIELDS: usize = Field::StoredDataErrors as usize + 1;

/// Every input register, in order of address.
pub const MAP: [Entry; FIELDS] = {
    use Field::*;
    use Kind::*;
    [
        entry(
            MapVersion,
            Word,
            "",
            "2; grows when an address changes its meaning",
        ),
        entry(
            MotorIdentification,
            Long,
            "",
            "checksum of the motor constants in flash",
        ),
        entry(
            ResetCause,
            Word,
            "",
            "1 power or brown-out, 2 watchdog, 3 program, 4 reset pin, 5 other",
        ),
        entry(
            Lamps,
            Long,
            "",
            "two bits per lamp from the lowest, in the order RUN r1 r2 r3 r4 SENSOR LINE LOAD FAULT: 0 off, 1 on, 2 blinking",
        ),
        numbered(NotJudged, Meaning::Reasons),
        entry(
            Verdict,
            Word,
            "",
            "0 not judged yet or SENSOR lit, 1 healthy, 2 FAULT lit",
        ),
        numbered(LikelyFault, Meaning::Faults),
        entry(FaultProbability, Word, "per mille", "its probability"),
        entry(Windows, Long, "", "windows since the start"),
        entry(WindowsJudged, Long, "", "of these judged"),
        entry(Residual1, Float, "", "r1, share of its scale"),
        entry(Residual2, Float, "", "r2"),
        entry(Residual3, Float, "", "r3"),
        entry(Residual4, Float, "", "r4"),
        entry(Threshold1, Float, "", "threshold of r1, share of its scale"),
        entry(Threshold2, Float, "", "of r2"),
        entry(Threshold3, Float, "", "of r3"),
        entry(Threshold4, Float, "", "of r4"),
        entry(Voltage, Float, "V", "phase voltage, positive sequence, RMS"),
        entry(VoltageA, Float, "V", "phase a, fundamental, RMS"),
        entry(VoltageB, Float, "V", "phase b"),
        entry(VoltageC, Float, "V", "phase c"),
        entry(Current, Float, "A", "phase current, positive sequence, RMS"),
        entry(CurrentA, Float, "A", "phase a, fundamental, RMS"),
        entry(CurrentB, Float, "A", "phase b"),
        entry(CurrentC, Float, "A", "phase c"),
        entry(SupplyFrequency, Float, "Hz", "of the supply"),
        entry(Speed, Float, "1/min", "of the shaft"),
        entry(
            Temperature,
            Float,
            "degC",
            "of the chip, some 5 K uncertain; not of the motor",
        ),
        entry(
            ConverterSupply,
            Word,
            "mV",
            "supply of the converters, 3300 is nominal",
        ),
        entry(
            Calibration,
            Word,
            "",
            "0 motor file's values, 1 learnt ones, 2 learnt ones lost, 3 learnt ones are another motor's",
        ),
        entry(
            Learning,
            Word,
            "",
            "0 idle, 1 learning, 2 stored; refused: 17 sensor, 18 line, 19 unsteady, 20 too few windows, 21 offset, 22 residuals too large, 23 flash, 24 instrument",
        ),
        entry(
            LearnedWindows,
            Word,
            "",
            "windows judged while learning, 600 are needed",
        ),
        entry(
            Capture,
            Word,
            "",
            "0 waiting for an alarm, 1 taking the samples around it, 2 complete",
        ),
        entry(
            CurrentLag,
            Float,
            "degree",
            "current behind voltage, positive sequence, -180 to 180, to 0.2; beyond 90 the machine gives power, or its currents are measured the wrong way round",
        ),
        Entry {
            field: Doubts,
            kind: Long,
            unit: "",
            meaning: Meaning::Doubts,
        },
        entry(Relay, Word, "", "1 energised, 0 open"),
        entry(Uptime, Long, "s", "since the start"),
        entry(
            Stack,
            Word,
            "byte",
            "deepest stack since the start, of 20 480",
        ),
        entry(
            Crashes,
            Word,
            "",
            "crashes without a quiet minute between them; from 3 on nothing is computed until somebody acknowledges",
        ),
        Entry {
            field: CrashCause,
            kind: Word,
            unit: "",
            meaning: Meaning::Crashes,
        },
        entry(
            CrashProgramCounter,
            Long,
            "",
            "of the last crash: program counter",
        ),
        entry(CrashLink, Long, "", "link register"),
        entry(CrashStatus, Long, "", "program status register"),
        entry(CrashFaults, Long, "", "fault status (CFSR)"),
        entry(CrashHardFault, Long, "", "hard fault status (HFSR)"),
        entry(
            CrashAddress,
            Long,
            "",
            "address that could not be reached or that failed; of a panic where the name of its file lies; of the watchdog the marks that were missing: 1 block, 2 Modbus, 4 self-test",
        ),
        entry(CrashStack, Long, "", "stack pointer"),
        entry(CrashLine, Word, "", "line of a panic"),
        entry(CrashLength, Word, "byte", "length of its file's name"),
        entry(CrashUptime, Long, "ms", "from the start to the crash"),
        entry(
            ProgramLength,
            Long,
            "byte",
            "of the program in flash, 0 where it was not sealed",
        ),
        entry(
            ProgramChecksum,
            Long,
            "",
            "CRC-32 of the program, as it was sealed",
        ),
        entry(
            StoredDataErrors,
            Word,
            "",
            "double words of stored data that failed their error correction since the start; checksums decided",
        ),
    ]
};

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
