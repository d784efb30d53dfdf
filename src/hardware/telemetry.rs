//! What the board says: a log for people and a frame per window for programs, over the debugger's memory channel; the
//! frames over the serial line too.

use board::{CaptureChunk, Frame, MAX_FRAME_BYTES, Shown};
use defmt_rtt as _;
use monitor::Report;

use super::serial;

/// Numbers the frames. The log that carries them never blocks: what is not read in time is dropped whole.
#[derive(Default)]
pub struct Telemetry {
    sequence: u32,
}

impl Telemetry {
    /// Sends one window's result.
    pub fn send(&mut self, report: &Report, shown: &Shown, vdda_millivolt: u16) {
        let frame = Frame::new(report, shown, self.sequence, vdda_millivolt);
        self.sequence = self.sequence.wrapping_add(1);
        Self::send_bytes(frame.encode(&mut [0; MAX_FRAME_BYTES]));
    }

    /// Sends a piece of the samples around an alarm.
    pub fn send_chunk(&self, chunk: &CaptureChunk) {
        Self::send_bytes(chunk.encode(&mut [0; MAX_FRAME_BYTES]));
    }

    #[inline(never)]
    fn send_bytes(bytes: &[u8]) {
        // A message of nothing but bytes: `live::LogSplitter` finds it without the program's strings.
        defmt::println!("{=[u8]}", bytes);
        serial::send(bytes);
    }
}
