//! An event as a sentence.

use core::fmt;

use monitor::{FaultId, Reason};
use update::Version;

use super::cause::EventCause;
use super::event::Event;
use crate::health::doubt::Doubts;
use crate::health::fault_record::FaultCause;
use crate::health::reset::RESET_CAUSES;
use crate::learn::LearnState;

/// What happened, without number and time: `FAULT on: stator resistance, 93 %`.
impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.cause.label())?;
        let [first, second] = self.values;
        match self.cause {
            EventCause::Start => start(f, first, second),
            EventCause::Crash => crash(f, first, second),
            EventCause::FaultOn => fault(f, first, second),
            EventCause::SensorOn => sensor(f, first, second),
            EventCause::Doubt => doubts(f, first),
            EventCause::Configured => {
                write!(f, ": motor constants {first:08x}, address {second}")
            }
            EventCause::TrialEnded => write!(
                f,
                ": motor constants {first:08x} and address {second} hold again"
            ),
            EventCause::Learnt => write!(f, ": calibration {first:08x}"),
            EventCause::LearnRefused => refusal(f, first, second),
            EventCause::CalibrationIgnored => calibration(f, first),
            EventCause::SamplesMissing => gap(f, first),
            EventCause::UpdateInstalled
            | EventCause::UpdateConfirmed
            | EventCause::UpdateReverted => {
                write!(f, ": version {}, program {second:08x}", Version(first))
            }
            EventCause::UpdateRefused => update(f, first),
            EventCause::FaultOff
            | EventCause::SensorOff
            | EventCause::LearnBegun
            | EventCause::Acknowledged
            | EventCause::Prepared => Ok(()),
        }?;
        match self.times {
            0 | 1 => Ok(()),
            times => write!(f, " ({times} times)"),
        }
    }
}

fn start(f: &mut fmt::Formatter<'_>, cause: u32, program: u32) -> fmt::Result {
    let known = RESET_CAUSES
        .iter()
        .find(|(number, _)| u32::from(*number) == cause);
    let why = known.map_or("an unknown cause", |(_, label)| *label);
    write!(f, ": reset by {why}")?;
    match program {
        0 => f.write_str(", program not sealed"),
        checksum => write!(f, ", program {checksum:08x}"),
    }
}

fn crash(f: &mut fmt::Formatter<'_>, cause: u32, pc: u32) -> fmt::Result {
    let what = FaultCause::by_number(cause).map_or("unknown", FaultCause::label);
    write!(f, ": {what}")?;
    match pc {
        0 => Ok(()),
        pc => write!(f, " at {pc:#010x}"),
    }
}

fn fault(f: &mut fmt::Formatter<'_>, number: u32, per_mille: u32) -> fmt::Result {
    let named = FaultId::ALL
        .into_iter()
        .find(|fault| number > 0 && u32::from(fault.number()) == number);
    match named {
        Some(fault) => write!(f, ": {}, {} %", fault.words(), (per_mille + 5) / 10),
        None => f.write_str(": no cause stands out"),
    }
}

fn sensor(f: &mut fmt::Formatter<'_>, reason: u32, doubted: u32) -> fmt::Result {
    let reason = Reason::ALL
        .into_iter()
        .find(|why| u32::from(why.number()) == reason);
    if let Some(reason) = reason {
        write!(f, ": {}", reason.label())?;
    }
    doubts(f, doubted)
}

fn refusal(f: &mut fmt::Formatter<'_>, code: u32, doubted: u32) -> fmt::Result {
    let state = LearnState::all().find(|state| u32::from(state.code()) == code);
    // The cause says "learning refused" already.
    let why = state.map_or("unknown", |state| {
        state.label().trim_start_matches("refused: ")
    });
    write!(f, ": {why}")?;
    doubts(f, doubted)
}

fn calibration(f: &mut fmt::Formatter<'_>, source: u32) -> fmt::Result {
    f.write_str(match source {
        3 => ": it is another motor's",
        _ => ": it is lost",
    })
}

fn gap(f: &mut fmt::Formatter<'_>, kind: u32) -> fmt::Result {
    f.write_str(match kind {
        1 => ": none came",
        2 => ": overrun",
        3 => ": channels and encoder came apart",
        _ => "",
    })
}

fn update(f: &mut fmt::Formatter<'_>, number: u32) -> fmt::Result {
    let number = u8::try_from(number).unwrap_or_default();
    match update::Refusal::by_number(number) {
        Some(refusal) => write!(f, ": {refusal}"),
        None => f.write_str(": unknown"),
    }
}

fn doubts(f: &mut fmt::Formatter<'_>, bits: u32) -> fmt::Result {
    for (k, doubt) in Doubts::from_bits(bits).iter().enumerate() {
        let before = if k == 0 { ": " } else { ", " };
        write!(f, "{before}{}", doubt.label())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::event::tests::example;
    use super::*;

    fn told(cause: EventCause, values: [u32; 2]) -> String {
        let event = Event {
            cause,
            values,
            times: 1,
            ..example(1)
        };
        event.to_string()
    }

    #[test]
    fn events_read_as_sentences() {
        for (cause, values, expected) in [
            (
                EventCause::Start,
                [2, 0x1234],
                "start: reset by watchdog, program 00001234".to_owned(),
            ),
            (
                EventCause::Crash,
                [2, 0x0800_1234],
                "crash: panic at 0x08001234".to_owned(),
            ),
            (
                EventCause::FaultOn,
                [1, 934],
                "FAULT on: stator resistance, 93 %".to_owned(),
            ),
            (
                EventCause::FaultOn,
                [0, 0],
                "FAULT on: no cause stands out".to_owned(),
            ),
            (
                EventCause::Doubt,
                [0b11, 0b111],
                "doubt: converters' supply, stuck channel".to_owned(),
            ),
            (
                EventCause::LearnRefused,
                [24, 1],
                "learning refused: the board doubts itself: converters' supply".to_owned(),
            ),
            (
                EventCause::LearnRefused,
                [25, 0],
                "learning refused: unbalanced currents".to_owned(),
            ),
            (
                EventCause::UpdateReverted,
                [0x0102_0003, 0xABC],
                "program brought back: version 1.2.3, program 00000abc".to_owned(),
            ),
            (
                EventCause::UpdateRefused,
                [5, 0],
                "program refused: not signed with this board's key".to_owned(),
            ),
            (EventCause::FaultOff, [0, 0], "FAULT off".to_owned()),
        ] {
            assert_eq!(told(cause, values), expected);
        }
    }

    #[test]
    fn repetitions_are_told_and_numbers_from_elsewhere_do_no_harm() {
        assert!(example(1).to_string().ends_with(" (3 times)"));
        for cause in EventCause::ALL {
            let told = told(cause, [u32::MAX, u32::MAX]);
            assert!(told.starts_with(cause.label()), "{told}");
        }
    }
}
