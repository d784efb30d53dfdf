//! What a value of the register map is: its name, how it lies in registers, its unit, and what it says.

use core::fmt;

use monitor::{FaultId, MotionWord, Reason};
use update::UpdateState;

use crate::configuration::Refused;
use crate::health::doubt::Doubt;
use crate::health::fault_record::FaultCause;
use crate::learn::LearnState;

/// Names of the values, in the order of their addresses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // The map says it once, for the documentation too.
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
    SerialHigh,
    SerialMiddle,
    SerialLow,
    CalibrationIdentification,
    LastEvent,
    Configuration,
    ConfigurationRefused,
    TrialSeconds,
    StartNumber,
    LastSecond,
    Motion,
    Update,
    UpdateRefused,
    UpdateBytes,
    UpdateTrial,
    ProgramVersion,
}

/// Number of values.
pub(super) const FIELDS: usize = Field::ProgramVersion as usize + 1;

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
    /// One of some numbers, each with its words.
    Numbers(&'static [(u16, &'static str)]),
    /// Number of a [`Reason`].
    Reasons,
    /// Number of a [`MotionWord`].
    Motion,
    /// Number of a [`FaultId`].
    Faults,
    /// Bits of [`Doubts`](crate::Doubts).
    Doubts,
    /// Number of a [`FaultCause`].
    Crashes,
    /// Code of a [`LearnState`].
    Learning,
    /// Number of a [`Refused`].
    Refusals,
    /// Number of an [`UpdateState`].
    Updates,
    /// Number of an [`update::Refusal`].
    UpdateRefusals,
}

impl Meaning {
    /// What a number stands for; `None` where it is none of a list.
    pub fn label(&self, number: u16) -> Option<&'static str> {
        let mut found = None;
        self.each(&mut |listed, label| {
            if listed == number {
                found = Some(label);
            }
        });
        found
    }

    fn each(&self, tell: &mut dyn FnMut(u16, &'static str)) {
        match self {
            Meaning::Words(_) | Meaning::Doubts => {}
            Meaning::Numbers(list) => list.iter().for_each(|(number, label)| tell(*number, label)),
            Meaning::Reasons => {
                tell(0, "judged");
                for why in Reason::ALL {
                    tell(u16::from(why.number()), why.label());
                }
            }
            Meaning::Motion => {
                MotionWord::ALL
                    .into_iter()
                    .for_each(|word| tell(word as u16, word.label()));
            }
            Meaning::Faults => {
                tell(0, "none of them");
                let named = FaultId::ALL.into_iter().filter(|fault| fault.number() > 0);
                named.for_each(|fault| tell(fault.number(), fault.name()));
            }
            Meaning::Crashes => {
                tell(0, "nothing");
                FaultCause::ALL
                    .into_iter()
                    .for_each(|cause| tell(cause as u16, cause.label()));
            }
            Meaning::Learning => {
                LearnState::all().for_each(|state| tell(state.code(), state.label()));
            }
            Meaning::Refusals => {
                tell(0, "nothing");
                Refused::ALL
                    .into_iter()
                    .for_each(|refused| tell(refused as u16, refused.label()));
            }
            Meaning::Updates => {
                UpdateState::ALL
                    .into_iter()
                    .for_each(|state| tell(state as u16, state.label()));
            }
            Meaning::UpdateRefusals => {
                tell(0, "none was refused");
                update::Refusal::ALL
                    .into_iter()
                    .for_each(|refusal| tell(refusal as u16, refusal.label()));
            }
        }
    }

    fn before_and_behind(&self) -> [&'static str; 2] {
        match self {
            Meaning::Words(words) => [words, ""],
            Meaning::Doubts => [
                "what the board doubts about itself, a bit each from the lowest: ",
                "",
            ],
            Meaning::Faults => [
                "likeliest cause while FAULT is lit: ",
                "; causes of the same pattern are tied, the first is named",
            ],
            Meaning::Refusals => ["what of the last configuration was refused: ", ""],
            Meaning::UpdateRefusals => ["why a program was not taken: ", ""],
            Meaning::Crashes => ["what ended the program before its last start: ", ""],
            Meaning::Numbers(_)
            | Meaning::Reasons
            | Meaning::Motion
            | Meaning::Learning
            | Meaning::Updates => ["", ""],
        }
    }
}

impl fmt::Display for Meaning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [before, behind] = self.before_and_behind();
        f.write_str(before)?;
        let (mut first, mut written) = (true, Ok(()));
        let mut tell = |number: usize, label: &'static str| {
            let comma = if first { "" } else { ", " };
            first = false;
            written = written.and_then(|()| write!(f, "{comma}{number} {label}"));
        };
        match self {
            Meaning::Doubts => {
                Doubt::ALL
                    .into_iter()
                    .for_each(|doubt| tell(doubt as usize, doubt.label()));
            }
            _ => self.each(&mut |number, label| tell(usize::from(number), label)),
        }
        written?;
        f.write_str(behind)
    }
}
