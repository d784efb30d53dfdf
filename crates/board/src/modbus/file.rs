//! Functions 20 and 21: event log, seconds and the samples around an alarm as files of records to be read, a program as one to
//! be written. The protocol counts words of 16 bits.

use update::{NotLaid, PIECE_BYTES, Tray};

use super::answer::Answer;
use super::exception::Exception;
use super::memory::{File, Files};
use crate::events::{EVENT_BYTES, LOG_EVENTS};
use crate::frames::capture::CAPTURE_BYTES;
use crate::seconds::{SECOND_BYTES, SECONDS};

/// Number of the file that is the event log. Its words are the bytes of flash, in their order.
pub const EVENT_FILE: u16 = 1;
/// Number of the file that is the ring of seconds.
pub const SECONDS_FILE: u16 = 2;
/// Number of the file that holds the samples around an alarm.
pub const CAPTURE_FILE: u16 = 3;
/// Number of the file that takes the first 128 KiB of a program: a record's number has 16 bits.
pub const PROGRAM_FILE: u16 = 4;
/// Number of the file that takes the rest.
pub const PROGRAM_REST_FILE: u16 = 5;
/// Words of a program in one request at most.
pub const MOST_PROGRAM_WORDS: u16 = PIECE_BYTES as u16 / 2;
/// Words of a file at most.
const MOST_RECORDS: u32 = 1 << 16;
/// Words of one answer at most: six seconds, or seven events.
pub const MOST_FILE_WORDS: u16 = 6 * SECOND_BYTES as u16 / 2;
const EVENT_WORDS: u32 = LOG_EVENTS * EVENT_BYTES as u32 / 2;
const SECOND_WORDS: u32 = SECONDS * SECOND_BYTES as u32 / 2;
const CAPTURE_WORDS: u32 = CAPTURE_BYTES as u32 / 2;
/// The only type of reference that the protocol knows.
const REFERENCE: u8 = 6;
/// Bytes of one reference in a request.
const GROUP_BYTES: usize = 7;

/// Answers a request for parts of files.
pub(super) fn read(
    data: &[u8],
    files: Files<'_>,
    answer: &mut Answer<'_>,
) -> Result<(), Exception> {
    let [bytes, groups @ ..] = data else {
        return Err(Exception::Value);
    };
    let (parts, rest) = groups.as_chunks::<GROUP_BYTES>();
    if usize::from(*bytes) != groups.len() || parts.is_empty() || !rest.is_empty() {
        return Err(Exception::Value);
    }
    let at = answer.length();
    answer.push(0);
    for part in parts {
        read_part(part, files, answer)?;
    }
    answer.set(at, (answer.length() - at - 1) as u8);
    Ok(())
}

fn read_part(
    part: &[u8; GROUP_BYTES],
    files: Files<'_>,
    answer: &mut Answer<'_>,
) -> Result<(), Exception> {
    let [reference, file @ .., a, b, c, d] = part;
    let (first, words) = (u16::from_be_bytes([*a, *b]), u16::from_be_bytes([*c, *d]));
    let (source, length) = file_of(u16::from_be_bytes(*file), files).ok_or(Exception::Address)?;
    let inside = u32::from(first) + u32::from(words) <= length;
    if *reference != REFERENCE || !inside {
        return Err(Exception::Address);
    }
    if words == 0 || words > MOST_FILE_WORDS || answer.room() < 2 + 2 * usize::from(words) {
        return Err(Exception::Value);
    }
    answer.push(1 + 2 * words as u8);
    answer.push(REFERENCE);
    for word in first..first + words {
        let mut two = [0; 2];
        if !source.read(2 * usize::from(word), &mut two) {
            return Err(Exception::Busy);
        }
        answer.push_all(&two);
    }
    Ok(())
}

/// A piece of a program, and where it goes.
pub(super) struct Piece<'a> {
    offset: u32,
    bytes: &'a [u8],
}

impl<'a> Piece<'a> {
    /// From a request to write one part of one of the program's files.
    pub fn of_request(data: &'a [u8]) -> Result<Self, Exception> {
        let [bytes, group @ ..] = data else {
            return Err(Exception::Value);
        };
        let [reference, file @ .., a, b, c, d] =
            group.first_chunk::<GROUP_BYTES>().ok_or(Exception::Value)?;
        let (first, words) = (u16::from_be_bytes([*a, *b]), u16::from_be_bytes([*c, *d]));
        let file = u16::from_be_bytes(*file);
        let inside = u32::from(first) + u32::from(words) <= MOST_RECORDS;
        if *reference != REFERENCE || !(PROGRAM_FILE..=PROGRAM_REST_FILE).contains(&file) || !inside
        {
            return Err(Exception::Address);
        }
        let piece = group.get(GROUP_BYTES..).unwrap_or_default();
        let whole = usize::from(*bytes) == group.len() && piece.len() == 2 * usize::from(words);
        if !whole || words == 0 || words > MOST_PROGRAM_WORDS {
            return Err(Exception::Value);
        }
        let before = u32::from(file - PROGRAM_FILE) * MOST_RECORDS;
        Ok(Piece {
            offset: 2 * (before + u32::from(first)),
            bytes: piece,
        })
    }

    /// Whether a transfer begins with it.
    pub fn is_first(&self) -> bool {
        self.offset == 0
    }

    /// Lays it down for the task that owns flash.
    pub fn lay(&self, tray: &mut Tray) -> Result<(), Exception> {
        tray.lay(self.offset, self.bytes).map_err(|why| match why {
            NotLaid::Busy => Exception::Busy,
            NotLaid::Gap => Exception::Address,
            NotLaid::Shape => Exception::Value,
            NotLaid::Failed => Exception::Failure,
        })
    }
}

/// A file, and how many words it has.
fn file_of(number: u16, files: Files<'_>) -> Option<(&dyn File, u32)> {
    match number {
        EVENT_FILE => Some((files.events, EVENT_WORDS)),
        SECONDS_FILE => Some((files.seconds, SECOND_WORDS)),
        CAPTURE_FILE => Some((files.capture, CAPTURE_WORDS)),
        _ => None,
    }
}
