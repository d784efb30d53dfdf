//! The ring in flash. Events are appended; the page that the ring enters is erased before, in the background.

use update::BackgroundFlash;

use super::event::{EVENT_BYTES, Event};
use crate::calibration::PAGE_BYTES;

/// Pages of the ring.
pub const LOG_PAGES: u32 = 8;
const PER_PAGE: u32 = PAGE_BYTES / EVENT_BYTES as u32;
/// Events that the ring holds at most; entering a page forgets its 64.
pub const LOG_EVENTS: u32 = LOG_PAGES * PER_PAGE;
/// Events in a row that could not be written, after which nothing more is tried: a defective page is not worn down.
const MOST_FAILURES: u32 = 3;

/// Place of the event with this number in the ring, from 0.
pub fn place_of(number: u32) -> u32 {
    number.wrapping_sub(1) % LOG_EVENTS
}

/// What became of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Appended {
    /// It lies in flash.
    Written,
    /// Not yet: a page is being erased, or the supply is low.
    Wait,
    /// It is lost: flash refused it.
    Lost,
}

/// The log in a flash from byte `first` on, a page's beginning.
pub struct EventLog<F> {
    flash: F,
    first: u32,
    newest: u32,
    /// The page that was erased for the next event.
    erased: Option<u32>,
    failures: u32,
}

impl<F: BackgroundFlash> EventLog<F> {
    /// Looks for the newest event.
    #[inline(never)]
    pub fn open(flash: F, first: u32) -> Self {
        let mut log = EventLog {
            flash,
            first,
            newest: 0,
            erased: None,
            failures: 0,
        };
        for place in 0..LOG_EVENTS {
            let event = log.read(place).and_then(|bytes| Event::from_bytes(&bytes));
            let number = event.map_or(0, |event| event.number);
            if place_of(number) == place {
                log.newest = log.newest.max(number);
            }
        }
        log
    }

    /// Number of the newest event; 0 where there is none.
    pub fn newest(&self) -> u32 {
        self.newest
    }

    /// Whether flash can be read now.
    pub fn is_ready(&mut self) -> bool {
        self.flash.is_ready()
    }

    /// Writes an event behind the newest one; its number is given here.
    #[inline(never)]
    pub fn append(&mut self, event: &Event) -> Appended {
        if self.failures >= MOST_FAILURES {
            return Appended::Lost;
        }
        if !self.flash.is_ready() {
            return Appended::Wait;
        }
        match self.next() {
            Some(Next::Free(number)) => self.write(&Event { number, ..*event }),
            Some(Next::Erase(page)) if self.erased != Some(page) => {
                self.erased = Some(page);
                self.flash.begin_erase(self.first + page * PAGE_BYTES);
                Appended::Wait
            }
            _ => self.fail(),
        }
    }

    fn write(&mut self, event: &Event) -> Appended {
        let (place, bytes) = (place_of(event.number), event.to_bytes());
        self.newest = event.number;
        self.erased = None;
        let written = self.flash.write(self.address(place), &bytes).is_ok();
        if !written || self.read(place) != Some(bytes) {
            return self.fail();
        }
        self.failures = 0;
        Appended::Written
    }

    fn fail(&mut self) -> Appended {
        self.failures += 1;
        Appended::Lost
    }

    /// Where the next event goes: places that a power failure left half-written are passed over.
    fn next(&mut self) -> Option<Next> {
        (1..=LOG_EVENTS).find_map(|ahead| {
            let number = self.newest.checked_add(ahead)?;
            let (place, page) = (place_of(number), place_of(number) / PER_PAGE);
            let enters = place.is_multiple_of(PER_PAGE);
            if enters && !(0..PER_PAGE).all(|k| self.is_blank(place + k)) {
                return Some(Next::Erase(page));
            }
            self.is_blank(place).then_some(Next::Free(number))
        })
    }

    fn is_blank(&mut self, place: u32) -> bool {
        let blank = |bytes: [u8; EVENT_BYTES]| bytes.iter().all(|byte| *byte == 0xFF);
        self.read(place).is_some_and(blank)
    }

    fn read(&mut self, place: u32) -> Option<[u8; EVENT_BYTES]> {
        let mut bytes = [0; EVENT_BYTES];
        self.flash.read(self.address(place), &mut bytes).ok()?;
        Some(bytes)
    }

    fn address(&self, place: u32) -> u32 {
        self.first + place * EVENT_BYTES as u32
    }
}

enum Next {
    Free(u32),
    Erase(u32),
}

#[cfg(test)]
mod tests;
