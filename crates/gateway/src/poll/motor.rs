//! What a link knows of a motor, and what follows from a board's newest numbers.

use std::time::{Duration, Instant};

use board::{Event, EventCause, LOG_EVENTS, SECONDS};
use fleet::{Entry, Gap, GapOf, MotorId};

use super::clock::Clock;
use super::wanted::Recordings;
use crate::config::MotorConfig;
use crate::wire::question::Head;

/// Last number of a gap whose length nobody knows: what a board had not handed on when it lost its power.
pub(super) const UNKNOWN: u32 = u32::MAX;

/// A motor and the board that watches it.
#[derive(Debug)]
pub(super) struct Watched {
    pub id: MotorId,
    pub unit: u8,
    /// Serial number of the board that must answer.
    pub expected: Option<String>,
    /// Which event log of the board.
    pub log: u32,
    /// Newest second that is stored or on its way: run and number.
    pub second: Option<(u32, u32)>,
    /// Newest event that is stored or on its way; 0: none.
    pub event: u32,
    /// The board that answered last, as it is stored.
    pub identity: Option<String>,
    /// The run that the board is in, and when that was.
    pub run: Option<u32>,
    pub clock: Clock,
    /// The run before, and when it was.
    pub before: Option<(u32, Clock)>,
    pub recordings: Recordings,
    pub health: Health,
}

impl Watched {
    /// Nothing is known of the board yet.
    pub fn new(config: &MotorConfig) -> Self {
        Watched {
            id: config.info.id.clone(),
            unit: config.unit,
            expected: config.serial.clone(),
            log: config.log,
            second: None,
            event: 0,
            identity: None,
            run: None,
            clock: Clock::default(),
            before: None,
            recordings: Recordings::default(),
            health: Health::new(),
        }
    }

    /// The board as it is stored, or why it is not the one that is expected.
    pub fn identity_of(&self, head: &Head) -> Result<String, String> {
        let [a, b, c] = head.serial;
        let serial = format!("{a:08x}{b:08x}{c:08x}");
        if let Some(expected) = self.expected.as_ref().filter(|other| **other != serial) {
            return Err(format!(
                "another board answers at unit {}: serial number {serial}, the configuration says {expected}; nothing of it is stored. Correct `unit`, or `serial` where the board was exchanged",
                self.unit
            ));
        }
        Ok(match self.log {
            1 => serial,
            log => format!("{serial} log {log}"),
        })
    }

    /// The board is in this run of its program.
    pub fn enter(&mut self, start: u32) {
        if self.run != Some(start) {
            self.before = self.run.map(|run| (run, self.clock));
            self.clock = Clock::default();
            self.run = Some(start);
        }
    }

    /// Runs that ended unseen, as far as the events of their starts tell: what they had not handed on is lost.
    pub fn passed_runs<'a>(
        &mut self,
        head: &Head,
        events: impl Iterator<Item = &'a Event>,
    ) -> Vec<(GapOf, u32, u32)> {
        let Some((start, number)) = self.second.filter(|(start, _)| *start < head.start) else {
            return Vec::new();
        };
        let mut lost = Vec::new();
        if number != UNKNOWN {
            lost.push((GapOf::Seconds { start }, number.saturating_add(1), UNKNOWN));
        }
        let passed = starts(events).filter(|run| (start + 1..head.start).contains(run));
        lost.extend(passed.map(|start| (GapOf::Seconds { start }, 1, UNKNOWN)));
        if let Some((GapOf::Seconds { start }, ..)) = lost.last() {
            self.second = Some((*start, UNKNOWN));
        }
        lost
    }

    /// Why a board's numbers cannot follow those that are stored.
    pub fn contradiction(&self, head: &Head) -> Option<String> {
        let other_run = self.second.is_some_and(|(start, _)| head.start < start);
        let other_second = self.second.is_some_and(|(start, number)| {
            start == head.start && number != UNKNOWN && head.last_second < number
        });
        if other_run || head.last_event < self.event {
            let next = self.log + 1;
            return Some(format!(
                "the numbers of its event log went back: was the log erased? Write log = {next} for this motor, and it is read as a new one"
            ));
        }
        other_second.then(|| {
            "its seconds went back without an event of a start: it lost its power before it could write one; they are read again once they have caught up".to_owned()
        })
    }
}

/// The runs that events tell of: a run has the number of its first event, which is that of a crash where one ended the run
/// before it.
fn starts<'a>(events: impl Iterator<Item = &'a Event>) -> impl Iterator<Item = u32> {
    let mut crash = None;
    events.filter_map(move |event| {
        let number = event.number;
        match event.cause {
            EventCause::Crash => {
                crash = Some(number);
                None
            }
            EventCause::Start => Some(match crash.take() {
                Some(before) if before + 1 == number => before,
                _ => number,
            }),
            _ => None,
        }
    })
}

/// Numbers to ask for, and those that are lost already.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Wanted {
    pub lost: Vec<(GapOf, u32, u32)>,
    pub from: u32,
    pub to: u32,
}

impl Wanted {
    /// The gaps as entries.
    pub fn gaps(&self, time_ms: i64) -> Vec<Entry> {
        let gap = |&(what, first, last)| gap(what, first, last, time_ms);
        self.lost.iter().map(gap).collect()
    }
}

/// A gap as an entry.
pub(super) fn gap(what: GapOf, first: u32, last: u32, time_ms: i64) -> Entry {
    Entry::Gap(Gap {
        what,
        first,
        last,
        time_ms,
    })
}

/// The seconds behind `known` that the ring still has.
pub(super) fn seconds(known: Option<(u32, u32)>, head: &Head) -> Wanted {
    let to = head.last_second;
    let oldest = to.saturating_sub(SECONDS - 1).max(1);
    let what = GapOf::Seconds { start: head.start };
    let mut lost = Vec::new();
    let from = match known {
        // What was before the first contact was never promised.
        None => oldest,
        Some((start, number)) if start == head.start => number.saturating_add(1),
        Some((start, number)) => {
            if number != UNKNOWN {
                let before = GapOf::Seconds { start };
                lost.push((before, number.saturating_add(1), UNKNOWN));
            }
            1
        }
    };
    if from < oldest {
        lost.push((what, from, oldest - 1));
    }
    Wanted {
        lost,
        from: from.max(oldest),
        to,
    }
}

/// The events behind `known` that the log still has.
pub(super) fn events(known: u32, head: &Head) -> Wanted {
    let to = head.last_event;
    let oldest = to.saturating_sub(LOG_EVENTS - 1).max(1);
    let from = known.saturating_add(1);
    let lost = match known > 0 && from < oldest {
        true => vec![(GapOf::Events, from, oldest - 1)],
        false => Vec::new(),
    };
    Wanted {
        lost,
        from: from.max(oldest),
        to,
    }
}

/// Whether a motor answers, and when it is asked next.
#[derive(Debug)]
pub(super) struct Health {
    up: Option<bool>,
    /// When it answered last, or when the gateway began.
    answered: Instant,
    failures: u32,
    next: Instant,
}

impl Health {
    fn new() -> Self {
        let now = Instant::now();
        Health {
            up: None,
            answered: now,
            failures: 0,
            next: now,
        }
    }

    /// Whether it is its turn.
    pub fn is_due(&self, now: Instant) -> bool {
        now >= self.next
    }

    /// Whether it counts as answering.
    pub fn is_up(&self) -> bool {
        self.up == Some(true)
    }

    /// It answered; `true` where that is news.
    pub fn answered(&mut self, now: Instant) -> bool {
        (self.answered, self.failures, self.next) = (now, 0, now);
        self.up.replace(true) != Some(true)
    }

    /// It was not its fault: it is asked in the next round.
    pub fn ask_again(&mut self) {
        self.next = Instant::now();
        self.failures = 0;
    }

    /// It did not; `true` where it counts as lost from now on.
    pub fn failed(&mut self, now: Instant, lost_after: Duration, retry_most: Duration) -> bool {
        let pause = Duration::from_secs(1 << self.failures.min(16));
        self.failures = self.failures.saturating_add(1);
        self.next = now + pause.min(retry_most);
        let lost = now.duration_since(self.answered) >= lost_after;
        lost && self.up.replace(false) != Some(false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(start: u32, last_second: u32, last_event: u32) -> Head {
        Head {
            serial: [1, 2, 3],
            start,
            last_second,
            last_event,
        }
    }

    #[test]
    fn seconds_go_on_behind_the_last_one() {
        let wanted = seconds(Some((7, 40)), &head(7, 45, 9));
        assert_eq!((wanted.lost.len(), wanted.from, wanted.to), (0, 41, 45));
        let nothing = seconds(Some((7, 45)), &head(7, 45, 9));
        assert!(nothing.lost.is_empty() && nothing.from > nothing.to);
    }

    #[test]
    fn who_was_away_too_long_is_told_which_are_lost() {
        let wanted = seconds(Some((7, 40)), &head(7, 400, 9));
        let what = GapOf::Seconds { start: 7 };
        assert_eq!(wanted.lost, [(what, 41, 280)]);
        assert_eq!((wanted.from, wanted.to), (281, 400));
        let wanted = events(3, &head(7, 400, 600));
        assert_eq!(wanted.lost, [(GapOf::Events, 4, 88)]);
        assert_eq!((wanted.from, wanted.to), (89, 600));
    }

    #[test]
    fn a_new_run_leaves_a_gap_of_unknown_length_once() {
        let wanted = seconds(Some((7, 40)), &head(9, 200, 9));
        let [old, new] = [7, 9].map(|start| GapOf::Seconds { start });
        assert_eq!(wanted.lost, [(old, 41, UNKNOWN), (new, 1, 80)]);
        assert_eq!((wanted.from, wanted.to), (81, 200));
        let again = seconds(Some((7, UNKNOWN)), &head(9, 0, 9));
        assert_eq!((again.lost.len(), again.from, again.to), (0, 1, 0));
    }

    #[test]
    fn runs_that_nobody_saw_are_known_from_the_log() {
        let event = |number, cause| Event {
            number,
            cause,
            uptime_s: 0,
            times: 1,
            values: [0; 2],
        };
        use EventCause::{Crash, FaultOn, Start};
        let causes = [FaultOn, Start, Crash, Start, FaultOn, Start];
        let events: Vec<_> = (8..)
            .zip(causes)
            .map(|(n, cause)| event(n, cause))
            .collect();
        let passed = |second| {
            let mut motor = Watched {
                second,
                ..Watched::new(&some())
            };
            let lost = motor.passed_runs(&head(13, 5, 13), events.iter());
            let lost = lost.into_iter().map(|(what, first, _)| match what {
                GapOf::Seconds { start } => (start, first),
                _ => panic!("of seconds"),
            });
            (lost.collect::<Vec<_>>(), motor.second)
        };
        // Run 9 passed unseen, and run 10, which began with a crash; run 13 is there.
        assert_eq!(
            passed(Some((7, 40))),
            (vec![(7, 41), (9, 1), (10, 1)], Some((10, UNKNOWN)))
        );
        assert_eq!(
            passed(Some((9, 4))),
            (vec![(9, 5), (10, 1)], Some((10, UNKNOWN)))
        );
        assert_eq!(passed(None), (vec![], None));
        assert_eq!(passed(Some((13, 2))), (vec![], Some((13, 2))));
    }

    fn some() -> MotorConfig {
        MotorConfig {
            info: fleet::MotorInfo::new("m".parse().expect("a name")),
            link: 0,
            unit: 1,
            serial: None,
            log: 1,
        }
    }

    #[test]
    fn nothing_is_missed_before_the_first_contact() {
        let wanted = seconds(None, &head(9, 200, 9));
        assert_eq!((wanted.lost.len(), wanted.from), (0, 81));
        assert_eq!(events(0, &head(9, 200, 600)).from, 89);
        assert_eq!(events(0, &head(9, 200, 0)).lost, []);
    }

    #[test]
    fn silence_is_told_once_and_asked_into_ever_more_rarely() {
        let (lost_after, most) = (Duration::from_secs(10), Duration::from_secs(30));
        let mut health = Health::new();
        let begin = health.answered;
        let told: Vec<u64> = (0..100)
            .filter(|s| {
                let now = begin + Duration::from_secs(*s);
                health.is_due(now) && health.failed(now, lost_after, most)
            })
            .collect();
        // Asked at 0, 1, 3, 7, 15 s.
        assert_eq!(told, [15]);
        assert!(!health.is_due(begin + Duration::from_secs(100)));
        assert!(health.is_due(begin + Duration::from_secs(122)));
        assert!(health.answered(begin + Duration::from_secs(122)));
        assert!(!health.answered(begin + Duration::from_secs(123)));
    }
}
