//! What a value of the register map is: its name, how it lies in registers, its unit, and what it says.

use core::fmt;

use monitor::{FaultId, MotionWord, Reason};
use update::UpdateState;

use crate::configuration::Refused;
use crate::health::doubt::Doubt;
use crate::health::fault_record::FaultCause;

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
    /// Number of a [`Refused`].
    Refusals,
    /// Number of an [`UpdateState`].
    Updates,
    /// Number of an [`update::Refusal`].
    UpdateRefusals,
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
            Meaning::Motion => list(f, MotionWord::ALL.map(|word| (word as usize, word.label()))),
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
            Meaning::Refusals => {
                f.write_str("what of the last configuration was refused: 0 nothing, ")?;
                list(
                    f,
                    Refused::ALL.map(|refused| (refused as usize, refused.label())),
                )
            }
            Meaning::Updates => list(
                f,
                UpdateState::ALL.map(|state| (state as usize, state.label())),
            ),
            Meaning::UpdateRefusals => {
                f.write_str("why a program was not taken: 0 none was refused, ")?;
                list(
                    f,
                    update::Refusal::ALL.map(|refusal| (refusal as usize, refusal.label())),
                )
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
