//! The questions that a gateway asks a board, as function and data, and what the answers say.

use board::modbus::{
    CAPTURE_FILE, Command, EVENT_FILE, Field, MOST_FILE_WORDS, SECONDS_FILE, UNLOCK_KEY, address,
};
use board::{
    CAPTURE_BYTES, CAPTURE_HEAD_BYTES, EVENT_BYTES, Event, LOG_EVENTS, SECOND_BYTES, SECONDS,
    Second, place_of, place_of_second,
};

const READ_INPUT: u8 = 4;
const READ_FILE: u8 = 20;
const WRITE_MANY: u8 = 16;
/// The only type of reference that function 20 knows.
const REFERENCE: u8 = 6;
const GROUP_BYTES: u8 = 7;
const EVENT_WORDS: u16 = EVENT_BYTES as u16 / 2;
const SECOND_WORDS: u16 = SECOND_BYTES as u16 / 2;
/// Records of one answer.
const MOST_RECORDS: u32 = 6;

/// A question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Question {
    /// Number of the function.
    pub function: u8,
    /// Its data.
    pub data: Vec<u8>,
    /// Bytes of a right answer's data.
    pub answer_bytes: usize,
}

/// What tells whether a board has something new, and who it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Head {
    /// The chip's serial number.
    pub serial: [u32; 3],
    /// Number of the newest event; 0: none.
    pub last_event: u32,
    /// Which run of the program.
    pub start: u32,
    /// Its newest second; 0: none yet.
    pub last_second: u32,
}

/// Where the head begins, and its registers: from the serial number to the newest second.
const HEAD_FROM: u16 = address(Field::SerialHigh);
const HEAD_WORDS: u16 = address(Field::LastSecond) + 2 - HEAD_FROM;

/// Asks for the head.
pub(crate) fn head() -> Question {
    registers(HEAD_FROM, HEAD_WORDS)
}

/// Reads it; `None` from an answer of another length.
pub(crate) fn head_of(answer: &[u8]) -> Option<Head> {
    let words = words_of(answer, HEAD_WORDS)?;
    let long = |field| {
        let at = usize::from(address(field) - HEAD_FROM);
        Some(u32::from(*words.get(at)?) << 16 | u32::from(*words.get(at + 1)?))
    };
    Some(Head {
        serial: [
            long(Field::SerialHigh)?,
            long(Field::SerialMiddle)?,
            long(Field::SerialLow)?,
        ],
        last_event: long(Field::LastEvent)?,
        start: long(Field::StartNumber)?,
        last_second: long(Field::LastSecond)?,
    })
}

/// Asks how long the program has been running.
pub(crate) fn uptime() -> Question {
    registers(address(Field::Uptime), 2)
}

/// Since the start, s; `None` from an answer of another length.
pub(crate) fn uptime_of(answer: &[u8]) -> Option<u32> {
    match words_of(answer, 2)?[..] {
        [high, low] => Some(u32::from(high) << 16 | u32::from(low)),
        _ => None,
    }
}

/// Asks for the events from `first` on, up to `last` at most; how many it asks for. A question does not go round the end of
/// the ring.
pub(crate) fn events(first: u32, last: u32) -> (Question, u32) {
    let place = place_of(first);
    let count = some(first, last).min(LOG_EVENTS - place);
    let question = records(EVENT_FILE, place as u16, count as u16, EVENT_WORDS);
    (question, count)
}

/// What lies in the places of the events asked for: `None` where there is no whole event.
pub(crate) fn events_of(answer: &[u8]) -> Option<Vec<Option<Event>>> {
    let (records, []) = file_of(answer)?.as_chunks::<EVENT_BYTES>() else {
        return None;
    };
    Some(records.iter().map(Event::from_bytes).collect())
}

/// Asks for the seconds from `first` on, as [`events`].
pub(crate) fn seconds(first: u32, last: u32) -> (Question, u32) {
    let place = place_of_second(first);
    let count = some(first, last).min(SECONDS - place);
    let question = records(SECONDS_FILE, place as u16, count as u16, SECOND_WORDS);
    (question, count)
}

/// What lies in the places of the seconds asked for.
pub(crate) fn seconds_of(answer: &[u8]) -> Option<Vec<Option<Second>>> {
    let (records, []) = file_of(answer)?.as_chunks::<SECOND_BYTES>() else {
        return None;
    };
    Some(records.iter().map(Second::from_bytes).collect())
}

/// Asks how far the samples around an alarm are ([`board::CaptureHead`]).
pub(crate) fn capture_head() -> Question {
    words_of_file(CAPTURE_FILE, 0, (CAPTURE_HEAD_BYTES / 2) as u16)
}

/// Asks for the samples around an alarm from byte `at` of the file on, as many as go into an answer.
pub(crate) fn capture_piece(at: usize) -> Question {
    let words = (CAPTURE_BYTES.saturating_sub(at) / 2).min(usize::from(MOST_FILE_WORDS));
    words_of_file(CAPTURE_FILE, (at / 2) as u16, words as u16)
}

/// Says that the samples around an alarm are fetched: key and command in one request.
pub(crate) fn release_capture() -> Question {
    let [key, command] = [UNLOCK_KEY, Command::ReleaseCapture as u16].map(u16::to_be_bytes);
    Question {
        function: WRITE_MANY,
        data: [&[0, 0, 0, 2, 4][..], &key, &command].concat(),
        answer_bytes: 4,
    }
}

/// How many records from `first` to `last` go into one answer.
fn some(first: u32, last: u32) -> u32 {
    last.saturating_sub(first)
        .saturating_add(1)
        .min(MOST_RECORDS)
}

fn registers(first: u16, count: u16) -> Question {
    let [[a, b], [c, d]] = [first, count].map(u16::to_be_bytes);
    Question {
        function: READ_INPUT,
        data: vec![a, b, c, d],
        answer_bytes: 1 + 2 * usize::from(count),
    }
}

fn records(file: u16, place: u16, count: u16, record_words: u16) -> Question {
    words_of_file(file, place * record_words, count * record_words)
}

fn words_of_file(file: u16, first: u16, words: u16) -> Question {
    let [[a, b], [c, d], [e, f]] = [file, first, words].map(u16::to_be_bytes);
    Question {
        function: READ_FILE,
        data: vec![GROUP_BYTES, REFERENCE, a, b, c, d, e, f],
        answer_bytes: 3 + 2 * usize::from(words),
    }
}

fn words_of(answer: &[u8], count: u16) -> Option<Vec<u16>> {
    let (pairs, rest) = answer.get(1..)?.as_chunks::<2>();
    let whole = rest.is_empty() && pairs.len() == usize::from(count);
    whole.then(|| pairs.iter().map(|pair| u16::from_be_bytes(*pair)).collect())
}

/// What an answer holds of a file.
pub(crate) fn file_of(answer: &[u8]) -> Option<&[u8]> {
    match answer {
        [_, _, REFERENCE, bytes @ ..] => Some(bytes),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_question_goes_round_the_end_of_a_ring() {
        // Second 119 lies in place 118 of 120: two records to the end.
        let (question, count) = seconds(119, 130);
        assert_eq!(count, 2);
        assert_eq!(question.data, [7, 6, 0, 2, 0x09, 0x38, 0, 40]);
        assert_eq!(seconds(121, 121).1, 1);
        assert_eq!(seconds(121, 200).1, 6);
        assert_eq!(events(512, 600).1, 1);
        assert_eq!(events(513, u32::MAX).1, 6);
    }

    #[test]
    fn an_answer_of_another_length_says_nothing() {
        for length in 0..60 {
            let answer = vec![6; length];
            assert_eq!(head_of(&answer).is_some(), length == 1 + 2 * 17, "{length}");
            assert_eq!(uptime_of(&answer).is_some(), length == 5, "{length}");
        }
        assert!(seconds_of(&[81, 81, 6, 1, 2, 3]).is_none());
        assert!(events_of(&[]).is_none());
    }
}
