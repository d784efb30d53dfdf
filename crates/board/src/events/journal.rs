//! What is worth an event, and when it is written.

use super::cause::{CAUSES, EventCause};
use super::event::Event;
use crate::learn::LearnState;

/// Between two events of one cause, s.
const PAUSE_S: u32 = 60;

/// What the journal looks at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Situation {
    /// FAULT is lit.
    pub fault: bool,
    /// Number and probability in per mille of the likeliest fault.
    pub likely: (u16, u16),
    /// SENSOR is lit.
    pub sensor: bool,
    /// Number of the reason why nothing was judged.
    pub not_judged: u16,
    /// What the board doubts about itself: bits of [`Doubts`](crate::Doubts).
    pub doubts: u32,
    /// How learning stands.
    pub learning: LearnState,
    /// Identification of the calibration that is used; 0 where there is none.
    pub calibration: u32,
}

/// Something that waits to be written.
#[derive(Clone, Copy, Debug)]
struct Pending {
    since_s: Option<u32>,
    times: u16,
    values: [u32; 2],
}

/// Events that wait, and when each cause was written last.
#[derive(Clone, Debug, Default)]
pub struct Journal {
    pending: [Option<Pending>; CAUSES],
    written_s: [Option<u32>; CAUSES],
    seen: Situation,
    waiting: bool,
}

impl Journal {
    /// Notes that something happened.
    pub fn note(&mut self, cause: EventCause, values: [u32; 2]) {
        let Some(pending) = self.pending.get_mut(cause.index()) else {
            return;
        };
        *pending = Some(match *pending {
            None => Pending {
                since_s: None,
                times: 1,
                values,
            },
            Some(before) => Pending {
                times: before.times.saturating_add(1),
                values: cause.merged(before.values, values),
                ..before
            },
        });
        self.waiting = true;
    }

    /// Notes what is different from the last look.
    pub fn look(&mut self, now: &Situation) {
        if *now == self.seen {
            return;
        }
        let before = core::mem::replace(&mut self.seen, *now);
        self.look_at_lamps(&before, now);
        let new = now.doubts & !before.doubts;
        if new != 0 {
            self.note(EventCause::Doubt, [new, now.doubts]);
        }
        if now.learning != before.learning {
            self.note_learning(now);
        }
    }

    fn look_at_lamps(&mut self, before: &Situation, now: &Situation) {
        let (fault, probability) = now.likely;
        match (before.fault, now.fault) {
            (false, true) => {
                let values = [u32::from(fault), u32::from(probability)];
                self.note(EventCause::FaultOn, values);
            }
            (true, false) => self.note(EventCause::FaultOff, [0; 2]),
            _ => {}
        }
        match (before.sensor, now.sensor) {
            (false, true) => {
                let values = [u32::from(now.not_judged), now.doubts];
                self.note(EventCause::SensorOn, values);
            }
            (true, false) => self.note(EventCause::SensorOff, [0; 2]),
            _ => {}
        }
    }

    fn note_learning(&mut self, now: &Situation) {
        match now.learning {
            LearnState::Idle => {}
            LearnState::Learning => self.note(EventCause::LearnBegun, [0; 2]),
            LearnState::Stored => self.note(EventCause::Learnt, [now.calibration, 0]),
            LearnState::Refused(_) => {
                let values = [u32::from(now.learning.code()), now.doubts];
                self.note(EventCause::LearnRefused, values);
            }
        }
    }

    /// Whether anything waits.
    pub fn is_waiting(&self) -> bool {
        self.waiting
    }

    /// The event that has waited longest among those that may be written at `now_s`.
    #[inline(never)]
    pub fn due(&mut self, now_s: u32) -> Option<Event> {
        let mut best: Option<Event> = None;
        let slots = self.pending.iter_mut().zip(&self.written_s);
        for (cause, (pending, written)) in EventCause::ALL.into_iter().zip(slots) {
            let Some(pending) = pending else {
                continue;
            };
            let uptime_s = *pending.since_s.get_or_insert(now_s);
            let rested = written.is_none_or(|at| now_s.wrapping_sub(at) >= PAUSE_S);
            if rested && best.is_none_or(|other| uptime_s < other.uptime_s) {
                best = Some(Event {
                    number: 0,
                    uptime_s,
                    cause,
                    times: pending.times,
                    values: pending.values,
                });
            }
        }
        best
    }

    /// An event of this cause was written at `now_s`, or is lost.
    pub fn settle(&mut self, cause: EventCause, now_s: u32) {
        let index = cause.index();
        if let Some(pending) = self.pending.get_mut(index) {
            *pending = None;
        }
        if let Some(written) = self.written_s.get_mut(index) {
            *written = Some(now_s);
        }
        self.waiting = self.pending.iter().any(Option::is_some);
    }
}

#[cfg(test)]
mod tests;
