//! The samples around the first alarm, kept until somebody has fetched them: in pieces with the frames, or as a file over Modbus.
//!
//! Every fourth instant, unfiltered: 2.5 kHz for a quarter of a second, which is what memory has room for and
//! `drivemon compare` needs (twelve supply cycles).

use heapless::Deque;
use monitor::RawSample;
use serde::{Deserialize, Serialize};

use crate::frames::framing::{self, MAX_FRAME_BYTES};

/// Instants that are kept.
pub const CAPTURE_INSTANTS: usize = 640;
/// Of so many instants one is kept.
pub const CAPTURE_EVERY: usize = 4;
/// Instants kept after the alarm: lamps come some 0.1 s after the fault, so that both halves tell about it.
const AFTER: u16 = CAPTURE_INSTANTS as u16 / 2;
/// Instants in one frame.
const CHUNK: usize = 4;
const CHUNKS: u16 = (CAPTURE_INSTANTS / CHUNK) as u16;
const _: () = assert!(CAPTURE_INSTANTS.is_multiple_of(CHUNK));
/// Bytes before the instants in the file.
pub const CAPTURE_HEAD_BYTES: usize = 24;
/// Bytes of an instant there.
pub const INSTANT_BYTES: usize = 14;
/// Bytes of the file.
pub const CAPTURE_BYTES: usize = CAPTURE_HEAD_BYTES + CAPTURE_INSTANTS * INSTANT_BYTES;
/// What the fields mean; a reader refuses every other number.
pub(crate) const SCHEMA: u8 = 0x81;

/// How far a capture has come. The numbers are those of the Modbus register.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum CaptureState {
    /// Waiting for an alarm.
    #[default]
    Armed = 0,
    /// Alarm; the samples after it are being taken.
    Taking = 1,
    /// Complete; nothing is taken until it is armed again.
    Complete = 2,
}

/// An instant in the ring: voltages, currents, the encoder's count.
type Instant = [u16; 7];

/// The ring.
pub struct Capture {
    instants: Deque<Instant, CAPTURE_INSTANTS>,
    after: u16,
    state: CaptureState,
    number: u8,
    chunk: u16,
    alarm: CaptureAlarm,
}

/// When the alarm of a capture was, and on which motor constants.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CaptureAlarm {
    /// Run of the program, as in [`crate::Second`].
    pub start: u32,
    /// The second of that run in which the alarm was.
    pub second: u32,
    /// [`crate::MotorImage::identification`].
    pub motor: u32,
}

/// What the file says before its instants.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CaptureHead {
    /// The alarm; of an armed ring the one before, or zeros.
    pub alarm: CaptureAlarm,
    /// Counts captures since the start, wrapping; 0: none yet.
    pub number: u8,
    /// How far it has come.
    pub state: CaptureState,
}

/// Some instants of a capture, oldest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CaptureChunk {
    schema: u8,
    /// Counts captures since the start; pieces of different ones do not belong together.
    pub number: u8,
    /// Place of this piece, from 0, and how many there are.
    pub index: u16,
    /// See `index`.
    pub count: u16,
    /// [`crate::MotorImage::identification`].
    pub motor: u32,
    instants: [Instant; CHUNK],
}

impl Default for Capture {
    fn default() -> Self {
        Capture::new()
    }
}

impl Capture {
    /// Armed and empty; all zeros, so that it costs no flash.
    pub const fn new() -> Self {
        Capture {
            instants: Deque::new(),
            after: 0,
            state: CaptureState::Armed,
            number: 0,
            chunk: 0,
            alarm: CaptureAlarm {
                start: 0,
                second: 0,
                motor: 0,
            },
        }
    }

    /// How far it has come.
    pub fn state(&self) -> CaptureState {
        self.state
    }

    /// Takes one of [`CAPTURE_EVERY`] instants.
    pub fn push(&mut self, raw: &RawSample) {
        if self.state == CaptureState::Complete {
            return;
        }
        if self.instants.is_full() {
            self.instants.pop_front();
        }
        let _ = self.instants.push_back(instant_of(raw));
        if self.state == CaptureState::Taking {
            self.after += 1;
            if self.after >= AFTER && self.instants.is_full() {
                self.state = CaptureState::Complete;
            }
        }
    }

    /// An alarm; only the first one since it was armed counts.
    pub fn alarm(&mut self, alarm: CaptureAlarm) {
        if self.state == CaptureState::Armed {
            self.alarm = alarm;
            self.state = CaptureState::Taking;
            self.after = 0;
            self.chunk = 0;
            self.number = self.number.wrapping_add(1);
        }
    }

    /// Samples are missing: what was taken does not hang together.
    pub fn interrupt(&mut self) {
        if self.state != CaptureState::Complete {
            self.instants.clear();
        }
    }

    /// Waits for the next alarm; what was taken is given up.
    pub fn arm(&mut self) {
        self.state = CaptureState::Armed;
        self.interrupt();
    }

    /// Somebody has a complete capture: waits for the next alarm. What is being taken goes on.
    pub fn release(&mut self) {
        if self.state == CaptureState::Complete {
            self.arm();
        }
    }

    /// Copies bytes of the file from place `at` on; `false` beyond its end, and for instants while it is not complete.
    #[inline(never)]
    pub fn read(&self, at: usize, bytes: &mut [u8]) -> bool {
        let head = self.head().to_bytes();
        for (place, byte) in (at..).zip(bytes) {
            let found = match place.checked_sub(CAPTURE_HEAD_BYTES) {
                None => head.get(place).copied(),
                Some(place) => self.byte(place),
            };
            let Some(found) = found else {
                return false;
            };
            *byte = found;
        }
        true
    }

    fn head(&self) -> CaptureHead {
        CaptureHead {
            alarm: self.alarm,
            number: self.number,
            state: self.state,
        }
    }

    /// A byte of the instants, oldest first.
    fn byte(&self, place: usize) -> Option<u8> {
        if self.state != CaptureState::Complete {
            return None;
        }
        let (older, newer) = self.instants.as_slices();
        let index = place / INSTANT_BYTES;
        let instant = match index.checked_sub(older.len()) {
            None => older.get(index),
            Some(index) => newer.get(index),
        }?;
        let word = instant.get(place % INSTANT_BYTES / 2)?;
        word.to_le_bytes().get(place % 2).copied()
    }

    /// The next piece of a complete capture, over and over.
    #[inline(never)]
    pub fn next_chunk(&mut self, motor: u32) -> Option<CaptureChunk> {
        if self.state != CaptureState::Complete {
            return None;
        }
        let index = self.chunk;
        self.chunk = (index + 1) % CHUNKS;
        let (older, newer) = self.instants.as_slices();
        let piece = older.iter().chain(newer).skip(usize::from(index) * CHUNK);
        let mut instants = [[0; 7]; CHUNK];
        for (instant, kept) in instants.iter_mut().zip(piece) {
            *instant = *kept;
        }
        Some(CaptureChunk {
            schema: SCHEMA,
            number: self.number,
            index,
            count: CHUNKS,
            motor,
            instants,
        })
    }
}

fn instant_of(raw: &RawSample) -> Instant {
    let [u_a, u_b, u_c] = raw.voltage_codes;
    let [i_a, i_b, i_c] = raw.current_codes;
    [u_a, u_b, u_c, i_a, i_b, i_c, raw.encoder_count]
}

impl CaptureHead {
    /// As it stands in the file.
    pub fn to_bytes(&self) -> [u8; CAPTURE_HEAD_BYTES] {
        let mut bytes = [0; CAPTURE_HEAD_BYTES];
        let CaptureAlarm {
            start,
            second,
            motor,
        } = self.alarm;
        let counts = [CAPTURE_INSTANTS as u16, CAPTURE_EVERY as u16, AFTER];
        let longs = [start, second, motor].map(u32::to_le_bytes);
        let words = counts.map(u16::to_le_bytes);
        let kind = [self.number, self.state as u8];
        let content = longs.as_flattened().iter().chain(&kind);
        let content = content.chain(words.as_flattened());
        for (byte, value) in bytes.iter_mut().zip(content) {
            *byte = *value;
        }
        bytes
    }

    /// Reads it; `None` where lengths are others than this program's, or the state is none.
    pub fn from_bytes(bytes: &[u8; CAPTURE_HEAD_BYTES]) -> Option<Self> {
        let long = |at: usize| {
            let four = bytes.get(at..at + 4)?;
            Some(u32::from_le_bytes(four.try_into().ok()?))
        };
        let head = CaptureHead {
            alarm: CaptureAlarm {
                start: long(0)?,
                second: long(4)?,
                motor: long(8)?,
            },
            number: *bytes.get(12)?,
            state: match bytes.get(13)? {
                0 => CaptureState::Armed,
                1 => CaptureState::Taking,
                2 => CaptureState::Complete,
                _ => return None,
            },
        };
        (head.to_bytes() == *bytes).then_some(head)
    }
}

/// The samples of a file's instants; `None` where their number is another one than this program's.
pub fn captured_samples(instants: &[u8]) -> Option<impl Iterator<Item = RawSample>> {
    let (instants, []) = instants.as_chunks::<INSTANT_BYTES>() else {
        return None;
    };
    let whole = instants.len() == CAPTURE_INSTANTS;
    whole.then(|| {
        instants.iter().map(|bytes| {
            let (words, _) = bytes.as_chunks::<2>();
            let word = |k: usize| words.get(k).map_or(0, |two| u16::from_le_bytes(*two));
            sample_of(&core::array::from_fn(word))
        })
    })
}

fn sample_of(&[u_a, u_b, u_c, i_a, i_b, i_c, encoder_count]: &Instant) -> RawSample {
    RawSample {
        voltage_codes: [u_a, u_b, u_c],
        current_codes: [i_a, i_b, i_c],
        encoder_count,
        ..RawSample::default()
    }
}

impl CaptureChunk {
    /// The bytes to send, zero byte included.
    #[inline(never)]
    pub fn encode<'a>(&self, buffer: &'a mut [u8; MAX_FRAME_BYTES]) -> &'a [u8] {
        framing::encode(self, buffer)
    }

    /// The instants.
    pub fn samples(&self) -> impl Iterator<Item = RawSample> {
        self.instants.iter().map(sample_of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MAX_FRAME_BYTES, Message};

    fn raw(k: u16) -> RawSample {
        RawSample {
            voltage_codes: [k, k + 1, k + 2].map(|code: u16| code.wrapping_mul(0x9E37)),
            current_codes: [k + 3, k + 4, k + 5].map(|code: u16| code.wrapping_mul(0x9E37)),
            encoder_count: k.wrapping_mul(31),
            ..RawSample::default()
        }
    }

    const ALARM: CaptureAlarm = CaptureAlarm {
        start: 7,
        second: 42,
        motor: 0xDEAD_BEEF,
    };

    fn filled(upto: u16) -> Capture {
        let mut capture = Capture::new();
        (0..upto).for_each(|k| capture.push(&raw(k)));
        capture
    }

    fn fetched(capture: &mut Capture) -> Vec<RawSample> {
        let chunks = (0..CHUNKS).map(|_| capture.next_chunk(7).expect("a complete capture"));
        chunks
            .flat_map(|chunk| chunk.samples().collect::<Vec<_>>())
            .collect()
    }

    #[test]
    fn half_of_it_lies_before_the_alarm_and_half_behind() {
        let mut capture = filled(1_000);
        assert_eq!(capture.next_chunk(7), None);
        capture.alarm(ALARM);
        (1_000..5_000).for_each(|k| capture.push(&raw(k)));
        assert_eq!(capture.state(), CaptureState::Complete);
        let expected: Vec<_> = (1_000 - 320..1_000 + 320).map(raw).collect();
        assert_eq!(fetched(&mut capture), expected);
        assert_eq!(
            fetched(&mut capture),
            expected,
            "fetching takes nothing away"
        );
    }

    fn bytes(capture: &Capture, at: usize, count: usize) -> Option<Vec<u8>> {
        let mut bytes = vec![0; count];
        capture.read(at, &mut bytes).then_some(bytes)
    }

    fn head(capture: &Capture) -> CaptureHead {
        let bytes = bytes(capture, 0, CAPTURE_HEAD_BYTES).expect("always there");
        CaptureHead::from_bytes(&bytes.try_into().expect("its length")).expect("a head")
    }

    #[test]
    fn the_file_holds_what_the_pieces_hold() {
        let mut capture = filled(1_000);
        assert_eq!(head(&capture), CaptureHead::default());
        assert_eq!(bytes(&capture, CAPTURE_HEAD_BYTES, 2), None);
        capture.alarm(ALARM);
        assert_eq!(head(&capture).state, CaptureState::Taking);
        capture.release();
        (1_000..5_000).for_each(|k| capture.push(&raw(k)));
        let expected = CaptureHead {
            alarm: ALARM,
            number: 1,
            state: CaptureState::Complete,
        };
        assert_eq!(head(&capture), expected);
        let instants = CAPTURE_BYTES - CAPTURE_HEAD_BYTES;
        let file = bytes(&capture, CAPTURE_HEAD_BYTES, instants).expect("complete");
        let samples: Vec<_> = captured_samples(&file).expect("whole").collect();
        assert_eq!(samples, fetched(&mut capture));
        assert!(captured_samples(&file[1..]).is_none() && captured_samples(&file[14..]).is_none());
        assert_eq!(bytes(&capture, CAPTURE_BYTES - 1, 2), None);
        capture.release();
        assert_eq!(bytes(&capture, CAPTURE_HEAD_BYTES, 1), None);
        (0..640).for_each(|k| capture.push(&raw(k)));
        capture.alarm(CaptureAlarm::default());
        assert_eq!((head(&capture).number, head(&capture).alarm.second), (2, 0));
    }

    #[test]
    fn a_head_of_another_program_is_none() {
        let good = CaptureHead::default().to_bytes();
        for at in 13..CAPTURE_HEAD_BYTES {
            let mut other = good;
            other[at] ^= 0x80;
            assert_eq!(CaptureHead::from_bytes(&other), None, "{at}");
        }
    }

    #[test]
    fn an_early_alarm_waits_until_the_ring_is_full() {
        let mut capture = filled(10);
        capture.alarm(ALARM);
        (10..639).for_each(|k| capture.push(&raw(k)));
        assert_eq!(capture.state(), CaptureState::Taking);
        capture.push(&raw(639));
        assert_eq!(capture.state(), CaptureState::Complete);
    }

    #[test]
    fn missing_samples_begin_it_anew_and_a_second_alarm_changes_nothing() {
        let mut capture = filled(1_000);
        capture.alarm(ALARM);
        capture.interrupt();
        capture.alarm(ALARM);
        (2_000..2_640).for_each(|k| capture.push(&raw(k)));
        assert_eq!(
            fetched(&mut capture),
            (2_000..2_640).map(raw).collect::<Vec<_>>()
        );
        capture.arm();
        assert_eq!(capture.state(), CaptureState::Armed);
    }

    #[test]
    fn the_longest_piece_fits_and_comes_back() {
        let chunk = CaptureChunk {
            schema: SCHEMA,
            number: u8::MAX,
            index: u16::MAX,
            count: u16::MAX,
            motor: u32::MAX,
            instants: [[u16::MAX; 7]; CHUNK],
        };
        let mut buffer = [0; MAX_FRAME_BYTES];
        let bytes = chunk.encode(&mut buffer);
        assert_eq!(Message::decode(bytes), Ok(Message::Capture(chunk)));
    }
}
