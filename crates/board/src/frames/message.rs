//! Everything that the board sends without being asked, told apart by the first byte.

use crate::frames::capture::{self, CaptureChunk};
use crate::frames::frame::Frame;
use crate::frames::framing::{self, FrameError, MAX_FRAME_BYTES};

/// One frame's content.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Message {
    /// What a window says.
    Window(Frame),
    /// A piece of the samples around an alarm.
    Capture(CaptureChunk),
}

impl Message {
    /// Reads one frame; the zero byte behind it may be there or not.
    ///
    /// # Errors
    /// Anything but a whole, undamaged frame of a known schema.
    pub fn decode(bytes: &[u8]) -> Result<Self, FrameError> {
        let mut plain = [0; MAX_FRAME_BYTES];
        let content = framing::decode(bytes, &mut plain)?;
        let read = match content.first() {
            Some(&framing::SCHEMA) => postcard::from_bytes(content).map(Message::Window),
            Some(&capture::SCHEMA) => postcard::from_bytes(content).map(Message::Capture),
            Some(&other) => return Err(FrameError::Schema(other)),
            None => return Err(FrameError::Framing),
        };
        read.map_err(|_| FrameError::Content)
    }
}

impl Frame {
    /// Reads one frame; the zero byte behind it may be there or not.
    ///
    /// # Errors
    /// Anything but a whole, undamaged frame of this schema.
    pub fn decode(bytes: &[u8]) -> Result<Self, FrameError> {
        match Message::decode(bytes)? {
            Message::Window(frame) => Ok(frame),
            Message::Capture(_) => Err(FrameError::Content),
        }
    }
}
