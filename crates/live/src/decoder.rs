//! From bytes to messages, with a count of what was lost on the way.

use board::{FrameError, Message};

/// More bytes than this without a frame's end are no frames.
const LONGEST: usize = 1024;

/// Joins bytes to frames.
#[derive(Debug, Default)]
pub struct Decoder {
    rest: Vec<u8>,
    begun: bool,
    next: Option<u32>,
    /// Frames that were damaged.
    pub damaged: u64,
    /// Windows whose frames never came.
    pub lost: u64,
    /// Schema of frames that this reader does not know.
    pub foreign: Option<FrameError>,
}

impl Decoder {
    /// Takes bytes and returns the messages that they complete.
    pub fn take(&mut self, bytes: &[u8]) -> Vec<Message> {
        self.rest.extend_from_slice(bytes);
        let mut messages = Vec::new();
        while let Some(end) = self.rest.iter().position(|byte| *byte == 0) {
            let frame: Vec<u8> = self.rest.drain(..=end).collect();
            messages.extend(self.decode(&frame));
            self.begun = true;
        }
        if self.rest.len() > LONGEST {
            self.rest.clear();
            self.damaged += 1;
        }
        messages
    }

    fn decode(&mut self, frame: &[u8]) -> Option<Message> {
        match Message::decode(frame) {
            Ok(message) => {
                self.count(&message);
                Some(message)
            }
            // A reader comes in the middle of a frame; that one is not damaged.
            Err(_) if !self.begun => None,
            Err(error) => {
                self.damaged += 1;
                if matches!(error, FrameError::Schema(_)) {
                    self.foreign = Some(error);
                }
                None
            }
        }
    }

    fn count(&mut self, message: &Message) {
        if let Message::Window(frame) = message {
            let missing = self
                .next
                .map_or(0, |next| frame.sequence.wrapping_sub(next));
            // A board that started again begins at 0: nothing was lost then.
            if missing < u32::MAX / 2 {
                self.lost += u64::from(missing);
            }
            self.next = Some(frame.sequence.wrapping_add(1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use board::{Frame, MAX_FRAME_BYTES, Shown};
    use monitor::Report;

    fn frame(sequence: u32) -> Vec<u8> {
        let frame = Frame::new(&Report::default(), &Shown::default(), sequence, 3_300);
        frame.encode(&mut [0; MAX_FRAME_BYTES]).to_vec()
    }

    fn sequences(messages: &[Message]) -> Vec<u32> {
        let sequence = |message: &Message| match message {
            Message::Window(frame) => frame.sequence,
            Message::Capture(_) => panic!("no capture was sent"),
        };
        messages.iter().map(sequence).collect()
    }

    #[test]
    fn frames_are_found_however_the_bytes_are_cut() {
        let stream: Vec<u8> = (0..20).flat_map(frame).collect();
        for cut in 1..40 {
            let mut decoder = Decoder::default();
            let messages: Vec<_> = stream
                .chunks(cut)
                .flat_map(|bytes| decoder.take(bytes))
                .collect();
            assert_eq!(sequences(&messages), (0..20).collect::<Vec<_>>());
            assert_eq!((decoder.damaged, decoder.lost), (0, 0));
        }
    }

    #[test]
    fn a_reader_may_come_in_the_middle() {
        let stream = [&frame(6)[7..], &frame(7)[..]].concat();
        let mut decoder = Decoder::default();
        assert_eq!(sequences(&decoder.take(&stream)), [7]);
        assert_eq!((decoder.damaged, decoder.lost), (0, 0));
    }

    #[test]
    fn damage_and_loss_are_counted_and_a_restart_is_neither() {
        let mut damaged = frame(2);
        damaged[9] ^= 0x40;
        let stream = [frame(1), damaged, frame(3), frame(6), frame(0), frame(1)].concat();
        let mut decoder = Decoder::default();
        assert_eq!(sequences(&decoder.take(&stream)), [1, 3, 6, 0, 1]);
        assert_eq!((decoder.damaged, decoder.lost), (1, 3));
    }

    #[test]
    fn noise_without_an_end_is_thrown_away() {
        let mut decoder = Decoder::default();
        decoder.take(&[7; 5_000]);
        assert_eq!(
            sequences(&decoder.take(&[&[0], &frame(1)[..]].concat())),
            [1]
        );
    }
}
