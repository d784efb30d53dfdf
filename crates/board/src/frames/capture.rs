//! The samples around the first alarm, kept until somebody has fetched them.
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
    pub fn alarm(&mut self) {
        if self.state == CaptureState::Armed {
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

impl CaptureChunk {
    /// The bytes to send, zero byte included.
    #[inline(never)]
    pub fn encode<'a>(&self, buffer: &'a mut [u8; MAX_FRAME_BYTES]) -> &'a [u8] {
        framing::encode(self, buffer)
    }

    /// The instants.
    pub fn samples(&self) -> impl Iterator<Item = RawSample> {
        self.instants
            .iter()
            .map(|&[u_a, u_b, u_c, i_a, i_b, i_c, encoder_count]| RawSample {
                voltage_codes: [u_a, u_b, u_c],
                current_codes: [i_a, i_b, i_c],
                encoder_count,
                ..RawSample::default()
            })
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
        capture.alarm();
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

    #[test]
    fn an_early_alarm_waits_until_the_ring_is_full() {
        let mut capture = filled(10);
        capture.alarm();
        (10..639).for_each(|k| capture.push(&raw(k)));
        assert_eq!(capture.state(), CaptureState::Taking);
        capture.push(&raw(639));
        assert_eq!(capture.state(), CaptureState::Complete);
    }

    #[test]
    fn missing_samples_begin_it_anew_and_a_second_alarm_changes_nothing() {
        let mut capture = filled(1_000);
        capture.alarm();
        capture.interrupt();
        capture.alarm();
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
