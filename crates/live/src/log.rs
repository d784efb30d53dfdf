//! Frames inside the board's log: defmt messages of nothing but bytes, found without the program's strings.
//!
//! A defmt message is the number of its format (two bytes) and its arguments; a slice of bytes is its length (four bytes,
//! lowest first) and the bytes (<https://defmt.ferrous-systems.com/encoding>). Messages are packed with rzCOBS, a zero byte
//! behind each. Whether the bytes are a frame is told by the frame's own checksum.

use board::Message;

/// More bytes than this without a message's end are no messages.
const LONGEST: usize = 4096;
/// Bytes of a format's number, and of a length.
const FORMAT: usize = 2;
const LENGTH: usize = 4;

/// Divides the bytes of a log into frames and everything else.
#[derive(Debug, Default)]
pub struct LogSplitter {
    rest: Vec<u8>,
}

/// The two parts of a log.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct SplitLog {
    /// Frames, as they stand on the serial line: what [`crate::Decoder`] takes.
    pub frames: Vec<u8>,
    /// Messages for people, packed as they came: what a defmt decoder takes.
    pub messages: Vec<u8>,
}

impl LogSplitter {
    /// Takes bytes and returns the parts that they complete.
    pub fn take(&mut self, bytes: &[u8]) -> SplitLog {
        self.rest.extend_from_slice(bytes);
        let mut parts = SplitLog::default();
        while let Some(end) = self.rest.iter().position(|byte| *byte == 0) {
            let packed: Vec<u8> = self.rest.drain(..=end).collect();
            match frame(&packed[..end]) {
                Some(frame) => parts.frames.extend(frame),
                None => parts.messages.extend(packed),
            }
        }
        if self.rest.len() > LONGEST {
            self.rest.clear();
        }
        parts
    }
}

/// The frame of a packed message, if it is nothing else.
fn frame(packed: &[u8]) -> Option<Vec<u8>> {
    let message = rzcobs::decode(packed).ok()?;
    let (length, bytes) = message.get(FORMAT..)?.split_first_chunk::<LENGTH>()?;
    // The packing fills the last group with zeros.
    let bytes = bytes.get(..u32::from_le_bytes(*length) as usize)?;
    Message::decode(bytes).ok()?;
    Some(bytes.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A frame of the board, made by hand: schema, payload and checksum come from `board`.
    fn board_frame() -> Vec<u8> {
        let report = monitor::Report::default();
        let shown = board::Shown::only(report.lamps);
        let frame = board::Frame::new(&report, &shown, 7, 3300);
        frame.encode(&mut [0; board::MAX_FRAME_BYTES]).to_vec()
    }

    fn packed(format: u16, arguments: &[u8]) -> Vec<u8> {
        let mut bytes = rzcobs::encode(&[&format.to_le_bytes(), arguments].concat());
        bytes.push(0);
        bytes
    }

    fn slice(bytes: &[u8]) -> Vec<u8> {
        [&(bytes.len() as u32).to_le_bytes(), bytes].concat()
    }

    #[test]
    fn frames_and_messages_part_whatever_the_pieces() {
        let frame = board_frame();
        let text = packed(3, &[1, 2, 3]);
        let log = [&text[..], &packed(9, &slice(&frame)), &text].concat();
        for piece in [1, 7, log.len()] {
            let mut splitter = LogSplitter::default();
            let mut whole = SplitLog::default();
            for part in log.chunks(piece).map(|bytes| splitter.take(bytes)) {
                whole.frames.extend(part.frames);
                whole.messages.extend(part.messages);
            }
            assert_eq!(whole.frames, frame);
            assert_eq!(whole.messages, [&text[..], &text].concat());
        }
    }

    /// Bytes that are no frame stay in the log, and so does a frame with a wrong bit.
    #[test]
    fn the_checksum_tells_a_frame() {
        let mut frame = board_frame();
        let middle = frame.len() / 2;
        frame[middle] ^= 0x10;
        for arguments in [slice(&frame), slice(&[1, 2, 3]), vec![255, 255, 255, 255]] {
            let packed = packed(9, &arguments);
            let parts = LogSplitter::default().take(&packed);
            assert_eq!(
                parts,
                SplitLog {
                    messages: packed,
                    ..SplitLog::default()
                }
            );
        }
    }

    #[test]
    fn noise_without_an_end_is_forgotten() {
        let mut splitter = LogSplitter::default();
        assert_eq!(splitter.take(&[7; 5000]), SplitLog::default());
        assert!(splitter.rest.is_empty());
    }
}
