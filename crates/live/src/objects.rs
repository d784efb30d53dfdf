//! What a board tells beside registers: who it is, and its event log.

use board::modbus::{EVENT_FILE, MOST_FILE_WORDS};
use board::{EVENT_BYTES, Event, LOG_EVENTS, place_of};

use crate::modbus::{ModbusError, ModbusLine};

const IDENTIFY: u8 = 43;
/// Device identification, all objects.
const TYPE: u8 = 14;
const ALL: u8 = 3;
/// More answers than any device needs; one that repeats itself is not asked for ever.
const MOST_ANSWERS: u32 = 32;

const READ_FILE: u8 = 20;
const REFERENCE: u8 = 6;
const EVENT_WORDS: u16 = EVENT_BYTES as u16 / 2;
/// Events of one answer at most.
const PER_ANSWER: u32 = (MOST_FILE_WORDS / EVENT_WORDS) as u32;

impl ModbusLine {
    /// Number and text of each object of the device identification.
    ///
    /// # Errors
    /// No sound answer, or a refusal.
    pub fn identify(&mut self) -> Result<Vec<(u8, String)>, ModbusError> {
        let mut objects = Vec::new();
        let mut first = 0;
        for _ in 0..MOST_ANSWERS {
            let answer = self.ask(IDENTIFY, &[TYPE, ALL, first])?;
            let [TYPE, _, _, follows, next, count, rest @ ..] = &answer[..] else {
                return Err(self.damaged());
            };
            take_objects(rest, *count, &mut objects).ok_or_else(|| self.damaged())?;
            match follows {
                0 => return Ok(objects),
                _ => first = *next,
            }
        }
        Err(self.damaged())
    }

    /// The events numbered `first` to `last`, those that are still there, oldest first. `progress` hears how many were asked
    /// for.
    ///
    /// # Errors
    /// No sound answer, or a refusal.
    pub fn events(
        &mut self,
        first: u32,
        last: u32,
        mut progress: impl FnMut(u64),
    ) -> Result<Vec<Event>, ModbusError> {
        let mut events = Vec::new();
        let mut number = first.max(1);
        while number <= last {
            let place = place_of(number);
            // A request does not go round the end of the ring.
            let count = PER_ANSWER.min(last - number + 1).min(LOG_EVENTS - place);
            let bytes = self.read_events(place, count)?;
            let (records, _) = bytes.as_chunks::<EVENT_BYTES>();
            let numbered = (number..).zip(records);
            events.extend(numbered.filter_map(|(number, record)| {
                Event::from_bytes(record).filter(|event| event.number == number)
            }));
            number += count;
            progress(u64::from(count));
        }
        Ok(events)
    }

    fn read_events(&mut self, place: u32, count: u32) -> Result<Vec<u8>, ModbusError> {
        let words = count as u16 * EVENT_WORDS;
        let [[a, b], [c, d], [e, f]] =
            [EVENT_FILE, place as u16 * EVENT_WORDS, words].map(u16::to_be_bytes);
        let answer = self.ask(READ_FILE, &[7, REFERENCE, a, b, c, d, e, f])?;
        match &answer[..] {
            [_, _, REFERENCE, bytes @ ..] if bytes.len() == 2 * usize::from(words) => {
                Ok(bytes.to_vec())
            }
            _ => Err(self.damaged()),
        }
    }
}

/// `None` where the bytes do not hold as many objects.
fn take_objects(mut bytes: &[u8], count: u8, objects: &mut Vec<(u8, String)>) -> Option<()> {
    for _ in 0..count {
        let [number, length, rest @ ..] = bytes else {
            return None;
        };
        let (text, tail) = rest.split_at_checked(usize::from(*length))?;
        objects.push((*number, String::from_utf8_lossy(text).into_owned()));
        bytes = tail;
    }
    Some(())
}
