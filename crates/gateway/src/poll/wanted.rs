//! Which alarms of a motor wait for their recording.

use board::CaptureHead;
use fleet::alarm::{Alarm, AlarmCause};
use fleet::{Second, lamp};

/// A board is looked at so often after the gateway began: alarms that follow from what was stored last are a moment behind.
const LOOKS: u32 = 3;
/// Between the second in which FAULT lights and the one that shows it, at most.
pub(super) const APART_S: u32 = 2;

/// An alarm that has neither a recording nor a reason why it has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Wanted {
    pub start: u32,
    /// `None`: some second of that run, which an event told.
    pub second: Option<u32>,
    pub time_ms: i64,
}

impl Wanted {
    /// Whether a recording of this second is its own.
    pub fn is(&self, start: u32, second: u32) -> bool {
        let fits = |own: u32| own.abs_diff(second) <= APART_S;
        self.start == start && self.second.is_none_or(fits)
    }

    /// Whether it rose before a moment of the same run.
    pub fn is_before(&self, moment: Option<(u32, u32)>) -> bool {
        let own = self.second.map(|second| (self.start, second));
        own.zip(moment)
            .is_some_and(|((run, second), (start, end))| run == start && second <= end)
    }
}

/// A recording that is being fetched.
#[derive(Debug)]
pub(super) struct UnderWay {
    pub head: CaptureHead,
    pub instants: Vec<u8>,
}

/// What a link knows of the recordings of a motor.
#[derive(Debug, Default)]
pub(super) struct Recordings {
    /// How often the board was found with nothing to be fetched or released, since the gateway began.
    pub settled: u32,
    was_lit: bool,
    pub wanted: Vec<Wanted>,
    pub under_way: Option<UnderWay>,
    /// Run and second in which a recording was released last.
    pub released: Option<(u32, u32)>,
}

impl Recordings {
    /// Goes on behind the second that is stored.
    pub fn of_stored(last: Option<&Second>) -> Self {
        Recordings {
            was_lit: last.is_some_and(|second| second.is_on(lamp::FAULT)),
            ..Recordings::default()
        }
    }

    /// Whether the board need not be asked until its next alarm.
    pub fn is_settled(&self) -> bool {
        self.settled >= LOOKS
    }

    /// Takes a second: where FAULT lights in it there is a recording to be fetched.
    pub fn look(&mut self, second: &Second) {
        let is_lit = second.is_on(lamp::FAULT);
        if is_lit && !self.was_lit {
            self.wanted.push(Wanted {
                start: second.start,
                second: Some(second.number),
                time_ms: second.time_ms,
            });
        }
        self.was_lit = is_lit;
    }

    /// Alarms that the store has without a recording: those of before the gateway began.
    pub fn recall(&mut self, alarms: &[Alarm], start: u32) {
        let open = alarms.iter().filter(|alarm| {
            let evidence = &alarm.evidence;
            let none = evidence.recording.is_none() && evidence.no_recording.is_none();
            alarm.cause == AlarmCause::Fault && none
        });
        for alarm in open {
            let time_ms = alarm.raised_ms;
            let this_run = alarm.evidence.event.is_some_and(|event| event >= start);
            let (start, second) = match alarm.evidence.second {
                Some((start, second)) => (start, Some(second)),
                None if this_run => (start, None),
                None => (0, None),
            };
            let new = Wanted {
                start,
                second,
                time_ms,
            };
            // Of one motor one alarm of a fault is open.
            if self.wanted.is_empty() {
                self.wanted.push(new);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn second(number: u32, is_lit: bool) -> Second {
        Second {
            start: 7,
            number,
            time_ms: 1_000 * i64::from(number),
            lamps: u32::from(is_lit) << (2 * lamp::FAULT),
            ..Second::default()
        }
    }

    #[test]
    fn a_recording_is_wanted_where_fault_lights() {
        let mut recordings = Recordings::of_stored(Some(&second(1, true)));
        for (number, is_lit) in [(2, true), (3, false), (4, true), (5, true)] {
            recordings.look(&second(number, is_lit));
        }
        let wanted: Vec<_> = recordings.wanted.iter().map(|w| w.second).collect();
        assert_eq!(wanted, [Some(4)]);
    }

    #[test]
    fn alarms_of_before_the_gateway_began_are_wanted_once() {
        let alarm = |number, of_second, event, reason: Option<&str>| Alarm {
            number,
            motor: None,
            cause: AlarmCause::Fault,
            state: fleet::alarm::AlarmState::Unacknowledged,
            present: true,
            acknowledged: false,
            suppressed: false,
            severity: fleet::alarm::Severity::High,
            fault: 0,
            size: None,
            evidence: fleet::alarm::Evidence {
                second: of_second,
                event,
                no_recording: reason.map(str::to_owned),
                ..fleet::alarm::Evidence::default()
            },
            raised_ms: 90_000,
            changed_ms: 0,
            times: 1,
            shelved_until_ms: None,
        };
        let cases = [
            (alarm(1, Some((7, 40)), None, None), Some((7, Some(40)))),
            (alarm(2, None, Some(9), None), Some((7, None))),
            (alarm(3, None, Some(3), None), Some((0, None))),
            (alarm(4, Some((7, 50)), None, Some("no")), None),
        ];
        for (alarm, expected) in cases {
            let mut recordings = Recordings::default();
            (0..2).for_each(|_| recordings.recall(std::slice::from_ref(&alarm), 7));
            let mut wanted = recordings.wanted.iter();
            let first = wanted.next().map(|wanted| (wanted.start, wanted.second));
            assert_eq!((first, wanted.next()), (expected, None));
        }
    }
}
