//! What can be wrong with a calibrated motor, as the evidence tells it apart.

use crate::checks::sensors::Phase;
use motor::FaultId;

/// One cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Stator resistance of all phases, off the direction of heating.
    StatorResistance,
    /// Rotor resistance, off the direction of heating.
    RotorResistance,
    /// Magnetizing inductance.
    MagnetizingInductance,
    /// Leakage inductances of stator and rotor.
    Leakage,
    /// Friction of motor and load: they only ever appear as `B + B_l`.
    Friction,
    /// All current channels alike.
    AllCurrents,
    /// All voltage channels alike.
    AllVoltages,
    /// The speed measurement.
    SpeedGain,
    /// A resistance in series with one phase: a joint, a contact, a winding.
    SeriesResistance(Phase),
    /// Shorted turns in one phase.
    Turns(Phase),
    /// One current channel.
    CurrentChannel(Phase),
    /// One voltage channel.
    VoltageChannel(Phase),
}

/// How many causes are weighed.
pub const CAUSES: usize = 20;

use Phase::{A, B, C};

/// All causes, in the order of [`super::Isolation::scores`].
pub const ALL_CAUSES: [Cause; CAUSES] = [
    Cause::StatorResistance,
    Cause::RotorResistance,
    Cause::MagnetizingInductance,
    Cause::Leakage,
    Cause::Friction,
    Cause::AllCurrents,
    Cause::AllVoltages,
    Cause::SpeedGain,
    Cause::SeriesResistance(A),
    Cause::SeriesResistance(B),
    Cause::SeriesResistance(C),
    Cause::Turns(A),
    Cause::Turns(B),
    Cause::Turns(C),
    Cause::CurrentChannel(A),
    Cause::CurrentChannel(B),
    Cause::CurrentChannel(C),
    Cause::VoltageChannel(A),
    Cause::VoltageChannel(B),
    Cause::VoltageChannel(C),
];

/// The first so many causes are in all phases alike.
pub(super) const OF_ALL_PHASES: usize = 8;
/// From here on causes are channels of one phase.
pub(super) const FIRST_CHANNEL: usize = 14;

impl Cause {
    /// The fault of the catalogue that it is, in all phases or in one.
    pub const fn fault(self) -> FaultId {
        match self {
            Cause::StatorResistance | Cause::SeriesResistance(_) => FaultId::StatorResistance,
            Cause::RotorResistance => FaultId::RotorResistance,
            Cause::MagnetizingInductance => FaultId::MagnetizingInductance,
            Cause::Leakage => FaultId::Leakage,
            Cause::Friction => FaultId::Friction,
            Cause::AllCurrents | Cause::CurrentChannel(_) => FaultId::CurrentSensor,
            Cause::AllVoltages | Cause::VoltageChannel(_) => FaultId::VoltageSensor,
            Cause::SpeedGain => FaultId::SpeedSensor,
            Cause::Turns(_) => FaultId::Turns,
        }
    }

    /// The phase, where the cause has one.
    pub const fn phase(self) -> Option<Phase> {
        match self {
            Cause::SeriesResistance(phase)
            | Cause::Turns(phase)
            | Cause::CurrentChannel(phase)
            | Cause::VoltageChannel(phase) => Some(phase),
            _ => None,
        }
    }

    /// Whether the cause lies in the instrument, not in the motor.
    pub const fn is_sensor(self) -> bool {
        self.fault().is_sensor()
    }

    /// A typical size as a share of the healthy value: it weighs a cause that explains much with little against others.
    pub const fn typical_size(self) -> f32 {
        match self {
            Cause::StatorResistance | Cause::RotorResistance => 0.3,
            Cause::MagnetizingInductance => 0.15,
            Cause::Leakage | Cause::Friction | Cause::SeriesResistance(_) => 0.5,
            Cause::AllCurrents | Cause::AllVoltages => 0.1,
            Cause::CurrentChannel(_) | Cause::VoltageChannel(_) => 0.2,
            Cause::SpeedGain => 0.05,
            Cause::Turns(_) => 0.3,
        }
    }

    /// The relative change behind a departure along its direction, as if rows grew in proportion. A gain `1 + g` of one channel
    /// multiplies the positive sequence, to which all rows are relative, by `1 + g/3`: they show `g/(1 + g/3)`.
    pub(super) fn change(self, shown: f32) -> f32 {
        match self {
            Cause::CurrentChannel(_) | Cause::VoltageChannel(_) => {
                shown / (1.0 - shown / 3.0).max(LEAST_REST)
            }
            _ => shown,
        }
    }

    /// What a second direction of the cause is: a part of its own that only adds (a share of its size in any proportion), or where a
    /// standard deviation of something uncertain moves the first direction, per relative change.
    pub(super) fn adds_across(self) -> bool {
        matches!(self, Cause::Turns(_))
    }

    /// How far a real fault's direction may lie off the computed one, as a share of its length: large changes bend it, those of
    /// turns in the loop's current and in the winding that is left.
    pub const fn looseness(self) -> f32 {
        match self {
            Cause::Turns(_) => 0.15,
            _ => 0.1,
        }
    }

    /// Whether only an increase is possible: a contact or a short only ever adds.
    pub const fn only_adds(self) -> bool {
        matches!(self, Cause::SeriesResistance(_) | Cause::Turns(_))
    }
}

/// `1 - s/3` of a gain of 28, which no instrument in use has: a larger size is told as that.
const LEAST_REST: f32 = 0.1;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cause_is_listed_once() {
        for (k, cause) in ALL_CAUSES.iter().enumerate() {
            assert!(!ALL_CAUSES.iter().skip(k + 1).any(|other| other == cause));
        }
    }

    #[test]
    fn causes_of_all_phases_come_first_and_channels_last() {
        for (k, cause) in ALL_CAUSES.iter().enumerate() {
            assert_eq!(cause.phase().is_none(), k < OF_ALL_PHASES, "{cause:?}");
            let is_channel = cause.phase().is_some() && cause.is_sensor();
            assert_eq!(is_channel, k >= FIRST_CHANNEL, "{cause:?}");
        }
    }

    /// Rows of Table 1 where there is one; phases where there are; the instrument apart from the motor.
    #[test]
    fn causes_say_what_and_where_they_are() {
        for cause in ALL_CAUSES {
            let (name, sensor, phased, adds) = match cause {
                Cause::StatorResistance => ("Rs", false, None, false),
                Cause::RotorResistance => ("Rr", false, None, false),
                Cause::MagnetizingInductance => ("Lm", false, None, false),
                Cause::Leakage => ("leakage", false, None, false),
                Cause::Friction => ("B", false, None, false),
                Cause::AllCurrents => ("Iq", true, None, false),
                Cause::AllVoltages => ("Vq", true, None, false),
                Cause::SpeedGain => ("wr", true, None, false),
                Cause::SeriesResistance(p) => ("Rs", false, Some(p), true),
                Cause::Turns(p) => ("turns", false, Some(p), true),
                Cause::CurrentChannel(p) => ("Iq", true, Some(p), false),
                Cause::VoltageChannel(p) => ("Vq", true, Some(p), false),
            };
            assert_eq!(
                (cause.fault().name(), cause.is_sensor()),
                (name, sensor),
                "{cause:?}"
            );
            assert_eq!(
                (cause.phase(), cause.only_adds()),
                (phased, adds),
                "{cause:?}"
            );
            assert!(cause.looseness() > 0.0 && cause.looseness() < 1.0);
        }
    }
}
