//! Why a window was not judged, by the number that stands in frames and registers.

use super::not_judged::NotJudged;

/// The reason without its details. The value is its number on the wire; 0 is a judged window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Reason {
    /// No periodic supply was found.
    NotLocked = 1,
    /// The first cycles.
    Settling = 2,
    /// A channel clips.
    Clipped = 3,
    /// Samples are no numbers.
    Invalid = 4,
    /// Voltages are not measured.
    NoVoltages = 5,
    /// Currents are not measured.
    NoCurrents = 6,
    /// The speed is not measured.
    NoSpeed = 7,
    /// The supply is missing or not as it should be.
    Supply = 8,
    /// A sensor is dead or contradicts the others.
    Sensor = 9,
    /// Current or speed are changing.
    Transient = 10,
    /// The motor draws no current.
    NoLoadCurrent = 11,
    /// The shaft turns against the field.
    Reversing = 12,
    /// Noise hides what the lamps are to show.
    Noise = 13,
    /// The board doubts its own converters or their supply: nothing that it measures counts.
    Instrument = 14,
    /// Something came in motion that is called no fault.
    DoesNotFit = 15,
    /// The shaft is held or slow.
    Held = 16,
}

impl Reason {
    /// Every reason, in the order of its number.
    pub const ALL: [Reason; 16] = [
        Reason::NotLocked,
        Reason::Settling,
        Reason::Clipped,
        Reason::Invalid,
        Reason::NoVoltages,
        Reason::NoCurrents,
        Reason::NoSpeed,
        Reason::Supply,
        Reason::Sensor,
        Reason::Transient,
        Reason::NoLoadCurrent,
        Reason::Reversing,
        Reason::Noise,
        Reason::Instrument,
        Reason::DoesNotFit,
        Reason::Held,
    ];

    /// Number on the wire.
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// The reason of a number; `None` for a judged window (0) and for a number that this version does not know.
    pub fn from_number(number: u8) -> Option<Reason> {
        let mut all = Reason::ALL.into_iter();
        all.find(|reason| reason.number() == number)
    }

    /// In two or three words, for the register map.
    pub const fn label(self) -> &'static str {
        match self {
            Reason::NotLocked => "no supply found",
            Reason::Settling => "settling",
            Reason::Clipped => "clipped",
            Reason::Invalid => "invalid",
            Reason::NoVoltages => "no voltages",
            Reason::NoCurrents => "no currents",
            Reason::NoSpeed => "no speed",
            Reason::Supply => "supply",
            Reason::Sensor => "sensor",
            Reason::Transient => "transient",
            Reason::NoLoadCurrent => "no load current",
            Reason::Reversing => "braking or reversing",
            Reason::Noise => "noise",
            Reason::Instrument => "instrument",
            Reason::DoesNotFit => "does not fit in motion",
            Reason::Held => "shaft held or slow",
        }
    }
}

impl NotJudged {
    /// The reason without its details.
    pub const fn reason(self) -> Reason {
        match self {
            NotJudged::NotLocked => Reason::NotLocked,
            NotJudged::Settling => Reason::Settling,
            NotJudged::Clipped => Reason::Clipped,
            NotJudged::Invalid => Reason::Invalid,
            NotJudged::NoVoltages => Reason::NoVoltages,
            NotJudged::NoCurrents => Reason::NoCurrents,
            NotJudged::NoSpeed => Reason::NoSpeed,
            NotJudged::Supply(_) => Reason::Supply,
            NotJudged::Sensor(_) => Reason::Sensor,
            NotJudged::Transient => Reason::Transient,
            NotJudged::NoLoadCurrent => Reason::NoLoadCurrent,
            NotJudged::Reversing => Reason::Reversing,
            NotJudged::Noise => Reason::Noise,
            NotJudged::Held => Reason::Held,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reason_stands_once_under_its_number() {
        for (number, reason) in (1..).zip(Reason::ALL) {
            assert_eq!(reason.number(), number);
            assert_eq!(Reason::from_number(number), Some(reason));
        }
        assert_eq!(
            (Reason::from_number(0), Reason::from_number(17)),
            (None, None)
        );
    }
}
