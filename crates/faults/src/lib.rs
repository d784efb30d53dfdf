//! The catalogue of faults: each with its name, its row in the published table, its number on the wire, and what people read.
//!
//! Code names a fault by its [`FaultId`]; text becomes one where it is read ([`FaultId::from_name`]). The texts are
//! functions of their own: the firmware calls none of them, and they take no flash there.

#![cfg_attr(not(test), no_std)]

use core::fmt;

/// What may be wrong with a motor or its instruments. The value is its number in frames and registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum FaultId {
    /// None of the others.
    Unknown = 0,
    /// Stator resistance.
    StatorResistance = 1,
    /// Rotor resistance.
    RotorResistance = 2,
    /// Stator inductance.
    StatorInductance = 3,
    /// Rotor inductance.
    RotorInductance = 4,
    /// Friction of the motor.
    Friction = 5,
    /// Friction that stands for the load.
    LoadFriction = 6,
    /// Current measurement (`I_q`).
    CurrentSensor = 7,
    /// Voltage measurement (`V_q`).
    VoltageSensor = 8,
    /// Speed measurement.
    SpeedSensor = 9,
    /// Magnetizing inductance.
    MagnetizingInductance = 10,
    /// Leakage inductances of stator and rotor: their sum alone is ever seen.
    Leakage = 11,
    /// Shorted turns.
    Turns = 12,
    /// Broken rotor bars.
    Bars = 13,
}

/// r1 to r4, `true` where the lamp lights.
type Pattern = [bool; 4];

impl FaultId {
    /// Every fault, in the order of its number.
    pub const ALL: [FaultId; 14] = [
        FaultId::Unknown,
        FaultId::StatorResistance,
        FaultId::RotorResistance,
        FaultId::StatorInductance,
        FaultId::RotorInductance,
        FaultId::Friction,
        FaultId::LoadFriction,
        FaultId::CurrentSensor,
        FaultId::VoltageSensor,
        FaultId::SpeedSensor,
        FaultId::MagnetizingInductance,
        FaultId::Leakage,
        FaultId::Turns,
        FaultId::Bars,
    ];

    /// Short name in files, tables and answers: as in Table 1 of the paper where it has a row there.
    pub const fn name(self) -> &'static str {
        match self {
            FaultId::Unknown => "unknown",
            FaultId::StatorResistance => "Rs",
            FaultId::RotorResistance => "Rr",
            FaultId::StatorInductance => "Ls",
            FaultId::RotorInductance => "Lr",
            FaultId::Friction => "B",
            FaultId::LoadFriction => "Bl",
            FaultId::CurrentSensor => "Iq",
            FaultId::VoltageSensor => "Vq",
            FaultId::SpeedSensor => "wr",
            FaultId::MagnetizingInductance => "Lm",
            FaultId::Leakage => "leakage",
            FaultId::Turns => "turns",
            FaultId::Bars => "bars",
        }
    }

    /// The fault of a name; `None` for a name that is not in the catalogue.
    pub fn from_name(name: &str) -> Option<FaultId> {
        FaultId::ALL.into_iter().find(|fault| fault.name() == name)
    }

    /// Number in the board's registers; 0 for [`FaultId::Unknown`].
    pub const fn number(self) -> u16 {
        self as u16
    }

    /// The row of Table 1 of the paper: which of r1..r4 it lights. `None` for a fault that is not in it.
    pub const fn published_pattern(self) -> Option<Pattern> {
        const I: bool = true;
        const O: bool = false;
        Some(match self {
            FaultId::StatorResistance | FaultId::RotorResistance => [I, O, O, I],
            FaultId::StatorInductance | FaultId::VoltageSensor => [I, O, I, I],
            FaultId::RotorInductance => [I, I, I, I],
            FaultId::Friction | FaultId::LoadFriction => [O, I, I, I],
            FaultId::CurrentSensor => [I, I, I, O],
            FaultId::SpeedSensor => [I, I, O, I],
            FaultId::MagnetizingInductance
            | FaultId::Leakage
            | FaultId::Turns
            | FaultId::Bars
            | FaultId::Unknown => return None,
        })
    }

    /// Whether it lies in the instrument, not in the motor.
    pub const fn is_sensor(self) -> bool {
        matches!(
            self,
            FaultId::CurrentSensor | FaultId::VoltageSensor | FaultId::SpeedSensor
        )
    }

    /// In plain words.
    pub const fn words(self) -> &'static str {
        match self {
            FaultId::Unknown => "none of the faults in the table",
            FaultId::StatorResistance => "stator resistance",
            FaultId::RotorResistance => "rotor resistance",
            FaultId::StatorInductance => "stator inductance",
            FaultId::RotorInductance => "rotor inductance",
            FaultId::Friction => "friction of the motor",
            FaultId::LoadFriction => "friction of the load",
            FaultId::CurrentSensor => "current sensor",
            FaultId::VoltageSensor => "voltage sensor",
            FaultId::SpeedSensor => "speed sensor",
            FaultId::MagnetizingInductance => "magnetizing inductance",
            FaultId::Leakage => "leakage inductance",
            FaultId::Turns => "shorted turns",
            FaultId::Bars => "broken rotor bars",
        }
    }

    /// The measurement that would prove or clear it; `None` where nothing is known.
    pub const fn separating_test(self) -> Option<&'static str> {
        Some(match self {
            FaultId::Unknown => return None,
            FaultId::StatorResistance => "measure the windings' DC resistance, phase by phase",
            FaultId::RotorResistance => {
                "record without load: the rotor's resistance no longer shows, a wrong speed still does"
            }
            FaultId::SpeedSensor => "hold a strobe or a second tachometer to the shaft",
            FaultId::MagnetizingInductance => {
                "record without load, where the magnetizing inductance alone decides the current"
            }
            FaultId::StatorInductance | FaultId::RotorInductance | FaultId::Leakage => {
                "record near rated load, where leakage weighs most, and without load, where it weighs least"
            }
            FaultId::Friction | FaultId::LoadFriction => {
                "let the motor coast down with the load uncoupled: what slows it then is its own friction"
            }
            FaultId::CurrentSensor => "clamp a second ammeter around each lead",
            FaultId::VoltageSensor => "hold a second voltmeter to the terminals",
            FaultId::Turns => {
                "compare the windings' resistances and inductances phase by phase, at rest"
            }
            FaultId::Bars => {
                "record at another load: the sidebands of broken bars move with the slip, those of a swinging load do not"
            }
        })
    }

    /// What to ask first of a motor without a calibration, which would know heat; `None` where nothing comes first.
    pub const fn first_advice(self) -> Option<&'static str> {
        match self {
            FaultId::StatorResistance | FaultId::RotorResistance => Some(
                "rule out heat: is the motor hotter than its motor file says? Warm windings have a larger resistance",
            ),
            FaultId::RotorInductance => Some(
                "is it this motor's file? A file that is not, one that lacks an effect (drivemon explain says which), several faults at once, broken bars and shorted turns light all four residuals, too",
            ),
            _ => None,
        }
    }
}

impl fmt::Display for FaultId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fault_stands_once_under_its_number_and_name() {
        for (number, fault) in (0..).zip(FaultId::ALL) {
            assert_eq!(fault.number(), number);
            assert_eq!(FaultId::from_name(fault.name()), Some(fault));
        }
        assert_eq!(FaultId::from_name("rs"), None);
    }

    #[test]
    fn what_has_a_row_in_the_table_has_a_test_that_separates_it() {
        for fault in FaultId::ALL {
            let in_table = fault.published_pattern().is_some();
            assert!(!in_table || fault.separating_test().is_some(), "{fault}");
            assert!(!fault.is_sensor() || in_table, "{fault}");
        }
    }
}
