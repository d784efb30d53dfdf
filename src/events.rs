//! The way of an event to flash: noted when something changes, written between two blocks that have time for it.

use board::{Appended, EventCause, Journal, Situation};
use embassy_time::Instant;

use crate::hardware::flash_store::FlashLog;
use crate::hardware::sampling::Gap;
use crate::safety::{self, Start};

/// What waits, and where it goes.
pub struct Events {
    journal: Journal,
    log: Option<FlashLog>,
}

impl Events {
    /// Begins with the start and with what led to it.
    pub fn new(log: Option<FlashLog>, start: &Start) -> Self {
        let mut journal = Journal::default();
        let (_, checksum) = safety::program().unwrap_or_default();
        if let Some(crash) = start.crash {
            journal.note(EventCause::Crash, [crash.cause as u32, crash.pc]);
        }
        journal.note(EventCause::Start, [start.cause as u32, checksum]);
        Events { journal, log }
    }

    /// Something happened.
    pub fn note(&mut self, cause: EventCause, value: u32) {
        self.journal.note(cause, [value, 0]);
    }

    /// Something happened, with both of its values.
    pub fn note_values(&mut self, cause: EventCause, values: [u32; 2]) {
        self.journal.note(cause, values);
    }

    /// Samples were missing.
    pub fn note_gap(&mut self, gap: Gap) {
        let number = match gap {
            Gap::Stalled => 1,
            Gap::Overrun => 2,
            Gap::Misaligned => 3,
        };
        self.note(EventCause::SamplesMissing, number);
    }

    /// Notes what has changed, and writes one event if there is one and time for it: four double words take 0.4 ms. Whether
    /// there is time left.
    #[inline(never)]
    pub fn step(&mut self, now: &Situation, has_time: bool) -> bool {
        self.journal.look(now);
        if !has_time || !self.journal.is_waiting() {
            return has_time;
        }
        let now_s = Instant::now().as_secs() as u32;
        let Some(event) = self.journal.due(now_s) else {
            return true;
        };
        match self.log.as_mut().map(|log| log.append(&event)) {
            Some(Appended::Wait) => return true,
            Some(Appended::Written) => self.journal.settle(event.cause, now_s),
            Some(Appended::Lost) | None => {
                defmt::warn!("event lost: {=str}", event.cause.label());
                self.journal.settle(event.cause, now_s);
            }
        }
        false
    }

    /// Number of the newest event in flash.
    pub fn newest(&self) -> u32 {
        self.log.as_ref().map_or(0, FlashLog::newest)
    }
}
