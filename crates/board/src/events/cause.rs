//! What can happen, with its number in flash and what its two values say.

/// Cause of an event. The numbers are those in flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum EventCause {
    /// What ended the program before it started again.
    Crash = 1,
    /// The program started.
    Start = 2,
    /// FAULT lit.
    FaultOn = 3,
    /// FAULT went out.
    FaultOff = 4,
    /// SENSOR lit.
    SensorOn = 5,
    /// SENSOR went out.
    SensorOff = 6,
    /// The board doubts something more about itself.
    Doubt = 7,
    /// Learning began.
    LearnBegun = 8,
    /// A calibration was learnt and stored.
    Learnt = 9,
    /// Learning was refused.
    LearnRefused = 10,
    /// The calibration in flash is not used.
    CalibrationIgnored = 11,
    /// A person or a master acknowledged.
    Acknowledged = 12,
    /// Samples were missing.
    SamplesMissing = 13,
    /// A master had the option bytes written.
    Prepared = 14,
    /// A configuration was confirmed and stored.
    Configured = 15,
    /// A configuration on trial was given up.
    TrialEnded = 16,
    /// A new program runs for the first time.
    UpdateInstalled = 17,
    /// The new program confirmed itself.
    UpdateConfirmed = 18,
    /// The new program did not confirm itself, and the one before runs again.
    UpdateReverted = 19,
    /// A program that was received is not taken.
    UpdateRefused = 20,
}

/// Number of causes.
pub(super) const CAUSES: usize = EventCause::ALL.len();

impl EventCause {
    /// All of them, in the order of their numbers.
    pub const ALL: [EventCause; 20] = [
        EventCause::Crash,
        EventCause::Start,
        EventCause::FaultOn,
        EventCause::FaultOff,
        EventCause::SensorOn,
        EventCause::SensorOff,
        EventCause::Doubt,
        EventCause::LearnBegun,
        EventCause::Learnt,
        EventCause::LearnRefused,
        EventCause::CalibrationIgnored,
        EventCause::Acknowledged,
        EventCause::SamplesMissing,
        EventCause::Prepared,
        EventCause::Configured,
        EventCause::TrialEnded,
        EventCause::UpdateInstalled,
        EventCause::UpdateConfirmed,
        EventCause::UpdateReverted,
        EventCause::UpdateRefused,
    ];

    /// By its number.
    pub fn by_number(number: u16) -> Option<Self> {
        Self::ALL.into_iter().find(|cause| *cause as u16 == number)
    }

    /// Place in tables of all causes.
    pub(super) fn index(self) -> usize {
        self as usize - 1
    }

    /// In words.
    pub fn label(self) -> &'static str {
        match self {
            EventCause::Start => "start",
            EventCause::Crash => "crash",
            EventCause::FaultOn => "FAULT on",
            EventCause::FaultOff => "FAULT off",
            EventCause::SensorOn => "SENSOR on",
            EventCause::SensorOff => "SENSOR off",
            EventCause::Doubt => "doubt",
            EventCause::LearnBegun => "learning",
            EventCause::Learnt => "learnt",
            EventCause::LearnRefused => "learning refused",
            EventCause::CalibrationIgnored => "calibration ignored",
            EventCause::Acknowledged => "acknowledged",
            EventCause::SamplesMissing => "samples missing",
            EventCause::Prepared => "option bytes",
            EventCause::Configured => "configured",
            EventCause::TrialEnded => "trial of a configuration given up",
            EventCause::UpdateInstalled => "new program on trial",
            EventCause::UpdateConfirmed => "new program confirmed",
            EventCause::UpdateReverted => "program brought back",
            EventCause::UpdateRefused => "program refused",
        }
    }

    /// What its two values say.
    pub fn values(self) -> [&'static str; 2] {
        match self {
            EventCause::Start => ["ResetCause", "ProgramChecksum, 0 where it was not sealed"],
            EventCause::Crash => ["CrashCause", "CrashProgramCounter"],
            EventCause::FaultOn => ["LikelyFault", "FaultProbability, per mille"],
            EventCause::SensorOn => ["NotJudged", "Doubts"],
            EventCause::Doubt => ["bits of the new doubts", "Doubts"],
            EventCause::Learnt => ["CalibrationIdentification", ""],
            EventCause::LearnRefused => ["Learning", "Doubts"],
            EventCause::CalibrationIgnored => ["Calibration", ""],
            EventCause::Configured | EventCause::TrialEnded => {
                ["MotorIdentification", "address of the line"]
            }
            EventCause::SamplesMissing => {
                ["1 none came, 2 overrun, 3 channels and encoder apart", ""]
            }
            EventCause::UpdateInstalled
            | EventCause::UpdateConfirmed
            | EventCause::UpdateReverted => ["ProgramVersion", "ProgramChecksum"],
            EventCause::UpdateRefused => ["UpdateRefused", ""],
            EventCause::FaultOff
            | EventCause::SensorOff
            | EventCause::LearnBegun
            | EventCause::Acknowledged
            | EventCause::Prepared => ["", ""],
        }
    }

    /// The values of an event that happened again before it could be written: bits are collected, of numbers the last holds.
    pub(super) fn merged(self, before: [u32; 2], now: [u32; 2]) -> [u32; 2] {
        match (self, before, now) {
            (EventCause::Doubt, [earlier, _], [later, all]) => [earlier | later, all],
            _ => now,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cause_has_its_own_number_and_place() {
        for (k, cause) in EventCause::ALL.into_iter().enumerate() {
            assert_eq!(EventCause::by_number(cause as u16), Some(cause));
            assert_eq!(cause.index(), k);
        }
        assert_eq!(EventCause::by_number(0), None);
        assert_eq!(EventCause::by_number(1 + CAUSES as u16), None);
    }
}
