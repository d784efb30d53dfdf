//! What the board says: a log for people and a frame per window for programs, over the debugger's memory channels; the
//! frames over the serial line too.

use board::{CaptureChunk, Frame, MAX_FRAME_BYTES, Shown};
use monitor::Report;
use rtt_target::ChannelMode::NoBlockSkip;
use rtt_target::{UpChannel, rtt_init, set_defmt_channel};

use super::serial;

/// The channel of the frames. Neither it nor the log ever blocks: frames that are not read are dropped.
pub struct Telemetry {
    frames: UpChannel,
    sequence: u32,
}

impl Telemetry {
    /// Opens both channels.
    pub fn start() -> Self {
        let channels = rtt_init! {
            up: {
                0: { size: 512, mode: NoBlockSkip, name: "defmt" }
                1: { size: 1024, mode: NoBlockSkip, name: "frames" }
            }
        };
        set_defmt_channel(channels.up.0);
        Telemetry {
            frames: channels.up.1,
            sequence: 0,
        }
    }

    /// Sends one window's result.
    pub fn send(&mut self, report: &Report, shown: &Shown, vdda_millivolt: u16) {
        let frame = Frame::new(report, shown, self.sequence, vdda_millivolt);
        self.sequence = self.sequence.wrapping_add(1);
        self.send_bytes(frame.encode(&mut [0; MAX_FRAME_BYTES]));
    }

    /// Sends a piece of the samples around an alarm.
    pub fn send_chunk(&mut self, chunk: &CaptureChunk) {
        self.send_bytes(chunk.encode(&mut [0; MAX_FRAME_BYTES]));
    }

    #[inline(never)]
    fn send_bytes(&mut self, bytes: &[u8]) {
        self.frames.write(bytes);
        serial::send(bytes);
    }
}
